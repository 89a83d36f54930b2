//! Messages and byte ranges of errors that the RON reader reports.

use std::ops::Range;

use ron::error::{Error, Position, SpannedError};

use super::error::line_number;
use super::format::Format;
use super::scan::{self, TokenKind};
use crate::message::escape;
use crate::names::UnknownName;

/// An error with its bytes in the text.
pub(super) struct Explained {
    pub range: Range<usize>,
    pub message: String,
}

impl Explained {
    fn new(range: Range<usize>, message: impl Into<String>) -> Self {
        let message = message.into();
        Self { range, message }
    }
}

/// Returns the message of an error, lower case and without full stop, and the part of the text that it refers to.
///
/// The text tells what its author meant: a comment with `#`, a decimal comma, a name in quotes.
pub(super) fn explain(text: &str, error: &SpannedError, format: &Format) -> Explained {
    let range = byte_range(text, error);
    if error.code != Error::UnclosedBlockComment && scan::tokens(text).next().is_none() {
        let (name, remedy) = (format.name, format.remedy);
        let message = format!("the file is empty, expected `{name}(…)`{remedy}");
        return Explained::new(0..0, message);
    }
    if let Some(hash) = hash_comment(text, range.start) {
        return Explained::new(hash, "a comment begins with `//`, not with `#`");
    }
    if let Some(comma) = lone_comma(text, range.start) {
        let message = "there is no value before this comma; write it, or remove the comma";
        return Explained::new(comma, message);
    }
    if let Some(quote) = unclosed_quote(text, range.start, &error.code) {
        return Explained::new(quote, "the text has no closing quote");
    }
    if matches!(
        error.code,
        Error::ExpectedComma | Error::Eof | Error::ExpectedArrayEnd
    ) && let Some(explained) = unbalanced(text, &range)
    {
        return explained;
    }
    let slice = Slice {
        text,
        range: range.clone(),
    };
    let message = slice.message(&error.code, format);
    Explained::new(range, message)
}

/// The message for `38/2`.
const CALCULATION: &str = "write the result of the calculation";

/// The message for `300.5` or `1e3` where fractions have no meaning.
const WHOLE_NUMBER: &str = "expected a whole number, in digits only";

/// Returns the end of the error for a file of another kind: a command takes a setup without an option, and other files with one; the arm
/// `unam` is easily taken for the glove `unam-hc11`.
fn other_file(expected: &str, found: &str) -> &'static str {
    match (expected, found) {
        ("Setup", "Layout") => "; `--layout` names a layout",
        ("Setup", "Glove") => "; `--glove` names a glove",
        ("Setup", "Person") => "; `--person` names a person",
        ("Glove", "Arm" | "Layout" | "Person") => "; `ademan gloves` lists the gloves",
        _ => "",
    }
}

/// The part of a text in which the reader found an error.
struct Slice<'t> {
    text: &'t str,
    range: Range<usize>,
}

