//! Errors in a file, with the position and an excerpt.

use std::fmt;
use std::ops::Range;

use crate::message::{escape, escape_line, is_escaped};

/// The maximum width of an excerpt, in characters. With the number of the line it fits into 80 columns: a terminal that breaks the line
/// separates it from its carets.
const EXCERPT_WIDTH: usize = 70;

/// The number of characters of a long line that are shown before the position.
const EXCERPT_LEAD: usize = 50;

/// The maximum number of errors that are listed. Further ones usually have the same cause.
const MAX_LISTED: usize = 20;

/// The maximum number of lines that are listed for one message.
const MAX_LINES: usize = 10;

/// The errors in a file: at least one, at most 20.
///
/// Each is displayed as `FILE:LINE:COLUMN: message`, followed by the source line and carets under the position, unless these are
/// [left out](Self::without_excerpts). An error without a position, such as a file that cannot be read, is displayed as
/// `FILE: message`. Errors with the same message are displayed once, with the lines of all.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub struct DocumentError {
    file: String,
    listed: Vec<DocumentFault>,
    /// Number of errors that are not listed.
    unlisted: usize,
}

/// One error in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DocumentFault {
    message: String,
    position: Option<TextPosition>,
    /// Further lines with the same error.
    lines: Vec<usize>,
    /// Number of further lines that are not listed.
    unlisted_lines: usize,
}

/// A range of characters within one line of a text.
#[derive(Clone, Debug, PartialEq, Eq)]
struct TextPosition {
    /// Number of the line, from 1.
    line: usize,
    /// Number of the first character in the line, from 1.
    column: usize,
    /// Number of underlined characters, at least 1.
    width: usize,
    /// The text of the line; `None` if it is not shown.
    source: Option<String>,
}

impl DocumentError {
    /// Creates an error about the file as a whole.
    pub fn for_file(file: &str, message: impl fmt::Display) -> Self {
        Self::single(file, message.to_string(), None)
    }

    /// Creates an error at the bytes `range` of `text`. An end of the range that lies outside the text or inside a character
    /// is moved to the nearest character boundary before it.
    pub fn at(file: &str, text: &str, range: Range<usize>, message: impl fmt::Display) -> Self {
        let position = TextPosition::new(text, range);
        Self::single(file, message.to_string(), Some(position))
    }

    /// Creates an error at `slice`, a slice of `text`. The position is the start of `text` if `slice` is not part of it.
    pub fn at_slice(file: &str, text: &str, slice: &str, message: impl fmt::Display) -> Self {
        let start = byte_offset(text, slice).unwrap_or(0);
        Self::at(file, text, start..start + slice.len(), message)
    }

    /// Creates an error without a message, which [`add`](Self::add) ignores: the consequence of an error that is reported.
    pub(crate) fn none(file: &str) -> Self {
        Self {
            file: file.to_owned(),
            listed: Vec::new(),
            unlisted: 0,
        }
    }

    fn single(file: &str, message: String, position: Option<TextPosition>) -> Self {
        let error = DocumentFault {
            // It may quote names of the file.
            message: escape_line(&message).into_owned(),
            position,
            lines: Vec::new(),
            unlisted_lines: 0,
        };
        Self {
            listed: vec![error],
            ..Self::none(file)
        }
    }

    /// Returns the errors of the parts of a file as one, in the order of the file; `None` if there are none.
    pub fn all(errors: impl IntoIterator<Item = Self>) -> Option<Self> {
        let joined = errors.into_iter().reduce(|mut all, error| {
            all.add(error);
            all
        });
        joined.map(Self::in_order)
    }

    /// Adds the errors of another part of the file.
    pub(crate) fn add(&mut self, other: Self) {
        for error in other.listed {
            let has_room = self.listed.len() < MAX_LISTED;
            let mut listed = self.listed.iter_mut();
            match listed.find(|known| known.message == error.message) {
                Some(known) => known.add_line(error.line()),
                None if has_room => self.listed.push(error),
                None => self.unlisted += 1,
            }
        }
        self.unlisted += other.unlisted;
    }

    /// Sorts the errors by position.
    pub(crate) fn in_order(mut self) -> Self {
        self.listed
            .sort_by_key(|error| (error.line(), error.column()));
        self
    }

    /// Returns `true` if there is no error that is reported.
    pub(crate) fn is_none(&self) -> bool {
        self.listed.is_empty()
    }

    /// Returns the file, as its user named it.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Returns the errors, in the order of the file.
    pub fn errors(&self) -> &[DocumentFault] {
        &self.listed
    }

    /// Returns the message of the first error, without its position.
    pub fn message(&self) -> &str {
        self.listed.first().map_or("", DocumentFault::message)
    }

    /// Returns the line of the first error, from 1, if it has a position.
    pub fn line(&self) -> Option<usize> {
        self.listed.first()?.line()
    }

    /// Returns the column of the first error in characters, from 1, if it has a position.
    pub fn column(&self) -> Option<usize> {
        self.listed.first()?.column()
    }

