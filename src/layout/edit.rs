//! The numbers of a layout file's places, written anew; all else in the file stays as it is.

use std::ops::Range;

use ron::value::RawValue;
use serde::Deserialize;

use super::placement::anchor_from_board;
use super::ranged::{Distance, Tilt};
use super::schema;
use crate::contact::board_pose::BoardPose;
use crate::document::Document;
use crate::document::{DocumentError, byte_offset};

/// The text of a layout with its boards in these places, one for each; millimetres and degrees to the
/// hundredth. Boards that are there already keep their numbers. The bearing stays as it is.
///
/// An error when the text is no layout, or when a place cannot be written.
pub fn move_boards(document: &Document, places: &[BoardPose]) -> Result<String, DocumentError> {
    rewrite(document, |number, board| {
        let place = places.get(number)?;
        let written = BoardPose::from_pose(&anchor_from_board(board));
        let distance = |field, old: f32, new: f32, from: Option<Distance>| {
            let (old, new) = (hundredths(old * 1e3), hundredths(new * 1e3));
            let (low, high) = (*Distance::RANGE.start(), *Distance::RANGE.end());
            let is_new = old != new && from.map(Distance::get) != Some(new);
            is_new.then(|| (field, new.clamp(low, high)))
        };
        let tilt = hundredths(place.tilt.to_degrees());
        let is_tilted = tilt != hundredths(written.tilt.to_degrees());
        let fields = &board.place;
        let changes = [
            distance(
                "right_mm",
                written.right,
                place.right,
                Some(fields.right_mm),
            ),
            distance(
                "forward_mm",
                written.forward,
                place.forward,
                fields.forward_mm,
            ),
            distance(
                "height_mm",
                written.height,
                place.height,
                Some(fields.height_mm),
            ),
            is_tilted.then(|| {
                (
                    "tilt_deg",
                    tilt.clamp(*Tilt::RANGE.start(), *Tilt::RANGE.end()),
                )
            }),
        ];
        Some(changes.into_iter().flatten().collect())
    })
}

/// The text of a layout with all its boards so many times as large as they are.
///
/// An error when the text is no layout. What is too large or too small for a file is written all the
/// same: reading it tells so.
pub fn scale_boards(document: &Document, factor: f32) -> Result<String, DocumentError> {
    rewrite(document, |_, board| {
        let scale = board.place.scale.get() * f64::from(factor);
        Some(vec![("scale", (scale * 1e4).round() / 1e4)])
    })
}

/// A field of a place and its new value.
type Change = (&'static str, f64);

fn rewrite(
    document: &Document,
    changes: impl Fn(usize, &schema::Board) -> Option<Vec<Change>>,
) -> Result<String, DocumentError> {
    let layout: schema::Layout = document.parse()?;
    let pieces: Pieces = document.parse()?;
    let mut edits: Vec<(Range<usize>, String)> = Vec::new();
    for (number, (board, piece)) in layout.boards.iter().zip(&pieces.boards).enumerate() {
        let place: PlacePieces = crate::document::parse_ron(piece.place.get_ron(), &document.file)?;
        for (field, value) in changes(number, board).unwrap_or_default() {
            edits.push(match place.of(field) {
                Some(old) => (range(&document.text, old), value.to_string()),
                None => {
                    let end = range(&document.text, place.anchor).end;
                    (end..end, format!(", {field}: {value}"))
                }
            });
        }
    }
    // From the last to the first, so that ranges stay right; those at one place in reverse order too.
    edits.sort_by_key(|(range, _)| range.start);
    let mut text = document.text.clone();
    for (range, new) in edits.into_iter().rev() {
        text.replace_range(range, &new);
    }
    Ok(text)
}

/// Where the places of a file are.
#[derive(Deserialize)]
#[serde(rename = "Layout")]
struct Pieces<'a> {
    #[serde(borrow, default)]
    boards: Vec<BoardPieces<'a>>,
}

#[derive(Deserialize)]
#[serde(rename = "Board")]
struct BoardPieces<'a> {
    #[serde(borrow)]
    place: &'a RawValue,
}

/// Where the numbers of a place are.
#[derive(Deserialize)]
#[serde(rename = "Place")]
struct PlacePieces<'a> {
    #[serde(borrow)]
    anchor: &'a RawValue,
    #[serde(borrow, default)]
    right_mm: Option<&'a RawValue>,
    #[serde(borrow, default)]
    forward_mm: Option<&'a RawValue>,
    #[serde(borrow, default)]
    height_mm: Option<&'a RawValue>,
    #[serde(borrow, default)]
    tilt_deg: Option<&'a RawValue>,
    #[serde(borrow, default)]
    scale: Option<&'a RawValue>,
}