impl Slice<'_> {
    fn message(&self, error: &Error, format: &Format) -> String {
        match error {
            Error::Message(message) => message.clone(),
            Error::NoSuchStructField {
                expected,
                found,
                outer,
            } => {
                misplaced_field(format, outer.as_deref().unwrap_or_default(), found)
                    .unwrap_or_else(|| unknown_name("field", found, expected))
            }
            Error::NoSuchEnumVariant {
                expected, found, ..
            } => unknown_name("value", found, expected),
            Error::MissingStructField { field, .. } => format!("the field `{field}` is missing"),
            Error::DuplicateStructField { field, .. } => format!("duplicate field `{field}`"),
            Error::ExpectedDifferentStructName { expected, found } => {
                let remedy = other_file(expected, found);
                format!("expected `{expected}(…)`, found `{found}`{remedy}")
            }
            Error::ExpectedDifferentLength { expected, found } => {
                different_length(expected, *found)
            }
            Error::ExpectedStructLikeEnd => {
                "expected `)`: there are more values than this field has; a decimal point is `.`, as in `3.5`".into()
            }
            Error::ExpectedNamedStructLike(_) | Error::ExpectedStructLike => {
                format!("expected fields in parentheses: `(…)`{}", self.not("[{"))
            }
            Error::ExpectedIdentifier
            | Error::SuggestRawIdentifier(_)
            | Error::InvalidIdentifier(_) => self.expected_name(format),
            Error::ExpectedString => self.expected_text(),
            Error::ExpectedFloat | Error::ExpectedInteger => match self.first() {
                Some('"') => "expected a number, without quotes".into(),
                _ => "expected a number".into(),
            },
            Error::InvalidIntegerDigit { .. } => WHOLE_NUMBER.into(),
            Error::InvalidValueForType { expected, .. } if expected == "a borrowed string" => {
                "this text must be written without `\\`".into()
            }
            Error::IntegerOutOfBounds => "the number is negative, or too large".into(),
            Error::ExpectedBoolean => "expected `true` or `false`".into(),
            Error::ExpectedArray => format!("expected a list: `[…]`{}", self.not("({")),
            Error::ExpectedMap => format!("expected a map: `{{…}}`{}", self.not("([")),
            Error::ExpectedMapColon => match self.first() {
                Some('=') => "write `:` in place of `=`".into(),
                _ => "expected `:` after the name of a field".into(),
            },
            Error::ExpectedComma => self.expected_comma(),
            Error::UnexpectedChar(_) if self.first() == Some('/') => CALCULATION.into(),
            Error::ExpectedStringEnd => "the text has no closing quote".into(),
            Error::UnclosedBlockComment => "the comment has no `*/`".into(),
            Error::Eof => "unexpected end of file".into(),
            Error::TrailingCharacters => "unexpected text after the end".into(),
            Error::ExceededRecursionLimit => {
                "brackets are nested more than 128 levels deep".into()
            }
            other => lower_case_first(&other.to_string()),
        }
    }

    fn first(&self) -> Option<char> {
        self.text[self.range.start..].chars().next()
    }

    fn before(&self) -> &str {
        self.text[..self.range.start].trim_end()
    }

    /// Returns ", not `[…]`" if the bracket that is there is one of these.
    fn not(&self, brackets: &str) -> &'static str {
        match self.first().filter(|first| brackets.contains(*first)) {
            Some('(') => ", not `(…)`",
            Some('[') => ", not `[…]`",
            Some('{') => ", not `{…}`",
            _ => "",
        }
    }

    fn expected_comma(&self) -> String {
        match self.first() {
            Some(';') => "write `,` in place of `;`".into(),
            Some('/' | '*' | '+' | '-') => CALCULATION.into(),
            Some('.') if self.ends_with_number() => WHOLE_NUMBER.into(),
            Some(first) if is_of_unit(first) && self.ends_with_number() => {
                "a number is written without its unit, which is in the name of the field".into()
            }
            _ => "expected a comma or the closing bracket".into(),
        }
    }

    /// Returns `true` if a digit is directly before the error.
    fn ends_with_number(&self) -> bool {
        let before = &self.text[..self.range.start];
        before.ends_with(|last: char| last.is_ascii_digit())
    }

    fn expected_text(&self) -> String {
        // The reader takes the first letter of a name that begins with `r` for a raw text.
        let start = match self.before().strip_suffix('r') {
            Some(before) if self.text[..self.range.start].ends_with('r') => before.len(),
            _ => self.range.start,
        };
        let value = scan::value_at(self.text, start).map_or("", |range| &self.text[range]);
        match self.first() {
            Some('\'' | '“' | '”' | '„' | '‘' | '’' | '«' | '»') => {
                "a text has straight double quotes: `\"…\"`".into()
            }
            Some('[') => "expected one text in quotes, not a list: `\"…\"`".into(),
            Some(first) if first.is_alphabetic() && value.len() < 32 => {
                format!("expected a text in quotes: `\"{value}\"`")
            }
            _ => "expected a text in quotes: `\"…\"`".into(),
        }
    }

    /// Returns the message where the name of a value or of a field is missing.
    fn expected_name(&self, format: &Format) -> String {
        if let Some(number) = self.decimal_comma() {
            return format!("a decimal point is `.`, not `,`: `{number}`");
        }
        let Some(range) = scan::value_at(self.text, self.range.start) else {
            return "expected a name".into();
        };
        let value = &self.text[range.clone()];
        // The reader knows the names that are valid here, and says so for a name that is not.
        let probe = |name: &str| {
            let (before, after) = (&self.text[..range.start], &self.text[range.end..]);
            (format.reread)(&format!("{before}{name}{after}")).map(|error| error.code)
        };
        if let Some(Error::NoSuchEnumVariant { expected, .. }) = probe("Zz") {
            return expected_value(value, expected);
        }
        match probe("Zz: 0") {
            Some(Error::NoSuchStructField { expected, .. }) => match expected {
                [only] if value.len() < 32 => {
                    format!(
                        "expected a field with its name: `{only}: {}`",
                        escape(value)
                    )
                }
                _ => format!(
                    "expected the name of a field, one of: {}",
                    expected.join(", ")
                ),
            },
            _ => "expected a name".into(),
        }
    }

    /// Returns the number that was meant, if the error is after a decimal comma.
    fn decimal_comma(&self) -> Option<String> {
        let digits = |text: &str| text.chars().take_while(char::is_ascii_digit).count();
        let after = &self.text[self.range.start..];
        let after = &after[..digits(after)];
        let before = self.before().strip_suffix(',')?;
        let start = before.rfind(|c: char| !c.is_ascii_digit() && c != '-');
        let before = &before[start.map_or(0, |start| start + 1)..];
        let is_number = before.ends_with(|last: char| last.is_ascii_digit()) && !after.is_empty();
        is_number.then(|| format!("{before}.{after}"))
    }
}