    /// Leaves out the lines of the file and the texts that messages quote, for a file of what a person has typed.
    #[must_use]
    pub fn without_excerpts(mut self) -> Self {
        for error in &mut self.listed {
            error.message = without_quoted_text(&error.message);
            if let Some(position) = &mut error.position {
                position.source = None;
            }
        }
        self
    }
}

impl DocumentFault {
    /// Returns the message without the position.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// Returns the line, from 1, if the error has a position.
    pub fn line(&self) -> Option<usize> {
        self.position.as_ref().map(|position| position.line)
    }

    /// Returns the column in characters, from 1, if the error has a position.
    pub fn column(&self) -> Option<usize> {
        self.position.as_ref().map(|position| position.column)
    }

    /// Returns the number of underlined characters, from 1 if the error has a position, otherwise 0.
    pub fn width(&self) -> usize {
        self.position.as_ref().map_or(0, |position| position.width)
    }

    /// Returns the bytes of the text that is underlined; empty without a position.
    pub fn byte_range(&self, text: &str) -> Range<usize> {
        let Some(TextPosition {
            line,
            column,
            width,
            ..
        }) = self.position
        else {
            return 0..0;
        };
        let lines = text.split_inclusive('\n').take(line - 1);
        let start: usize = lines.map(str::len).sum();
        let rest = text.get(start..).unwrap_or_default();
        let skip = |count: usize| {
            rest.char_indices()
                .nth(count)
                .map_or(rest.len(), |(at, _)| at)
        };
        start + skip(column - 1)..start + skip(column - 1 + width)
    }

    fn add_line(&mut self, line: Option<usize>) {
        let is_listed = line == self.line() || line.is_some_and(|line| self.lines.contains(&line));
        match line.filter(|_| !is_listed) {
            Some(line) if self.lines.len() < MAX_LINES => self.lines.push(line),
            Some(_) => self.unlisted_lines += 1,
            None => {}
        }
    }

    /// Formats the further lines.
    fn also(&self) -> String {
        let lines: Vec<String> = self.lines.iter().map(usize::to_string).collect();
        let more = match self.unlisted_lines {
            0 => String::new(),
            count => format!(" and {count} more"),
        };
        match lines.len() {
            0 => String::new(),
            1 => format!(" (also in line {})", lines[0]),
            _ => format!(" (also in lines {}{more})", lines.join(", ")),
        }
    }
}

impl fmt::Display for DocumentError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let file = escape(&self.file);
        for (index, error) in self.listed.iter().enumerate() {
            let line_end = if index > 0 { "\n" } else { "" };
            let position = line_and_column(&error.position);
            let (message, also) = (&error.message, error.also());
            let excerpt = excerpt(&error.position);
            write!(f, "{line_end}{file}{position}: {message}{also}{excerpt}")?;
        }
        match self.unlisted {
            0 => Ok(()),
            1 => write!(f, "\n{file}: 1 more error"),
            count => write!(f, "\n{file}: {count} more errors"),
        }
    }
}

/// Returns the byte offset of `slice` in `text`, or `None` if it is not a slice of `text`.
pub fn byte_offset(text: &str, slice: &str) -> Option<usize> {
    let offset = (slice.as_ptr() as usize).checked_sub(text.as_ptr() as usize)?;
    (offset + slice.len() <= text.len()).then_some(offset)
}

/// Returns the line, from 1, on which `slice` starts in `text`; 1 if it is not a slice of `text`.
pub(crate) fn line_number(text: &str, slice: &str) -> usize {
    let start = byte_offset(text, slice).unwrap_or(0);
    1 + text[..start].matches('\n').count()
}

impl TextPosition {
    fn new(text: &str, range: Range<usize>) -> Self {
        let start = text.floor_char_boundary(range.start);
        let end = text.floor_char_boundary(range.end).max(start);
        let line_start = text[..start].rfind('\n').map_or(0, |newline| newline + 1);
        let source = text[line_start..].lines().next().unwrap_or_default();
        let line_end = (line_start + source.len()).max(start);
        Self {
            line: 1 + text[..start].matches('\n').count(),
            column: 1 + text[line_start..start].chars().count(),
            width: text[start..end.min(line_end)].chars().count().max(1),
            source: Some(source.to_owned()),
        }
    }
}

/// Returns a message with `"…"` in place of the text that it quotes.
fn without_quoted_text(message: &str) -> String {
    let quoted = message.split_once("`\"").and_then(|(before, rest)| {
        let (_, after) = rest.rsplit_once("\"`")?;
        Some((before, after))
    });
    quoted.map_or_else(
        || message.to_owned(),
        |(before, after)| format!("{before}`\"…\"`{after}"),
    )
}

fn line_and_column(position: &Option<TextPosition>) -> String {
    match position {
        Some(TextPosition { line, column, .. }) => format!(":{line}:{column}"),
        None => String::new(),
    }
}

