//! The problems of the layout as a drag on the canvas would leave it, and the outlines of its faulty items, while the drag lasts.

use std::collections::BTreeMap;

use eframe::egui;

use super::{EditorPanel, board_items};
use crate::canvas::ItemShape;
use crate::editor::{Edit, Problem};

/// The number of items of a board above which a drag is checked only where the mouse rests: each check reads the whole text.
const MANY: usize = 1000;

/// The check of a drag.
#[derive(Default)]
pub(super) struct DragCheck {
    /// The edit of the drag in the last frame.
    edit: Option<Edit>,
    /// That edit was checked.
    is_done: bool,
    found: Option<Found>,
}

/// The state that a drag would lead to.
struct Found {
    problems: Vec<Problem>,
    faulty: Vec<ItemShape>,
}

impl EditorPanel {
    /// Checks the layout as the drag on the canvas would leave it, if there is one.
    pub(super) fn check_drag(&mut self, context: &egui::Context) {
        let Some(edit) = self.edit_of_drag() else {
            self.drag_check = DragCheck::default();
            return;
        };
        let rests = self.drag_check.edit.as_ref() == Some(&edit);
        if rests && self.drag_check.is_done {
            return;
        }
        // The problems may have been drawn already.
        context.request_repaint();
        self.drag_check.is_done = rests || self.items.items.len() <= MANY;
        if self.drag_check.is_done {
            let after = self.editor.after(&edit).ok();
            self.drag_check.found = after.map(|after| Found {
                problems: after.problems().to_vec(),
                faulty: board_items::faulty_outlines(&after, self.board),
            });
        }
        self.drag_check.edit = Some(edit);
    }

    fn found_in_drag(&self) -> Option<&Found> {
        let found = self.drag_check.found.as_ref();
        found.filter(|_| self.is_dragging_on_canvas())
    }

    /// Returns the problems of the text, or those that it would have after the drag on the canvas.
    pub(super) fn problems_now(&self) -> &[Problem] {
        let found = self.found_in_drag();
        found.map_or(self.editor.problems(), |it| &it.problems[..])
    }

    /// Returns the outlines of the items with an error, where they are drawn at present.
    pub(super) fn faulty_outlines(&self) -> Vec<ItemShape> {
        if let Some(found) = self.found_in_drag() {
            return found.faulty.clone();
        }
        let moved: BTreeMap<usize, ItemShape> = self.preview.shapes.iter().copied().collect();
        let outline = |index: &usize| {
            let own = self.items.items.get(*index).map(|item| item.shape);
            moved.get(index).copied().or(own)
        };
        self.faulty.iter().filter_map(outline).collect()
    }
}

#[cfg(test)]
mod tests {
    use parry3d::math::Vec2;

    use super::*;
    use crate::canvas::gesture::{Gesture, moved};
    use crate::canvas::snap::SnapSettings;
    use crate::editor::LayoutEditor;
    use ademan_core::layout::Fit;

    /// Returns rows of square keys with 10 mm between them.
    fn rows_of(keys: usize) -> EditorPanel {
        let key = |index: usize| {
            let (x, y) = (index % 40 * 20, index / 40 * 20);
            format!("(code: \"A\", name: \"k{index}\", at_mm: ({x}, {y}), size_mm: Box(10, 10)),")
        };
        let keys: String = (0..keys).map(key).collect();
        let text = format!(
            "Layout(name: \"Rows\", boards: [(pose: (anchor: elbow, forward_mm: 320), keys: [{keys}])])"
        );
        let editor = LayoutEditor::from_text("rows.ron", &text, Fit::default());
        let mut panel = EditorPanel::new(editor);
        panel.update_items();
        panel.selected.set([0]);
        panel.gesture = Some(Gesture::Move { from: Vec2::ZERO });
        panel
    }

    /// Drags the first key to the right of where it is in the file, and returns the middles of the outlines with an error.
    fn drag(panel: &mut EditorPanel, by: f32) -> Vec<Vec2> {
        let offset = Vec2::new(by, 0.0);
        let items = &panel.items.items;
        panel.preview = moved(items, &panel.selected, offset, SnapSettings::OFF);
        panel.check_drag(&egui::Context::default());
        let outlines = panel.faulty_outlines().into_iter();
        outlines.map(|outline| outline.center).collect()
    }

    /// Returns `true` if one of the middles is 15 mm to the right.
    fn has_dragged_key(middles: &[Vec2]) -> bool {
        let distance = |at: &Vec2| (*at - Vec2::new(15.0, 0.0)).length();
        middles.iter().any(|at| distance(at) < 1e-3)
    }

    #[test]
    fn outlines_and_problems_follow_a_drag_and_its_end() {
        let mut panel = rows_of(3);
        let text = panel.editor.text().to_owned();
        assert!(has_dragged_key(&drag(&mut panel, 15.0)));
        assert!(!panel.problems_now().is_empty());
        assert!(panel.editor.problems().is_empty());
        assert!(drag(&mut panel, 5.0).is_empty());
        assert!(panel.problems_now().is_empty());
        drag(&mut panel, 15.0);
        panel.cancel_drag();
        assert!(panel.problems_now().is_empty() && panel.faulty_outlines().is_empty());
        assert_eq!(panel.editor.text(), text);
    }

    #[test]
    fn a_drag_on_a_board_with_many_keys_is_checked_where_the_mouse_rests() {
        let mut panel = rows_of(MANY + 1);
        assert!(drag(&mut panel, 14.0).is_empty());
        assert!(drag(&mut panel, 15.0).is_empty(), "still in motion");
        assert!(has_dragged_key(&drag(&mut panel, 15.0)));
    }
}
