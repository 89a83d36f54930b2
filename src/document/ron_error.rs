//! Messages and byte ranges of errors that the RON reader reports.

use std::ops::Range;

use ron::error::{Error, Position, SpannedError};

use crate::names::UnknownName;

/// Returns the message of an error: lower case, no full stop, with the nearest valid name.
pub(super) fn message(error: &Error) -> String {
    match error {
        Error::Message(message) => message.clone(),
        Error::NoSuchStructField {
            expected, found, ..
        } => unknown_name("field", found, expected),
        Error::NoSuchEnumVariant {
            expected, found, ..
        } => unknown_name("value", found, expected),
        Error::MissingStructField { field, .. } => format!("the field `{field}` is missing"),
        Error::DuplicateStructField { field, .. } => format!("duplicate field `{field}`"),
        Error::ExpectedDifferentStructName { expected, found } => {
            format!("expected `{expected}(…)`, found `{found}`")
        }
        Error::ExpectedNamedStructLike(_) | Error::ExpectedStructLike => {
            "expected fields in parentheses: `(…)`".into()
        }
        Error::ExpectedString => "expected a text in quotes: `\"…\"`".into(),
        Error::ExpectedFloat | Error::ExpectedInteger => "expected a number".into(),
        Error::ExpectedBoolean => "expected `true` or `false`".into(),
        Error::ExpectedArray => "expected a list: `[…]`".into(),
        Error::ExpectedMap => "expected a map: `{…}`".into(),
        Error::ExpectedComma => "expected a comma or the closing bracket".into(),
        Error::ExpectedStringEnd => "the text has no closing quote".into(),
        Error::UnclosedBlockComment => "the comment has no `*/`".into(),
        Error::Eof => "unexpected end of file".into(),
        Error::TrailingCharacters => "unexpected text after the end".into(),
        Error::ExceededRecursionLimit => "brackets are nested more than 128 levels deep".into(),
        other => lower_case_first(&other.to_string()),
    }
}

/// Returns the bytes of `text` that the error refers to, without leading blanks.
pub(super) fn byte_range(text: &str, error: &SpannedError) -> Range<usize> {
    let start = byte_offset(text, error.span.start);
    let end = byte_offset(text, error.span.end);
    if error.code == Error::UnclosedBlockComment {
        return start.saturating_sub("/*".len())..start;
    }
    let blanks = text[start..].len() - text[start..].trim_start().len();
    if start + blanks == text.len() {
        return start..end;
    }
    start + blanks..end.max(start + blanks)
}

fn unknown_name(kind: &'static str, found: &str, expected: &'static [&'static str]) -> String {
    let error = UnknownName::new(kind, found, expected.iter().copied());
    match error.nearest {
        Some(_) => error.to_string(),
        None => format!("{error}, expected one of: {}", expected.join(", ")),
    }
}

/// Converts a line and a column in characters, both from 1, to a byte offset.
fn byte_offset(text: &str, position: Position) -> usize {
    let line_start = match position.line {
        0 | 1 => 0,
        line => text
            .match_indices('\n')
            .nth(line - 2)
            .map_or(text.len(), |(newline, _)| newline + 1),
    };
    let line = &text[line_start..];
    line.char_indices()
        .nth(position.col.saturating_sub(1))
        .map_or(text.len(), |(column, _)| line_start + column)
}

fn lower_case_first(text: &str) -> String {
    let mut characters = text.chars();
    match characters.next() {
        Some(first) => first.to_lowercase().chain(characters).collect(),
        None => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_in_characters_become_offsets_in_bytes() {
        let text = "é(\nöx\n";
        let offset = |line, col| byte_offset(text, Position { line, col });
        assert_eq!(
            [offset(1, 1), offset(1, 2), offset(2, 2), offset(3, 1)],
            [0, 2, 6, 8]
        );
        assert_eq!(offset(9, 9), text.len());
    }
}