impl<'a> PlacePieces<'a> {
    fn of(&self, field: &str) -> Option<&'a RawValue> {
        match field {
            "right_mm" => self.right_mm,
            "forward_mm" => self.forward_mm,
            "height_mm" => self.height_mm,
            "tilt_deg" => self.tilt_deg,
            _ => self.scale,
        }
    }
}

/// Where a piece of a text is in it, without the blanks and comments around it.
fn range(text: &str, piece: &RawValue) -> Range<usize> {
    let piece = piece.trim().get_ron();
    let start = byte_offset(text, piece).expect("it was read from this text");
    start..start + piece.len()
}

/// To two decimals; 0 has no sign.
fn hundredths(value: f32) -> f64 {
    (f64::from(value) * 100.0).round() / 100.0 + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::Layout;

    const COMMENTED: &str = r#"#![enable(implicit_some)]
// mine
Layout(
    name: "a // no comment", // here
    boards: [
        (
            place: Place( // there
                anchor: /* the */ elbow /* joint */, // of the arm
                height_mm: -45.0 /* below */,
                /* forward_mm: 1, */ forward_mm: Some(300), // ahead
            ),
            rows: [(at_mm: (0, 0), keys: "A B")],
        ),
        (rows: [(at_mm: (0, 0), keys: "C")], place: (anchor:world)),
    ],
)
"#;

    fn document(text: &str) -> Document {
        Document::new("a.ron", text)
    }

    fn places(text: &str) -> Vec<BoardPose> {
        let layout = Layout::parse(text, "a.ron").unwrap_or_else(|error| panic!("{error}"));
        let surfaces = layout.scene.surfaces().iter();
        surfaces
            .map(|surface| BoardPose::from_pose(&surface.anchor_from_surface()))
            .collect()
    }

    #[test]
    fn only_numbers_change_and_comments_stay() {
        let mut moved_to = places(COMMENTED);
        moved_to[0].height = -0.0512;
        moved_to[0].forward = 0.2;
        moved_to[1].tilt = 0.5_f32.to_radians();
        moved_to[1].right = -0.01;
        let text = move_boards(&document(COMMENTED), &moved_to).unwrap();
        let expected = COMMENTED
            .replace("-45.0 ", "-51.2 ")
            .replace("Some(300)", "Some(200)")
            .replace("anchor:world", "anchor:world, right_mm: -10, tilt_deg: 0.5");
        assert_eq!(text, expected);
        let larger = scale_boards(&document(&text), 1.25).unwrap();
        let twice = scale_boards(&document(&larger), 1.2).unwrap();
        let expected = expected
            .replace("elbow /*", "elbow, scale: 1.5 /*")
            .replace("anchor:world", "anchor:world, scale: 1.5");
        assert_eq!(twice, expected);
    }

    #[test]
    fn what_was_not_moved_keeps_its_numbers_as_they_are_written() {
        let text = COMMENTED.replace("-45.0", "-45.00123");
        assert_eq!(move_boards(&document(&text), &places(&text)).unwrap(), text);
    }

    #[test]
    fn a_layout_without_boards_stays_as_it_is() {
        let ray = Document::shipped("ray").unwrap();
        assert_eq!(move_boards(&ray, &[]).as_ref(), Ok(&ray.text));
        assert_eq!(scale_boards(&ray, 2.0).as_ref(), Ok(&ray.text));
    }

    #[test]
    fn every_place_is_read_back_as_it_was_written() {
        let mut number = fastrand::Rng::with_seed(11);
        let mut between = |low: f32, high: f32| low + (high - low) * number.f32();
        for _ in 0..500 {
            let bearing = between(-180.0, 180.0);
            let text =
                COMMENTED.replace("height_mm", &format!("bearing_deg: {bearing}, height_mm"));
            let mut wanted = places(&text);
            for place in &mut wanted {
                place.right = between(-2.0, 2.0);
                place.height = between(-2.0, 2.0);
                place.forward = between(-2.0, 2.0);
                place.tilt = between(-90.0, 90.0).to_radians();
            }
            let written = move_boards(&document(&text), &wanted).unwrap();
            for (found, wanted) in places(&written).iter().zip(&wanted) {
                let off = (found.to_pose().translation - wanted.to_pose().translation).abs();
                assert!(off.max_element() < 1e-5, "{found:?} for {wanted:?}");
                assert!((found.tilt - wanted.tilt).abs() < 1e-4);
            }
            let again = move_boards(&document(&written), &wanted).unwrap();
            assert_eq!(again, written, "a second save has nothing to do");
        }
    }
}
