//! Reasons why an edit is not made.

/// Reason why an edit is not made. The text stays.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EditError {
    /// The brackets of the text are not balanced.
    #[error(
        "the text cannot be edited here as its brackets or commas are wrong; correct the first problem in the text, or undo"
    )]
    Unreadable,
    /// There is no such part.
    #[error("the text has no such {0} any more; select it again")]
    NoPart(&'static str),
    /// The part does not have what is edited.
    #[error("this {kind} cannot be {verb}{remedy}")]
    Unsupported {
        /// Kind of the part.
        kind: &'static str,
        /// Participle of the edit.
        verb: &'static str,
        /// Another way, after a semicolon; may be empty.
        remedy: &'static str,
    },
    /// A field is not a number or lacks its parentheses.
    #[error("the field `{0}` has no value that can be edited here; correct it in the text")]
    Field(String),
    /// The new value is no RON text, or has a comment around it.
    #[error(
        "`{0}` is not a value: close its brackets and quotes, and leave out comments around it"
    )]
    Value(String),
    /// The new name cannot be used.
    #[error(
        "the name `{0}` cannot be used: it is empty, another part has it, or a chord with the key cannot contain it; choose another one"
    )]
    Name(String),
    /// All axes are set by controls.
    #[error(
        "the copy of a control with the axis `{0}` needs another axis, and none of its kind is free; give the control another output first"
    )]
    NoAxis(String),
    /// Too few parts for the edit.
    #[error("{0}")]
    Selection(&'static str),
    /// The replacements overlap.
    #[error("the parts overlap in the text; edit one of them at a time")]
    Overlap,
}
