//! Controls that are added, copied, pasted and deleted. New ones go to free room.

use eframe::egui;
use parry3d::math::Vec2;

use super::{EditorPanel, rounded};
use crate::canvas::free::free_offset;
use crate::canvas::plan::{Plan, PlanView};
use crate::canvas::{Bounds, ItemShape};
use crate::editor::{ControlKind, Edit, NewPart, Part, has_parts_in_space};
use crate::texts::text;

/// Distance between the places at which a new board is tried, in millimetres.
const BOARD_PLACE_MM: f64 = 180.0;

/// Distance between a board and its copy, in millimetres.
const COPY_GAP_MM: f32 = 20.0;

/// Places at which boards are tried in each direction until they overlap no others.
const BOARD_PLACES: u8 = 12;

/// Returns the offsets at which a new board is tried: at both sides of the place where it is.
fn board_places() -> impl Iterator<Item = [f64; 2]> {
    let distances = (0..BOARD_PLACES).map(|place| f64::from(place) * BOARD_PLACE_MM);
    distances.flat_map(|right| [[right, 0.0], [-right, 0.0]])
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
        let center = self.viewport.center().unwrap_or(Vec2::ZERO);
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
        self.apply_beside_boards(board_places(), |[right_mm, _]| {
            Edit::Add(NewPart::Board { right_mm })
        });
        if self.editor.count("boards") > index {
            self.show_part(Part::Board(index));
        }
    }

    /// Copies boards and targets in space, and shows the first copied board.
    fn duplicate_in_space(&mut self, parts: &[Part]) {
        let index = self.editor.count("boards");
        let bounds = self.editor.layout().and_then(|layout| {
            let plan = Plan::new(&self.editor, layout, &[]);
            plan.bounds(PlanView::Above, |part| parts.contains(&part))
        });
        // The size is not known while the text cannot be read.
        let unknown = Vec2::splat(BOARD_PLACE_MM as f32);
        let distance = bounds.map_or(unknown, |own| (own.size() + COPY_GAP_MM).ceil());
        let [right, forward] = distance.to_array().map(f64::from);
        let places = (1..BOARD_PLACES).flat_map(|place| {
            let (x, y) = (f64::from(place) * right, f64::from(place) * forward);
            [[x, 0.0], [-x, 0.0], [0.0, y], [0.0, -y]]
        });
        self.apply_beside_boards(places, |by_mm| Edit::Duplicate {
            parts: parts.to_vec(),
            by_mm,
        });
        self.show_added_board(index);
    }

    /// Shows a board that was added, unless the plan shows it.
    fn show_added_board(&mut self, index: usize) {
        if !self.plan.is_open && self.editor.count("boards") > index {
            self.show_part(Part::Board(index));
        }
    }

    /// Makes an edit that adds boards or targets in space, at the first of these offsets to the right and away from the wearer at which
    /// they overlap no others.
    fn apply_beside_boards(
        &mut self,
        places: impl Iterator<Item = [f64; 2]>,
        edit: impl Fn([f64; 2]) -> Edit,
    ) {
        let [boards, spaces] = ["boards", "spaces"].map(|list| self.editor.count(list));
        let mut is_added = false;
        for by_mm in places {
            let result = if is_added {
                self.editor.amend(&edit(by_mm))
            } else {
                self.editor.apply(&edit(by_mm))
            };
            let has_failed = result.is_err();
            self.report(result);
            self.plan.has_added |= self.plan.is_open && !has_failed;
            if has_failed || !self.overlap_others(boards) && !self.cover_others(spaces) {
                return;
            }
            is_added = true;
        }
    }

    /// Returns `true` if a board from an index on overlaps one before it.
    fn overlap_others(&self, from: usize) -> bool {
        self.editor.layout().is_some_and(|layout| {
            let overlaps = layout.board_overlaps();
            let mut numbers = overlaps.iter().map(|overlap| overlap.boards);
            numbers.any(|(one, other)| one <= from && other > from)
        })
    }

    /// Returns `true` if a space from an index on has a target in the place of a target of one before it.
    fn cover_others(&self, from: usize) -> bool {
        let editor = &self.editor;
        let targets = |space| {
            let pose = editor.value(Part::Space(space), "pose");
            (pose, editor.targets_in(space))
        };
        let covers = |added: usize| {
            let (pose, centers) = targets(added);
            (0..from).any(|other| {
                let (other_pose, other_centers) = targets(other);
                pose == other_pose && centers.iter().any(|center| other_centers.contains(center))
            })
        };
        (from..editor.count("spaces")).any(covers)
    }

    /// Copies what is selected; the copies are selected then, in free room near it.
    pub(super) fn duplicate(&mut self) {
        let parts = self.editor.selection().to_vec();
        let in_space = parts.iter().copied();
        let in_space =
            in_space.filter(|it| matches!(it, Part::Board(_) | Part::SpaceTarget { .. }));
        let in_space: Vec<Part> = in_space.collect();
        if !in_space.is_empty() {
            self.duplicate_in_space(&in_space);
        } else if !parts.is_empty() {
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
        let _ = self.put_on_clipboard(context);
    }

    /// Moves what is selected to the clipboard. What cannot be pasted stays.
    pub(super) fn cut(&mut self, context: &egui::Context) {
        if self.put_on_clipboard(context) {
            self.delete();
        }
    }

    /// Puts what is selected on the clipboard. Returns `false` if there is nothing that can be pasted.
    fn put_on_clipboard(&mut self, context: &egui::Context) -> bool {
        let Some(copied) = self.editor.copied() else {
            if !self.editor.selection().is_empty() {
                self.message = Some(Err(text("editor-not-copied").to_owned()));
            }
            return false;
        };
        context.copy_text(copied);
        self.message = Some(Ok(text("editor-copied")));
        true
    }

    /// Adds the parts of the clipboard: controls in free room near the middle of the canvas, boards and targets in space where they cover
    /// no others.
    pub(super) fn paste(&mut self, text: String) {
        if has_parts_in_space(&text) {
            self.paste_in_space(&text);
            return;
        }
        self.leave_plan_for_control();
        let center = self.viewport.center();
        let board = self.board;
        self.apply_where_free(center, |by_mm| Edit::Paste {
            board,
            text: text.clone(),
            by_mm,
        });
    }

    /// Adds boards, triggers and targets in space of the clipboard, and shows the first board.
    fn paste_in_space(&mut self, text: &str) {
        self.commit_drafts();
        let index = self.editor.count("boards");
        self.apply_beside_boards(board_places(), |by_mm| Edit::Paste {
            board: 0,
            text: text.to_owned(),
            by_mm,
        });
        self.show_added_board(index);
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
        self.show_added();
    }

    /// Shows the controls that were added and are selected now, unless they are in the picture already.
    pub(super) fn show_added(&mut self) {
        self.update_items();
        let shapes = self.selected.shapes(&self.items.items);
        let added = Bounds::around(shapes.iter().map(|(_, shape)| shape));
        let seen = self.viewport.visible(self.canvas_size);
        if let (Some(added), Some(seen)) = (added, seen)
            && !seen.encloses(added)
        {
            self.zoom_to_selection();
        }
    }
}
