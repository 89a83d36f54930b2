//! The modes of the text decoder.

use crate::names::named_enum;

named_enum! {
    /// How much the text decoder changes.
    pub enum TextMode ("text mode") {
        /// Nothing: every press passes as it is, and the decoder does not see it.
        Literal = "literal",
        /// What is chosen of the candidates.
        Suggest = "suggest",
        /// What is chosen of the candidates, and words at their end.
        Auto = "auto",
    }
}
