//! Problems of a layout text, with their positions.

use std::ops::Range;

use ademan_core::document::{DocumentError, DocumentFault, Node};
use ademan_core::editing::{Part, part_at, part_of};
use ademan_core::layout::LayoutDraft;

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

/// Returns the errors of a text that is no layout.
pub(super) fn of_error(error: &DocumentError, text: &str, tree: Option<&Node>) -> Vec<Problem> {
    let faults = error.errors().iter();
    faults.map(|fault| of_fault(fault, text, tree)).collect()
}

/// Returns the faults of a layout, and a warning for each pair of boards in one place. `parts` has the part of each target.
pub(super) fn of_draft(
    draft: &LayoutDraft,
    parts: &[Part],
    text: &str,
    tree: Option<&Node>,
) -> Vec<Problem> {
    let faults = draft.faults().iter();
    let mut problems: Vec<Problem> = faults
        .map(|it| {
            let mut problem = of_fault(&it.fault, text, tree);
            let own = it.targets.first();
            problem.part = own.and_then(|own| part_of(parts, *own)).or(problem.part);
            problem
        })
        .collect();
    for overlap in draft.layout().board_overlaps() {
        let (_, second) = overlap.targets;
        let source = draft.sources().get(second.0 as usize).cloned();
        let range = source.unwrap_or_default();
        let before = text.get(..range.start).unwrap_or_default();
        problems.push(Problem {
            message: overlap.message(),
            severity: Severity::Warning,
            line: Some(before.matches('\n').count() + 1),
            column: None,
            range,
            // The remedy is about the board, not the control.
            part: part_of(parts, second)
                .and_then(Part::board)
                .map(Part::Board),
        });
    }
    problems
}

fn of_fault(fault: &DocumentFault, text: &str, tree: Option<&Node>) -> Problem {
    let range = fault.byte_range(text);
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
}
