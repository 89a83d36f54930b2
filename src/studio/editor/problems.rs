//! Problems of a layout text, with their positions.

use std::ops::Range;

use crate::document::{DocumentError, DocumentFault, Node};
use crate::editing::{Part, part_at};

/// A problem of a layout text.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// Description: the failure, its reason, and the remedy.
    pub message: String,
    /// An error keeps the layout from being used, a warning does not.
    pub severity: Severity,
    /// Line, from 1, if it has a position.
    pub line: Option<usize>,
    /// Column in characters, from 1.
    pub column: Option<usize>,
    /// Bytes of the text, empty for a problem of the whole file.
    pub range: Range<usize>,
    /// The part of the layout at that position, if the text can be read that far.
    pub part: Option<Part>,
}

/// The weight of a problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// The layout cannot be used.
    Error,
    /// The layout can be used.
    Warning,
}

/// Returns the errors of the loader.
pub(super) fn of_error(error: &DocumentError, text: &str, tree: Option<&Node>) -> Vec<Problem> {
    let problem = |fault: &DocumentFault| {
        let range = byte_range(text, fault);
        Problem {
            message: fault.message().to_owned(),
            severity: Severity::Error,
            line: fault.line(),
            column: fault.column(),
            part: fault
                .line()
                .and(tree)
                .map(|tree| part_at(text, tree, range.start)),
            range,
        }
    };
    error.errors().iter().map(problem).collect()
}

fn byte_range(text: &str, fault: &DocumentFault) -> Range<usize> {
    let (Some(line), Some(column)) = (fault.line(), fault.column()) else {
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
    start + skip(column - 1)..start + skip(column - 1 + fault.width())
}
