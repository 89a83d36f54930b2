//! Texts that taps may mean.

/// Returns `true` if two texts differ in capitals only.
pub fn same_letters(left: &str, right: &str) -> bool {
    fn lower(text: &str) -> impl Iterator<Item = char> {
        text.chars().flat_map(char::to_lowercase)
    }
    lower(left).eq(lower(right))
}

/// A text that the taps may mean.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Candidate {
    /// The text.
    pub text: String,
    /// The log-probability.
    pub score: f32,
}
