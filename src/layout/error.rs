//! What is wrong with a file, and where: a line for the message, and the place as its reader sees it.

use std::fmt;
use std::ops::Range;

/// The widest excerpt of a source line that is shown, in characters.
const EXCERPT_WIDTH: usize = 90;

/// How much of a long line is shown before the place.
const EXCERPT_LEAD: usize = 50;

/// A file that cannot be used.
///
/// Shown as `FILE:LINE:COLUMN: message`, then the source line and a caret under the place; without
/// the place as `FILE: message`, when the file could not be read at all.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file}{}: {message}{}", colon(.place), excerpt(.place))]
pub struct DocumentError {
    file: String,
    message: String,
    place: Option<TextPosition>,
}

/// A place in a text, for a reader.
#[derive(Clone, Debug, PartialEq, Eq)]
struct TextPosition {
    /// From 1.
    line: usize,
    /// In characters, from 1.
    column: usize,
    /// How many characters are meant; at least 1.
    width: usize,
    /// The line as it stands in the file.
    source: String,
}

impl DocumentError {
    /// An error of the file as a whole.
    pub fn for_file(file: &str, message: impl fmt::Display) -> Self {
        Self {
            file: file.to_owned(),
            message: message.to_string(),
            place: None,
        }
    }

    /// An error at the bytes `range` of `text`. A range that is not within the text, or that cuts a
    /// character, is moved to the nearest character before it.
    pub fn at(file: &str, text: &str, range: Range<usize>, message: impl fmt::Display) -> Self {
        Self {
            file: file.to_owned(),
            message: message.to_string(),
            place: Some(TextPosition::of(text, range)),
        }
    }

    /// An error at `part`, a piece that was borrowed from `text`; at its start when it is not part of it.
    pub fn at_slice(file: &str, text: &str, part: &str, message: impl fmt::Display) -> Self {
        let start = offset_of(text, part).unwrap_or(0);
        Self::at(file, text, start..start + part.len(), message)
    }

    /// The file, as its user named it.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// What is wrong, without the place.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// The line, from 1, if the error has a place.
    pub fn line(&self) -> Option<usize> {
        self.place.as_ref().map(|place| place.line)
    }

    /// The column in characters, from 1, if the error has a place.
    pub fn column(&self) -> Option<usize> {
        self.place.as_ref().map(|place| place.column)
    }
}

/// Where `part`, borrowed from `text`, begins in it, in bytes; `None` when it is not a piece of `text`.
pub(super) fn offset_of(text: &str, part: &str) -> Option<usize> {
    let offset = (part.as_ptr() as usize).checked_sub(text.as_ptr() as usize)?;
    (offset + part.len() <= text.len()).then_some(offset)
}

/// The line in which `part`, borrowed from `text`, begins, from 1.
pub(super) fn line_of(text: &str, part: &str) -> usize {
    let start = offset_of(text, part).unwrap_or(0);
    1 + text[..start].matches('\n').count()
}

impl TextPosition {
    fn of(text: &str, range: Range<usize>) -> Self {
        let start = text.floor_char_boundary(range.start);
        let end = text.floor_char_boundary(range.end).max(start);
        let line_start = text[..start].rfind('\n').map_or(0, |newline| newline + 1);
        let source = text[line_start..].lines().next().unwrap_or_default();
        let line_end = (line_start + source.len()).max(start);
        Self {
            line: 1 + text[..start].matches('\n').count(),
            column: 1 + text[line_start..start].chars().count(),
            width: text[start..end.min(line_end)].chars().count().max(1),
            source: source.to_owned(),
        }
    }
}

fn colon(place: &Option<TextPosition>) -> String {
    match place {
        Some(TextPosition { line, column, .. }) => format!(":{line}:{column}"),
        None => String::new(),
    }
}

/// The source line and the carets, each on a line of its own.
///
/// A tab counts as one blank, so that the caret stands right on any terminal, and control
/// characters are blanked, so that a file cannot play with it.
fn excerpt(place: &Option<TextPosition>) -> String {
    let Some(place) = place else {
        return String::new();
    };
    let skipped = if place.source.chars().count() > EXCERPT_WIDTH {
        (place.column - 1).saturating_sub(EXCERPT_LEAD)
    } else {
        0
    };
    let mut rest = place.source.chars().skip(skipped);
    let lead = if skipped > 0 { "…" } else { "" };
    let shown: String = rest
        .by_ref()
        .take(EXCERPT_WIDTH)
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect();
    let tail = if rest.next().is_some() { "…" } else { "" };
    let before = place.column - 1 - skipped + lead.chars().count();
    let carets = place
        .width
        .min((skipped + EXCERPT_WIDTH + 1).saturating_sub(place.column))
        .max(1);
    let number = place.line.to_string();
    format!(
        "\n {number} | {lead}{shown}{tail}\n {:width$} | {:before$}{}",
        "",
        "",
        "^".repeat(carets),
        width = number.len(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_shows_its_line_and_underlines_the_place() {
        let text = "Layout(\n\tname: \"é\", kyes: []\n)";
        let start = text.find("kyes").unwrap();
        let error = DocumentError::at("a.ron", text, start..start + 4, "unknown field `kyes`");
        assert_eq!(
            error.to_string(),
            "a.ron:2:13: unknown field `kyes`\n 2 |  name: \"é\", kyes: []\n   |             ^^^^"
        );
    }

    #[test]
    fn a_long_line_is_cut_around_the_place() {
        let text = format!("{}HERE{}", "a".repeat(500), "b".repeat(500));
        let error = DocumentError::at("a.ron", &text, 500..504, "wrong").to_string();
        let lines: Vec<&str> = error.lines().collect();
        assert_eq!(lines[0], "a.ron:1:501: wrong");
        assert!(lines[1].chars().count() < 100, "{error}");
        assert!(lines[1].starts_with(" 1 | …a") && lines[1].ends_with("b…"));
        let column = lines[2].chars().position(|c| c == '^').unwrap();
        let marked: String = lines[1].chars().skip(column).take(4).collect();
        assert_eq!(marked, "HERE");
        assert!(lines[2].ends_with(" ^^^^"));
    }

    #[test]
    fn the_end_of_a_text_and_a_broken_range_are_places_too() {
        let at = |range| {
            let error = DocumentError::at("a.ron", "é\nxy", range, "wrong");
            (error.line().unwrap(), error.column().unwrap())
        };
        assert_eq!(at(5..5), (2, 3));
        assert_eq!(at(900..901), (2, 3));
        assert_eq!(at(1..2), (1, 1));
    }

    #[test]
    fn a_file_cannot_send_escape_codes_to_the_terminal() {
        let error = DocumentError::at("a.ron", "\u{1b}[31mred", 5..8, "wrong").to_string();
        assert!(!error.contains('\u{1b}'), "{error:?}");
    }

    #[test]
    fn a_borrowed_piece_tells_its_line() {
        let text = String::from("one\ntwo three\n");
        let part = text.split_whitespace().nth(2).unwrap();
        assert_eq!((offset_of(&text, part), line_of(&text, part)), (Some(8), 2));
        assert_eq!(offset_of(&text, "elsewhere"), None);
    }
}