/// Returns the message for a value that is not one of these names.
fn expected_value(value: &str, expected: &[&str]) -> String {
    let names = expected.join(", ");
    let inner = value.trim_matches('"');
    match value.chars().next() {
        Some('"') if expected.contains(&inner) => format!("write `{inner}` without quotes"),
        Some('"') => format!("expected one of these names, without quotes: {names}"),
        Some('(') if value.len() < 32 => format!(
            "expected a name before the parentheses, one of: {names}; such as `{}{value}`",
            expected[0]
        ),
        _ => format!("expected one of: {names}"),
    }
}

/// Returns the message for a field that another structure of the file has.
fn misplaced_field(format: &Format, structure: &str, field: &str) -> Option<String> {
    let structures = (format.structures)();
    let here = structures.iter().find(|here| here.name == structure)?;
    let others = structures
        .iter()
        .filter(|other| other.fields.contains(&field));
    let places: Vec<String> = others.map(|other| format!("`{}`", other.place)).collect();
    let place = here.place;
    (!places.is_empty()).then(|| {
        format!(
            "unknown field `{field}` in `{place}`: it is a field of {}",
            places.join(", ")
        )
    })
}

fn different_length(expected: &str, found: usize) -> String {
    let is_digit = |c: char| c.is_ascii_digit();
    let number = expected
        .split(|c| !is_digit(c))
        .find(|part| !part.is_empty());
    let number = match number {
        Some("1") => "1 value".into(),
        Some(number) => format!("{number} values"),
        None => expected.to_owned(),
    };
    format!("expected {number} in parentheses, found {found}")
}

/// Returns the bytes of the `#` of a comment as in shells, if the error is at or after it.
fn hash_comment(text: &str, offset: usize) -> Option<Range<usize>> {
    let before = text[..offset].trim_end();
    let hash = if text[offset..].starts_with('#') {
        offset
    } else if before.ends_with('#') {
        before.len() - 1
    } else {
        return None;
    };
    // `#![enable(…)]` and `r#"…"#` are RON.
    let is_ron = text[hash..].starts_with("#!") || text[..hash].ends_with(['r', '"', '#']);
    (!is_ron).then(|| hash..hash + 1)
}

/// Returns the bytes of a comma at the error that has no value before it.
fn lone_comma(text: &str, offset: usize) -> Option<Range<usize>> {
    let before = text[..offset].trim_end();
    let is_lone = text[offset..].starts_with(',') && before.ends_with([',', '(', '[', '{']);
    is_lone.then(|| offset..offset + 1)
}

/// Returns the first line of a text in quotes whose closing quote is missing, if that is the cause of the error: the next quote,
/// in a later line, seemed to close it, and what is in that line's quotes follows directly.
fn unclosed_quote(text: &str, offset: usize, error: &Error) -> Option<Range<usize>> {
    let mut quoted = scan::tokens(text).filter(|token| token.kind == TokenKind::Quoted);
    let found = match error {
        Error::ExpectedStringEnd => quoted.last()?,
        Error::ExpectedComma
        | Error::ExpectedMapColon
        | Error::ExpectedArrayEnd
        | Error::ExpectedMapEnd
        | Error::ExpectedStructLikeEnd => quoted.find(|token| token.range.end == offset)?,
        _ => return None,
    };
    let slice = &text[found.range.clone()];
    let (line, _) = slice.split_once('\n')?;
    let start = found.range.start;
    slice
        .starts_with('"')
        .then(|| start..start + line.trim_end().len())
}

/// Returns the message for brackets that do not match, if they are the cause.
fn unbalanced(text: &str, range: &Range<usize>) -> Option<Explained> {
    let (open, close) = scan::unbalanced(text)?;
    let bracket = &text[open.range.clone()];
    let line = line_number(text, bracket);
    match close {
        None if range.end + 1 >= text.trim_end().len() => Some(Explained::new(
            open.range,
            format!("the `{bracket}` is not closed"),
        )),
        Some(close) if close.range.start == range.start => {
            let found = &text[close.range.clone()];
            let TokenKind::Open(kind) = open.kind else {
                return None;
            };
            let expected = match kind {
                b'(' => ')',
                b'[' => ']',
                _ => '}',
            };
            let message = format!(
                "expected `{expected}` before `{found}`: the `{bracket}` of line {line} is open"
            );
            Some(Explained::new(close.range, message))
        }
        _ => None,
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

/// Returns `true` if a unit may begin with the character, such as `mm` or `°`.
fn is_of_unit(first: char) -> bool {
    first.is_alphabetic() || first == '°'
}

fn unknown_name(kind: &'static str, found: &str, expected: &'static [&'static str]) -> String {
    let error = UnknownName::new(kind, found, expected.iter().copied());
    let names = expected.iter().map(|&name| name.to_owned());
    UnknownName {
        expected: names.collect(),
        ..error
    }
    .to_string()
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
