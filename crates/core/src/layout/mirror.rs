//! The mirror image of a layout, for the other hand. Comments, spelling and order of the text stay as they are.

use std::ops::Range;

use ron::value::RawValue;
use serde::Deserialize;

use super::edit::{byte_range, replace_ranges};
use super::load::LayoutSchema;
use crate::document::{Document, DocumentError, parse_ron};
use crate::hand::Side;

/// Returns the text of a layout for the other hand: the poses of boards, boxes and spaces are mirrored, and boards are reserved
/// for that hand, the left one if the text names none. Pointers and triggers for one hand are for its opposite.
///
/// Keys keep their order. A board whose keys are for fingers is mirrored with its keys, and angles that move a cursor sideways
/// are reversed. Returns an error if the text is not a layout, or has boards for both hands.
pub fn mirror_layout(document: &Document) -> Result<String, DocumentError> {
    let schema: LayoutSchema = document.parse()?;
    let raw: RawLayout = document.parse()?;
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
    for board in &raw.boards {
        edits.mirror_board(board, side)?;
    }
    if let Some(pointer) = &raw.pointer {
        edits.mirror_pointer(&pointer.mode)?;
    }
    let pointer_hand = raw.pointer.iter().filter_map(|pointer| pointer.hand);
    let trigger_hands = raw.triggers.iter().filter_map(|trigger| trigger.hand);
    for hand in pointer_hand.chain(trigger_hands) {
        edits.exchange_hand(hand)?;
    }
    for space in &raw.spaces {
        edits.mirror_pose(space.pose)?;
        for target in &space.targets {
            edits.negate(target.at_mm.0);
        }
    }
    Ok(replace_ranges(&document.text, edits.list))
}

/// The replacements in a text.
struct Edits<'a> {
    document: &'a Document,
    list: Vec<(Range<usize>, String)>,
}

impl<'a> Edits<'a> {
    fn mirror_board(&mut self, board: &RawBoard<'a>, side: Side) -> Result<(), DocumentError> {
        self.mirror_pose(board.pose)?;
        let quoted = format!("\"{side}\"");
        match board.hand {
            Some(hand) => self.replace(hand, quoted),
            None => {
                let end = byte_range(&self.document.text, board.pose).end;
                self.list.push((end..end, format!(", hand: {quoted}")));
            }
        }
        if board.keys.iter().any(|key| key.finger.is_some()) {
            for key in &board.keys {
                self.negate(key.at_mm.0);
                // A mirror keeps rotations about x, and reverses the others.
                if let Some((_, about_y, about_z)) = key.rotation_deg {
                    self.negate(about_y);
                    self.negate(about_z);
                }
            }
        }
        Ok(())
    }

    fn mirror_pose(&mut self, pose: &'a RawValue) -> Result<(), DocumentError> {
        let pose: RawPose = parse_ron(pose.get_ron(), &self.document.file)?;
        for sideways in [pose.bearing_deg, pose.right_mm].into_iter().flatten() {
            self.negate(sideways);
        }
        Ok(())
    }

    fn mirror_pointer(&mut self, mode: &RawMode<'a>) -> Result<(), DocumentError> {
        match mode {
            RawMode::Direct { pose }
            | RawMode::Ray { pose }
            | RawMode::Rate {
                input: RawDisplacement::Fingertip { pose },
            } => self.mirror_pose(pose),
            RawMode::Joint { x }
            | RawMode::Rate {
                input: RawDisplacement::Angles { x },
            } => {
                self.replace(x.from_deg, x.to_deg.trim().get_ron().to_owned());
                self.replace(x.to_deg, x.from_deg.trim().get_ron().to_owned());
                Ok(())
            }
            // The motions are in the frame of the world, and a stick is not mirrored with the hand.
            RawMode::Arm {}
            | RawMode::Rate {
                input: RawDisplacement::Stick,
            } => Ok(()),
        }
    }

    /// Replaces the name of a hand by the name of the other one.
    fn exchange_hand(&mut self, hand: &'a RawValue) -> Result<(), DocumentError> {
        let side: Side = parse_ron(hand.get_ron(), &self.document.file)?;
        self.replace(hand, format!("\"{}\"", side.opposite()));
        Ok(())
    }

