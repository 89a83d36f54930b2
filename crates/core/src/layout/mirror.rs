//! The mirror image of a layout, for the other hand. Comments, spelling and order of the text stay as they are.

use std::ops::Range;

use super::edit::{items_of, replace_ranges, stated, tree_of};
use super::load::LayoutSchema;
use crate::document::{Document, DocumentError, Item, Node, parse_ron};
use crate::hand::Side;

/// Returns the text of a layout for the other hand: the poses of boards, boxes and spaces are mirrored, and boards are reserved
/// for that hand, the left one if the text names none. Pointers and triggers for one hand are for its opposite.
///
/// Keys keep their order. A board whose keys are for fingers is mirrored with its keys, and angles that move a cursor sideways
/// are reversed. Returns an error if the text is not a layout, or has boards for both hands.
pub fn mirror_layout(document: &Document) -> Result<String, DocumentError> {
    let schema: LayoutSchema = document.parse()?;
    let (text, tree) = (&document.text, tree_of(document)?);
    let mut sides = schema.boards.iter().filter_map(|board| board.hand);
    let side = sides.next();
    if sides.any(|other| Some(other) != side) {
        let message = "the layout has boards for both hands, so that no hand needs a mirror image";
        return Err(DocumentError::for_file(&document.file, message));
    }
    let side = side.map_or(Side::Left, Side::opposite);
    let mut edits = Edits {
        document,
        list: Vec::new(),
    };
    for board in items_of(&tree, text, "boards") {
        edits.mirror_board(&board.value, side);
    }
    let pointer = tree.field(text, "pointer");
    if let Some(mode) = pointer.and_then(|pointer| pointer.field(text, "mode")) {
        edits.mirror_pointer(mode);
    }
    let triggers = items_of(&tree, text, "triggers").iter();
    for owner in pointer.into_iter().chain(triggers.map(|item| &item.value)) {
        if let Some(hand) = stated(owner, text, "hand") {
            edits.exchange_hand(hand)?;
        }
    }
    for space in items_of(&tree, text, "spaces") {
        edits.mirror_pose(&space.value);
        for target in items_of(&space.value, text, "targets") {
            edits.negate(target.value.at(text, ["at_mm", "0"]));
        }
    }
    Ok(replace_ranges(text, edits.list))
}

/// The replacements in a text.
struct Edits<'a> {
    document: &'a Document,
    list: Vec<(Range<usize>, String)>,
}

