//! Systems whose graphics cards are not known.

/// Returns `true`: desktops of these systems need a card themselves.
pub fn has_card() -> bool {
    true
}