    /// Changes the sign of a number, unless it is 0.
    fn negate(&mut self, number: &'a RawValue) {
        let text = number.trim().get_ron();
        if text.parse() == Ok(0.0) {
            return;
        }
        let negated = match text.strip_prefix('-') {
            Some(positive) => positive.to_owned(),
            None => format!("-{}", text.trim_start_matches('+')),
        };
        self.replace(number, negated);
    }

    fn replace(&mut self, value: &'a RawValue, new: String) {
        self.list
            .push((byte_range(&self.document.text, value), new));
    }
}

/// The slices of a layout that are mirrored.
#[derive(Deserialize)]
#[serde(rename = "Layout")]
struct RawLayout<'a> {
    #[serde(borrow, default)]
    boards: Vec<RawBoard<'a>>,
    #[serde(borrow, default)]
    triggers: Vec<RawTrigger<'a>>,
    #[serde(borrow, default)]
    pointer: Option<RawPointer<'a>>,
    #[serde(borrow, default)]
    spaces: Vec<RawSpace<'a>>,
}

#[derive(Deserialize)]
#[serde(rename = "Board")]
struct RawBoard<'a> {
    #[serde(borrow)]
    pose: &'a RawValue,
    #[serde(borrow, default)]
    hand: Option<&'a RawValue>,
    #[serde(borrow, default)]
    keys: Vec<RawKey<'a>>,
}

#[derive(Deserialize)]
#[serde(rename = "Key")]
struct RawKey<'a> {
    #[serde(borrow, default)]
    finger: Option<&'a RawValue>,
    #[serde(borrow)]
    at_mm: (&'a RawValue, &'a RawValue),
    #[serde(borrow, default)]
    rotation_deg: Option<(&'a RawValue, &'a RawValue, &'a RawValue)>,
}

#[derive(Deserialize)]
#[serde(rename = "Trigger")]
struct RawTrigger<'a> {
    #[serde(borrow, default)]
    hand: Option<&'a RawValue>,
}

#[derive(Deserialize)]
#[serde(rename = "Pose")]
struct RawPose<'a> {
    #[serde(borrow, default)]
    bearing_deg: Option<&'a RawValue>,
    #[serde(borrow, default)]
    right_mm: Option<&'a RawValue>,
}

#[derive(Deserialize)]
#[serde(rename = "Pointer")]
struct RawPointer<'a> {
    #[serde(borrow, default)]
    hand: Option<&'a RawValue>,
    #[serde(borrow)]
    mode: RawMode<'a>,
}

#[derive(Deserialize)]
#[serde(rename = "PointingMode")]
enum RawMode<'a> {
    Joint {
        #[serde(borrow)]
        x: RawAngle<'a>,
    },
    Direct {
        #[serde(borrow)]
        pose: &'a RawValue,
    },
    Ray {
        #[serde(borrow)]
        pose: &'a RawValue,
    },
    Rate {
        #[serde(borrow)]
        input: RawDisplacement<'a>,
    },
    Arm {},
}

#[derive(Deserialize)]
#[serde(rename = "Displacement")]
enum RawDisplacement<'a> {
    Fingertip {
        #[serde(borrow)]
        pose: &'a RawValue,
    },
    Angles {
        #[serde(borrow)]
        x: RawAngle<'a>,
    },
    Stick,
}

#[derive(Deserialize)]
#[serde(rename = "AngleMapping")]
struct RawAngle<'a> {
    #[serde(borrow)]
    from_deg: &'a RawValue,
    #[serde(borrow)]
    to_deg: &'a RawValue,
}

#[derive(Deserialize)]
#[serde(rename = "Space")]
struct RawSpace<'a> {
    #[serde(borrow)]
    pose: &'a RawValue,
    #[serde(borrow)]
    targets: Vec<RawTarget<'a>>,
}

#[derive(Deserialize)]
#[serde(rename = "Target")]
struct RawTarget<'a> {
    #[serde(borrow)]
    at_mm: (&'a RawValue, &'a RawValue, &'a RawValue),
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
