//! Faults of a text, for the lines of an editor.

use ademan_core::document::DocumentError;
use serde::Serialize;

/// A fault at a position of a text.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Fault {
    /// From 1; `None` for a fault of the text as a whole.
    pub line: Option<usize>,
    /// In characters, from 1.
    pub column: Option<usize>,
    /// Number of characters that are wrong.
    pub width: usize,
    /// The message without the position.
    pub message: String,
}

/// Returns the faults of an error, in the order of the text.
pub fn faults(error: &DocumentError) -> Vec<Fault> {
    let fault = |fault: &ademan_core::document::DocumentFault| Fault {
        line: fault.line(),
        column: fault.column(),
        width: fault.width(),
        message: fault.message().to_owned(),
    };
    error.errors().iter().map(fault).collect()
}

/// Returns the fault of something that is not a text.
pub fn fault(message: impl ToString) -> Fault {
    Fault {
        line: None,
        column: None,
        width: 0,
        message: message.to_string(),
    }
}
