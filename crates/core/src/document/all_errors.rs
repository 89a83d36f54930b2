//! All errors of a text: what is around an error is blanked out, and the text is read again.

use ron::error::{Error, SpannedError};

use super::format::Format;
use super::ron_error::{byte_range, explain};
use super::scan::{Element, elements_around, unbalanced};
use super::{Document, DocumentError};

/// The maximum number of errors that are read: more than are listed, as equal ones are listed once.
const MAX_READ: usize = 40;

/// The maximum number of parts around an error that are blanked out in turn: deeper than layouts are nested.
const MAX_TRIED: usize = 8;

/// Returns all errors of a document that has at least this one.
pub(super) fn all_errors(
    document: &Document,
    format: &Format,
    first: SpannedError,
) -> DocumentError {
    let Document { file, text, .. } = document;
    let mut errors = DocumentError::none(file);
    // Without its partner, a bracket makes all that follows an error.
    let max_read = match unbalanced(text) {
        Some(_) => 1,
        None => MAX_READ,
    };
    let mut rest = Some((text.clone(), first));
    let mut incomplete = Vec::new();
    for _ in 0..max_read {
        let Some((read, error)) = rest else {
            break;
        };
        let explained = explain(&read, &error, format);
        errors.add(DocumentError::at(
            file,
            text,
            explained.range,
            explained.message,
        ));
        rest = next_error(&read, &error, &mut incomplete, format);
    }
    errors.in_order()
}

/// Returns the text without the part around an error, and the next error. `None` if there is none, or if the error leaves open where the
/// part ends. Adds the end of the brackets around the part to `incomplete`, which has the ends of all brackets that lack one.
fn next_error(
    text: &str,
    error: &SpannedError,
    incomplete: &mut Vec<usize>,
    format: &Format,
) -> Option<(String, SpannedError)> {
    if !is_about_content(&error.code) {
        return None;
    }
    let start = byte_range(text, error).start;
    for element in elements_around(text, start).into_iter().take(MAX_TRIED) {
        if element.bracket == b'(' && element.field(text).is_none() {
            continue;
        }
        let blanked = blank_out(text, &element);
        let next = (format.reread)(&blanked)?;
        incomplete.push(element.inside.end);
        let next_start = byte_range(&blanked, &next).start;
        let is_there = next_start == start || element.range.contains(&next_start);
        // A fault at the end of parentheses that lack a part now follows from that.
        if !is_there && !incomplete.contains(&next_start) {
            return Some((blanked, next));
        }
    }
    None
}

/// Returns `true` if the author wrote the brackets and commas around the error.
fn is_about_content(error: &Error) -> bool {
    matches!(
        error,
        Error::Message(_)
            | Error::NoSuchStructField { .. }
            | Error::NoSuchEnumVariant { .. }
            | Error::MissingStructField { .. }
            | Error::DuplicateStructField { .. }
            | Error::ExpectedDifferentStructName { .. }
            | Error::ExpectedDifferentLength { .. }
            | Error::ExpectedNamedStructLike(_)
            | Error::ExpectedStructLike
            | Error::ExpectedString
            | Error::ExpectedFloat
            | Error::ExpectedInteger
            | Error::ExpectedBoolean
            | Error::ExpectedArray
            | Error::ExpectedMap
            | Error::ExpectedIdentifier
            | Error::IntegerOutOfBounds
    )
}

fn blank_out(text: &str, element: &Element) -> String {
    let blank = |byte: u8| if byte == b'\n' { '\n' } else { ' ' };
    let blanks: String = text[element.range.clone()].bytes().map(blank).collect();
    let (before, after) = (&text[..element.range.start], &text[element.range.end..]);
    format!("{before}{blanks}{after}")
}
