//! The kinds of setup texts in a recording.

/// The settings.
pub const SETUP: &str = "setup";
/// The glove.
pub const GLOVE: &str = "glove";
/// The arm model.
pub const ARM: &str = "arm";
/// The person.
pub const PERSON: &str = "person";
/// The glove of the other hand.
pub const OTHER_GLOVE: &str = "other-glove";
/// The arm model of the other hand.
pub const OTHER_ARM: &str = "other-arm";
/// The layout that is active at the start.
pub const LAYOUT: &str = "layout";

/// The knowledge of the text decoder about the person.
pub const LEARNED: &str = "learned";

/// Returns the kind of a further layout.
pub fn profile(name: &str) -> String {
    format!("layout:{name}")
}