/// Formats the source line and the carets, each on its own line.
///
/// Control characters become blanks: a tab would move the carets, and an escape code could control the terminal.
fn excerpt(position: &Option<TextPosition>) -> String {
    let Some(position) = position else {
        return String::new();
    };
    let Some(source) = &position.source else {
        return String::new();
    };
    let skipped = if source.chars().count() > EXCERPT_WIDTH {
        (position.column - 1).saturating_sub(EXCERPT_LEAD)
    } else {
        0
    };
    let mut rest = source.chars().skip(skipped);
    let head = if skipped > 0 { "…" } else { "" };
    let visible: String = rest
        .by_ref()
        .take(EXCERPT_WIDTH)
        .map(|c| if is_escaped(c) { ' ' } else { c })
        .collect();
    let tail = if rest.next().is_some() { "…" } else { "" };
    let indent = position.column - 1 - skipped + head.chars().count();
    let carets = position
        .width
        .min((skipped + EXCERPT_WIDTH + 1).saturating_sub(position.column))
        .max(1);
    let number = position.line.to_string();
    format!(
        "\n {number} | {head}{visible}{tail}\n {:width$} | {:indent$}{}",
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
    fn an_error_shows_its_line_and_underlines_the_position() {
        let text = "Layout(\n\tname: \"é\", kyes: []\n)";
        let start = text.find("kyes").unwrap();
        let error = DocumentError::at("a.ron", text, start..start + 4, "unknown field `kyes`");
        assert_eq!(
            error.to_string(),
            "a.ron:2:13: unknown field `kyes`\n 2 |  name: \"é\", kyes: []\n   |             ^^^^"
        );
    }

    #[test]
    fn lines_that_a_person_has_typed_are_left_out() {
        let text = "words: [\n\"Nuria\" \"Ana\"]";
        let error = DocumentError::at("me.ron", text, 17..22, "expected a comma");
        let shown = error.without_excerpts().to_string();
        assert_eq!(shown, "me.ron:2:9: expected a comma");
        let quoting = DocumentError::at("me.ron", text, 17..22, "expected `\"Ana\"` in `words`");
        let unquoted = quoting.without_excerpts().to_string();
        assert_eq!(unquoted, "me.ron:2:9: expected `\"…\"` in `words`");
    }

    #[test]
    fn a_long_line_is_cut_around_the_position() {
        let text = format!("{}HERE{}", "a".repeat(500), "b".repeat(500));
        let error = DocumentError::at("a.ron", &text, 500..504, "wrong").to_string();
        let lines: Vec<&str> = error.lines().collect();
        assert_eq!(lines[0], "a.ron:1:501: wrong");
        assert!(lines[1].chars().count() <= 80, "{error}");
        assert!(lines[1].starts_with(" 1 | …a") && lines[1].ends_with("b…"));
        let column = lines[2].chars().position(|c| c == '^').unwrap();
        let marked: String = lines[1].chars().skip(column).take(4).collect();
        assert_eq!(marked, "HERE");
        assert!(lines[2].ends_with(" ^^^^"));
    }

    #[test]
    fn a_range_at_the_end_or_inside_a_character_has_a_position() {
        let position = |range| {
            let error = DocumentError::at("a.ron", "é\nxy", range, "wrong");
            (error.line().unwrap(), error.column().unwrap())
        };
        assert_eq!(position(5..5), (2, 3));
        assert_eq!(position(900..901), (2, 3));
        assert_eq!(position(1..2), (1, 1));
    }

    #[test]
    fn equal_messages_are_listed_once_and_at_most_20_different_ones() {
        let text = "a\nb\n".repeat(20);
        let mut errors = DocumentError::none("a.ron");
        for line in (0..40).rev() {
            let message = format!("wrong {}", if line % 2 == 0 { 0 } else { line });
            errors.add(DocumentError::at(
                "a.ron",
                &text,
                2 * line..2 * line,
                message,
            ));
        }
        errors.add(DocumentError::for_file("a.ron", "unreadable"));
        let listed = errors.in_order().to_string();
        let lines: Vec<&str> = listed.lines().collect();
        assert_eq!(lines.len(), 20 * 3 + 1, "{listed}");
        assert_eq!(lines[0], "a.ron:4:1: wrong 3");
        let also = "(also in lines 37, 35, 33, 31, 29, 27, 25, 23, 21, 19 and 9 more)";
        assert!(
            listed.contains(&format!("a.ron:39:1: wrong 0 {also}")),
            "{listed}"
        );
        assert_eq!(lines[60], "a.ron: 2 more errors");
    }

    #[test]
    fn names_messages_and_excerpts_contain_no_escape_codes() {
        let text = "\u{1b}[31mred\u{202e}";
        let error = DocumentError::at("a\n.ron", text, 5..8, "no `\u{9b}2J\nerror`");
        let expected = "a\\n.ron:1:6: no `\\u{9b}2J\\nerror`\n 1 |  [31mred \n   |      ^^^";
        assert_eq!(error.to_string(), expected);
    }

    #[test]
    fn a_slice_has_an_offset_and_a_line() {
        let text = String::from("one\ntwo three\n");
        let slice = text.split_whitespace().nth(2).unwrap();
        assert_eq!(
            (byte_offset(&text, slice), line_number(&text, slice)),
            (Some(8), 2)
        );
        assert_eq!(byte_offset(&text, "elsewhere"), None);
    }
}
