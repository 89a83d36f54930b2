//! `.dof` files: JSON with layers of rows.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::{Grid, ImportError, ImportedKey, place_rows};
use crate::device::KeyCode;
use crate::message::escape;

/// A file, as far as it is used.
#[derive(Deserialize)]
struct Dof {
    name: Option<String>,
    #[serde(default)]
    authors: Vec<String>,
    board: Option<String>,
    #[serde(default)]
    anchor: Option<[usize; 2]>,
    layers: BTreeMap<String, Vec<String>>,
    #[serde(default)]
    combos: BTreeMap<String, serde_json::Value>,
    #[serde(default)]
    magic: BTreeMap<String, serde_json::Value>,
}

/// The layer without modifiers.
const MAIN: &str = "main";
/// The layer of Shift.
const SHIFT: &str = "shift";

pub(super) fn read(text: &str, stem: &str) -> Result<Grid, ImportError> {
    let value: serde_json::Value = serde_json::from_str(text).map_err(|error| {
        ImportError::Format(format!(
            "the file starts like JSON but is not valid: {error}"
        ))
    })?;
    if let Some(object) = value.as_object()
        && object.contains_key("keys")
        && !object.contains_key("layers")
    {
        let message = "the file has `keys` and no `layers`, as files of other layout analyzers";
        return Err(ImportError::Format(message.to_owned()));
    }
    let dof: Dof = serde_json::from_value(value)
        .map_err(|error| ImportError::Format(format!("the JSON is not a .dof file: {error}")))?;
    let Some(main) = dof.layers.get(MAIN) else {
        return Err(ImportError::Content(format!(
            "the file has no layer `{MAIN}`; it has {}",
            names(dof.layers.keys())
        )));
    };
    let authors = dof.authors.join(", ");
    let mut grid = Grid {
        name: dof.name.clone().unwrap_or_else(|| stem.to_owned()),
        origin: if authors.is_empty() {
            "imported from a .dof file".to_owned()
        } else {
            format!("by {authors}, imported from a .dof file")
        },
        is_ortho: matches!(dof.board.as_deref(), Some("ortho" | "colstag")),
        ..Grid::default()
    };
    let rows: Vec<Vec<String>> = main.iter().map(|row| words(row)).collect();
    let first = dof.anchor.map(|[_, y]| y);
    // The anchor is the physical column of the first key; the letters begin in column 1.
    if let Some([x, _]) = dof.anchor
        && x > 1
    {
        return Err(ImportError::Content(format!(
            "the anchor is in column {x}; the first key is in column 0 or 1"
        )));
    }
    let leading = dof.anchor.map(|[x, _]| 1_usize.saturating_sub(x));
    place_rows(&mut grid, &rows, first, leading)?;
    let others: Vec<&String> = dof
        .layers
        .keys()
        .filter(|name| ![MAIN, SHIFT].contains(&name.as_str()))
        .collect();
    if !others.is_empty() {
        grid.notes
            .push(format!("layers left out: {}", names(others.into_iter())));
    }
    if let Some(shift) = dof.layers.get(SHIFT) {
        let shifted: Vec<Vec<String>> = shift.iter().map(|row| words(row)).collect();
        let count = other_shifts(&rows, &shifted);
        if count > 0 {
            grid.notes.push(format!(
                "{count} keys type something else with Shift than on a US keymap: the receiver's keymap decides what Shift types"
            ));
        }
    }
    if !dof.combos.is_empty() {
        grid.notes.push("combos left out".to_owned());
    }
    if !dof.magic.is_empty() {
        grid.notes.push("magic keys left out".to_owned());
    }
    Ok(grid)
}

fn words(row: &str) -> Vec<String> {
    row.split_whitespace().map(str::to_owned).collect()
}

fn names<'a>(names: impl Iterator<Item = &'a String>) -> String {
    let names: Vec<String> = names.map(|name| format!("`{}`", escape(name))).collect();
    names.join(", ")
}

/// Returns the number of keys whose shifted character differs from a US keymap.
fn other_shifts(main: &[Vec<String>], shift: &[Vec<String>]) -> usize {
    let rows = main.iter().zip(shift);
    let pairs = rows.flat_map(|(plain, shifted)| plain.iter().zip(shifted));
    let is_other = |(plain, shifted): &(&String, &String)| {
        let key = |word: &str| match super::key(word, 0, 0) {
            Ok(ImportedKey::Character(character)) => Some(character),
            _ => None,
        };
        let (Some(plain), Some(_)) = (key(plain), key(shifted)) else {
            return false;
        };
        let shifted = shifted.trim_start_matches('\\').chars().next();
        let mut codes = KeyCode::for_us_character(plain);
        let own = codes.next().and_then(|(code, _)| code.us_character(true));
        own.is_some() && own != shifted && !(shifted == Some('\\') || shifted.is_none())
    };
    pairs.filter(is_other).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_compared_with_those_of_the_same_row_with_shift() {
        let rows = |lines: [&str; 2]| lines.map(words);
        let plain = rows(["a b c", "1 2"]);
        assert_eq!(other_shifts(&plain, &rows(["A B C", "! @"])), 0);
        assert_eq!(other_shifts(&plain, &rows(["A", "! @"])), 0);
        assert_eq!(other_shifts(&plain, &rows(["A B C", "! \""])), 1);
    }
}
