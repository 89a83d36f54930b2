//! What the RON reader found wrong, in words for the person who wrote the file.

use std::ops::Range;

use ron::error::{Error, Position, SpannedError};

use crate::names::UnknownName;

/// What is wrong: lower case, no full stop, with the nearest valid name.
pub(super) fn message(error: &Error) -> String {
    match error {
        Error::Message(message) => message.clone(),
        Error::NoSuchStructField {
            expected, found, ..
        } => unknown("field", found, expected),
        Error::NoSuchEnumVariant {
            expected, found, ..
        } => unknown("value", found, expected),
        Error::MissingStructField { field, .. } => format!("the field `{field}` is missing here"),
        Error::DuplicateStructField { field, .. } => {
            format!("the field `{field}` is here for the second time")
        }
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
        Error::ExpectedStringEnd => "this text has no closing quote".into(),
        Error::UnclosedBlockComment => "this comment has no `*/`".into(),
        Error::Eof => "the file ends too early".into(),
        Error::TrailingCharacters => "there is something after the end".into(),
        Error::ExceededRecursionLimit => "brackets are nested more than 128 deep".into(),
        other => lower(&other.to_string()),
    }
}

/// The bytes of `text` that the error is about, without blanks in front.
pub(super) fn range(text: &str, error: &SpannedError) -> Range<usize> {
    let (start, end) = (offset(text, error.span.start), offset(text, error.span.end));
    if error.code == Error::UnclosedBlockComment {
        return start.saturating_sub("/*".len())..start;
    }
    let blanks = text[start..].len() - text[start..].trim_start().len();
    if start + blanks == text.len() {
        return start..end;
    }
    start + blanks..end.max(start + blanks)
}

fn unknown(what: &'static str, found: &str, expected: &'static [&'static str]) -> String {
    let unknown = UnknownName::new(what, found, expected.iter().copied());
    match unknown.nearest {
        Some(_) => unknown.to_string(),
        None => format!("{unknown}, valid here: {}", expected.join(", ")),
    }
}

fn offset(text: &str, position: Position) -> usize {
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

fn lower(text: &str) -> String {
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
    fn a_position_in_characters_becomes_one_in_bytes() {
        let text = "é(\nöx\n";
        let at = |line, col| offset(text, Position { line, col });
        assert_eq!([at(1, 1), at(1, 2), at(2, 2), at(3, 1)], [0, 2, 6, 8]);
        assert_eq!(at(9, 9), text.len());
    }
}
