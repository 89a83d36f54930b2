//! The numbers of a layout file's places, written anew; all else in the file stays as it is.

use std::ops::Range;

use ron::value::RawValue;
use serde::Deserialize;

use super::error::{LayoutError, offset_of};
use super::file::Document;
use super::number::{Distance, Tilt};
use super::placement::anchor_from_board;
use super::written;
use crate::contact::place::Place;

/// The text of a layout with its boards in these places, one for each; millimetres and degrees to the
/// hundredth. Boards that are there already keep their numbers. The bearing stays as it is.
///
/// An error when the text is no layout, or when a place cannot be written.
pub fn moved(document: &Document, places: &[Place]) -> Result<String, LayoutError> {
    rewrite(document, |number, board| {
        let place = places.get(number)?;
        let written = Place::of(&anchor_from_board(board));
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
            distance("right_mm", written.right, place.right, Some(fields.right_mm)),
            distance("forward_mm", written.forward, place.forward, fields.forward_mm),
            distance("height_mm", written.height, place.height, Some(fields.height_mm)),
            is_tilted.then(|| ("tilt_deg", tilt.clamp(*Tilt::RANGE.start(), *Tilt::RANGE.end()))),
        ];
        Some(changes.into_iter().flatten().collect())
    })
}

/// The text of a layout with all its boards so many times as large as they are.
///
/// An error when the text is no layout. What is too large or too small for a file is written all the
/// same: reading it tells so.
pub fn scaled(document: &Document, factor: f32) -> Result<String, LayoutError> {
    rewrite(document, |_, board| {
        let scale = board.place.scale.get() * f64::from(factor);
        Some(vec![("scale", (scale * 1e4).round() / 1e4)])
    })
}

/// A field of a place and its new value.
type Change = (&'static str, f64);

fn rewrite(
    document: &Document,
    changes: impl Fn(usize, &written::Board) -> Option<Vec<Change>>,
) -> Result<String, LayoutError> {
    let layout: written::Layout = document.parse()?;
    let pieces: Pieces = document.parse()?;
    let mut edits: Vec<(Range<usize>, String)> = Vec::new();
    for (number, (board, piece)) in layout.boards.iter().zip(&pieces.boards).enumerate() {
        let place: PlacePieces = super::parse(piece.place.get_ron(), &document.file)?;
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
    #[serde(borrow)]
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
    let start = offset_of(text, piece).expect("it was read from this text");
    start..start + piece.len()
}

/// To two decimals; 0 has no sign.
fn hundredths(value: f32) -> f64 {
    (f64::from(value) * 100.0).round() / 100.0 + 0.0
}
