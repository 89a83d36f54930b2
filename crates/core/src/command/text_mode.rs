//! The modes of the text decoder.

use crate::names::named_enum;

named_enum! {
    /// The extent of what the text decoder changes.
    pub enum TextMode ("text mode") {
        /// Nothing: every press passes as it is, and the decoder does not see it.
        Literal = "literal",
        /// The candidate that is chosen, nothing else.
        Suggest = "suggest",
        /// The candidate that is chosen, and words at their end.
        Auto = "auto",
    }
}
