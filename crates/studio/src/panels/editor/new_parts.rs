//! Controls that are added, copied, pasted and deleted. New ones go to free room.

use eframe::egui;
use parry3d::math::Vec2;

use super::{EditorPanel, rounded};
use crate::canvas::free::free_offset;
use crate::canvas::{Bounds, ItemShape};
use crate::editor::{ControlKind, Edit, NewPart, Part};
use crate::texts::text;

/// Distances to the right at which a new board is tried, in millimetres, until it overlaps no other one.
const BOARD_PLACES_MM: [f64; 9] = [
    0.0, 180.0, -180.0, 360.0, -360.0, 540.0, -540.0, 720.0, -720.0,
];

/// The numbers of a repetition.
pub(super) struct Repeat {
    /// Columns and rows.
    pub count: [usize; 2],
    /// Distances to the right and away from the wearer, in millimetres.
    pub pitch_mm: [f64; 2],
}

impl Default for Repeat {
    fn default() -> Self {
        Self {
            count: [3, 1],
            pitch_mm: [19.0, -19.0],
        }
    }
}

impl EditorPanel {
    /// Adds a part and shows it.
    pub(super) fn add(&mut self, new: NewPart) {
        if let NewPart::Board { .. } = new {
            self.add_board();
        } else {
            self.apply(&Edit::Add(new));
        }
    }

    /// Adds a control to the board, in free room near the middle of the canvas.
    pub(super) fn add_control(&mut self, kind: ControlKind) {
        self.leave_plan_for_control();
        let center = self.viewport.map_or(Vec2::ZERO, |viewport| viewport.center);
        let center = center.to_array().map(|mm| f64::from(mm.round()));
        let board = self.board;
        self.apply_where_free(None, |[x, y]| {
            Edit::Add(NewPart::Control {
                board,
                kind,
                at_mm: [center[0] + x, center[1] + y],
                binding: None,
            })
        });
    }

    /// Adds a board where it overlaps no other one, and shows it.
    fn add_board(&mut self) {
        let index = self.editor.count("boards");
        let [first, others @ ..] = BOARD_PLACES_MM;
        self.apply(&Edit::Add(NewPart::Board { right_mm: first }));
        for right_mm in others {
            if !self.overlaps_other_boards(index) {
                break;
            }
            let next = Edit::Add(NewPart::Board { right_mm });
            let amended = self.editor.amend(&next);
            self.report(amended);
        }
        if self.editor.count("boards") > index {
            self.show_part(Part::Board(index));
        }
    }

    fn overlaps_other_boards(&self, board: usize) -> bool {
        self.editor.layout().is_some_and(|layout| {
            let overlaps = layout.board_overlaps();
            let mut boards = overlaps.iter().map(|overlap| overlap.boards);
            boards.any(|(_, second)| second == board + 1)
        })
    }

    /// Copies what is selected; the copies are selected then, in free room near it.
    pub(super) fn duplicate(&mut self) {
        if self.plan.is_open {
            self.duplicate_in_plan();
            return;
        }
        let parts = self.editor.selection().to_vec();
        if !parts.is_empty() {
            self.apply_where_free(None, |by_mm| Edit::Duplicate {
                parts: parts.clone(),
                by_mm,
            });
        }
    }

    /// Deletes what is selected.
    pub(super) fn delete(&mut self) {
        let parts = self.editor.selection().to_vec();
        if !parts.is_empty() {
            self.apply(&Edit::Delete { parts });
        }
    }

    /// Puts what is selected on the clipboard, as text of a layout.
    pub(super) fn copy(&mut self, context: &egui::Context) {
        if let Some(copied) = self.editor.copied() {
            context.copy_text(copied);
            self.message = Some(Ok(text("editor-copied")));
        }
    }

    /// Adds controls of the clipboard, in free room near the middle of the canvas.
    pub(super) fn paste(&mut self, text: String) {
        self.leave_plan_for_control();
        let center = self.viewport.map(|viewport| viewport.center);
        let board = self.board;
        self.apply_where_free(center, |by_mm| Edit::Paste {
            board,
            text: text.clone(),
            by_mm,
        });
    }

    /// Makes an edit that adds controls, with the offset at which they overlap no others: from their places, or from a point.
    fn apply_where_free(&mut self, near: Option<Vec2>, edit: impl Fn([f64; 2]) -> Edit) {
        let before = self.editor.revision();
        self.apply(&edit([0.0; 2]));
        if self.editor.revision() == before {
            return;
        }
        self.update_items();
        let items = self.items.items.iter().enumerate();
        let (added, others): (Vec<_>, Vec<_>) =
            items.partition(|(index, _)| self.selected.contains(*index));
        let shapes = |listed: Vec<(usize, &crate::canvas::Item)>| -> Vec<ItemShape> {
            listed.into_iter().map(|(_, item)| item.shape).collect()
        };
        let (mut added, others) = (shapes(added), shapes(others));
        let Some(bounds) = Bounds::around(added.iter()) else {
            return;
        };
        let start = near.map_or(Vec2::ZERO, |near| (near - bounds.center()).round());
        for shape in &mut added {
            shape.center += start;
        }
        let offset = start + free_offset(&added, &others, self.grid_mm);
        if offset != Vec2::ZERO {
            let by_mm = [rounded(offset.x), rounded(offset.y)];
            let amended = self.editor.amend(&edit(by_mm));
            self.report(amended);
        }
    }
}
