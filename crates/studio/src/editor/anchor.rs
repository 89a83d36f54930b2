//! Another anchor for boards, which stay where they are.

use super::{Edit, EditError, LayoutEditor, Part, edit};
use ademan_core::document::Document;
use ademan_core::kinematics::HandPose;
use ademan_core::layout::{Layout, LayoutDraft};

/// The field with the anchor.
pub const ANCHOR: &str = "pose.anchor";

impl LayoutEditor {
    /// Sets the anchor of parts in one step. A board that has a place around these hands with both anchors stays there.
    pub fn set_anchor(
        &mut self,
        parts: &[Part],
        anchor: &str,
        hands: &[HandPose],
    ) -> Result<(), EditError> {
        let set = Edit::SetField {
            parts: parts.to_vec(),
            field: ANCHOR.to_owned(),
            value: Some(anchor.to_owned()),
        };
        let mut edited = edit(&self.text, &set)?;
        for &part in parts {
            let Some(by_mm) = self.way_back(part, &edited.text, hands) else {
                continue;
            };
            let back = Edit::MoveInSpace {
                parts: vec![part],
                by_mm,
            };
            if let Ok(moved) = edit(&edited.text, &back) {
                edited.patches.extend(moved.patches);
                edited.text = moved.text;
            }
        }
        self.adopt(edited)
    }

    /// Returns the way from the place of a board in a text to its present one: to the right, away from the wearer and up, in
    /// millimetres. `None` for other parts, and without one of the places.
    fn way_back(&self, part: Part, text: &str, hands: &[HandPose]) -> Option<[f64; 3]> {
        let Part::Board(board) = part else {
            return None;
        };
        let present = self.layout.as_ref().filter(|_| self.is_read)?;
        let document = Document::new(self.name(), text);
        let (edited, _) = LayoutDraft::read(&document, self.fit).ok()?.into_parts();
        let place = |layout: &Layout| {
            let surface = layout.scene.surfaces().get(board)?;
            let mut hands = hands.iter();
            let pose = hands.find_map(|hand| surface.world_from_surface(hand))?;
            Some(pose.translation)
        };
        let way = place(present)? - place(&edited)?;
        Some([way.x, -way.z, way.y].map(|metres| (f64::from(metres) * 1e4).round() / 10.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::canvas::plan::at_start;
    use ademan_core::layout::Fit;
    use ademan_runtime::setup::Setup;

    #[test]
    fn a_board_stays_where_it_is_with_another_anchor() {
        let setup = Setup::default().load_files().unwrap();
        for shape in ["", "shape: Arc(radius_mm: 90),"] {
            for anchor in ["wrist", "world", "start"] {
                let text = format!(
                    "Layout(name: \"a\", boards: [\n(pose: (anchor: elbow, bearing_deg: 35, forward_mm: 300, \
                     height_mm: -45), {shape} keys: [(code: \"A\", at_mm: (0, 0))])])"
                );
                let mut editor = LayoutEditor::from_text("a.ron", &text, Fit::default());
                let layout = editor.layout().unwrap();
                let hands = at_start(setup.hands_at_rest(layout));
                let place = |shown: &LayoutEditor| {
                    let surface = &shown.layout().unwrap().scene.surfaces()[0];
                    surface.world_from_surface(&hands[0]).unwrap().translation
                };
                let before = place(&editor);
                let board = Part::Board(0);
                editor.set_anchor(&[board], anchor, &hands).unwrap();
                assert!(editor.is_valid(), "{:?}", editor.problems());
                assert_eq!(editor.value(board, ANCHOR), Some(anchor));
                let moved = place(&editor).distance(before);
                assert!(moved < 3e-4, "{anchor}: {moved} m in {}", editor.text());
                assert_eq!(editor.selection(), [board]);
                assert!(editor.undo());
                assert_eq!(editor.text(), text);
            }
        }
    }

    #[test]
    fn a_board_without_a_place_keeps_its_numbers() {
        let text = "Layout(name: \"a\", boards: [(pose: (anchor: elbow, forward_mm: 300), keys: [(code: \"A\", at_mm: (0, 0))])])";
        let mut editor = LayoutEditor::from_text("a.ron", text, Fit::default());
        let board = Part::Board(0);
        editor.set_anchor(&[board], "wrist", &[]).unwrap();
        assert_eq!(editor.text(), text.replace("elbow", "wrist"));
    }
}