impl Edits<'_> {
    fn mirror_board(&mut self, board: &Node, side: Side) {
        self.mirror_pose(board);
        let text = &self.document.text;
        let quoted = format!("\"{side}\"");
        if let Some(hand) = board.field(text, "hand") {
            self.replace(hand, quoted);
        } else if let Some(pose) = board.field(text, "pose") {
            let end = pose.range.end;
            self.list.push((end..end, format!(", hand: {quoted}")));
        }
        let keys = items_of(board, text, "keys");
        let has_finger = |key: &Item| stated(&key.value, text, "finger").is_some();
        if keys.iter().any(has_finger) {
            for key in keys {
                // A mirror keeps rotations about x, and reverses the others.
                for sideways in [["at_mm", "0"], ["rotation_deg", "1"], ["rotation_deg", "2"]] {
                    self.negate(key.value.at(text, sideways));
                }
            }
        }
    }

    /// Mirrors the field `pose` of a part.
    fn mirror_pose(&mut self, part: &Node) {
        for sideways in ["bearing_deg", "right_mm"] {
            self.negate(part.at(&self.document.text, ["pose", sideways]));
        }
    }

    fn mirror_pointer(&mut self, mode: &Node) {
        let text = &self.document.text;
        let input = mode.field(text, "input").unwrap_or(mode);
        match input.name(text) {
            Some("Direct" | "Ray" | "Fingertip") => self.mirror_pose(input),
            Some("Joint" | "Angles") => {
                let end = |name| input.at(text, ["x", name]);
                if let (Some(from), Some(to)) = (end("from_deg"), end("to_deg")) {
                    self.replace(from, to.text(text).to_owned());
                    self.replace(to, from.text(text).to_owned());
                }
            }
            // The motions of `Arm` are in the frame of the world, and a stick is not mirrored with the hand.
            _ => {}
        }
    }

    /// Replaces the name of a hand by the name of the other one.
    fn exchange_hand(&mut self, hand: &Node) -> Result<(), DocumentError> {
        let side: Side = parse_ron(hand.text(&self.document.text), &self.document.file)?;
        self.replace(hand, format!("\"{}\"", side.opposite()));
        Ok(())
    }

    /// Changes the sign of a number that is written, unless it is 0.
    fn negate(&mut self, number: Option<&Node>) {
        let Some(number) = number else {
            return;
        };
        let text = number.text(&self.document.text);
        if text.parse() == Ok(0.0) {
            return;
        }
        let negated = match text.strip_prefix('-') {
            Some(positive) => positive.to_owned(),
            None => format!("-{}", text.trim_start_matches('+')),
        };
        self.replace(number, negated);
    }

    fn replace(&mut self, value: &Node, new: String) {
        self.list.push((value.range.clone(), new));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::shipped_layouts;
    use crate::layout::Layout;

    fn mirrored(text: &str) -> Result<String, DocumentError> {
        mirror_layout(&Document::new("a.ron", text))
    }

    #[test]
    fn poses_and_the_keys_of_fingers_are_mirrored_and_rows_keep_their_order() {
        let text = "Layout(name: \"a\", boards: [\n\
                    (pose: (anchor: elbow, bearing_deg: 35 /* right */, right_mm: -2.5), rows: [(at_mm: (-5, 0), keys: \"A\")]),\n\
                    (hand: \"right\", pose: (anchor: wrist), keys: [(code: \"B\", finger: \"thumb\", at_mm: (-20, 3)), (code: \"C\", at_mm: (0, 30))]),\n\
                    ])";
        let expected = text
            .replace("deg: 35 /", "deg: -35 /")
            .replace("right_mm: -2.5)", "right_mm: 2.5), hand: \"left\"")
            .replace("hand: \"right\"", "hand: \"left\"")
            .replace("(-20, 3)", "(20, 3)");
        assert_eq!(mirrored(text).as_deref(), Ok(&*expected));
        let back = text.replace("right_mm: -2.5)", "right_mm: -2.5), hand: \"right\"");
        assert_eq!(mirrored(&expected).as_deref(), Ok(&*back));
    }

    #[test]
    fn hands_of_pointers_and_triggers_are_exchanged_and_keys_of_fingers_turn_the_other_way() {
        let text = "Layout(name: \"a\", boards: [(pose: (anchor: wrist), hand: \"right\", keys: [\
                    (code: \"B\", finger: \"index\", at_mm: (0, 3), rotation_deg: (10, -20, 30)),\
                    (code: \"C\", at_mm: (0, 30), rotation_deg: (0, 0, 5)),\
                    ])], triggers: [\
                    (name: \"T\", hand: \"right\", when: Pinch(finger: \"index\"), action: Key(\"D\")),\
                    (name: \"U\", when: Pinch(finger: \"middle\"), action: Key(\"E\")),\
                    ], pointer: (hand: \"right\", mode: Ray(pose: (anchor: elbow, right_mm: 5), size_mm: (200, 100))))";
        let expected = text
            .replace("hand: \"right\"", "hand: \"left\"")
            .replace("(10, -20, 30)", "(10, 20, -30)")
            .replace("(0, 0, 5)", "(0, 0, -5)")
            .replace("right_mm: 5", "right_mm: -5");
        assert_eq!(mirrored(text).as_deref(), Ok(&*expected));
        assert_eq!(mirrored(&expected).as_deref(), Ok(text));
    }

    #[test]
    fn a_board_whose_hand_is_none_gets_the_left_one() {
        let text = "Layout(name: \"a\", boards: [(pose: (anchor: elbow), hand: None, \
                    rows: [(at_mm: (0, 0), keys: \"A\")])])";
        let expected = text.replace("None", "\"left\"");
        assert_eq!(mirrored(text).as_deref(), Ok(&*expected));
    }

    #[test]
    fn angles_and_targets_sideways_are_reversed() {
        let joint = Document::shipped("joint").unwrap();
        let text = mirror_layout(&joint).unwrap();
        assert!(text.contains("from_deg: 20, to_deg: -12"), "{text}");
        assert!(text.contains("from_deg: 30, to_deg: -30"), "{text}");
        assert!(
            text.contains("name: \"Left\", at_mm: (100, 0, 0)"),
            "{text}"
        );
    }

    #[test]
    fn every_shipped_layout_for_one_hand_has_a_mirror_image() {
        for name in shipped_layouts() {
            let document = Document::shipped(name).unwrap();
            let layout = Layout::from_document(document.clone()).unwrap();
            match mirror_layout(&document) {
                Ok(text) => {
                    let other = Layout::parse(&text, name).unwrap();
                    let targets = |counted: &Layout| (counted.keys.len(), counted.controls.len());
                    assert_eq!(targets(&other), targets(&layout), "{name}");
                    assert!(!layout.has_board_for(Side::Left), "{name}");
                }
                Err(error) => {
                    assert!(layout.has_board_for(Side::Left), "{name}: {error}");
                    assert!(error.message().contains("both hands"), "{error}");
                }
            }
        }
    }
}
