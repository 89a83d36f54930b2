//! The kinds of documents in a recording.

pub const SETUP: &str = "setup";
pub const GLOVE: &str = "glove";
pub const ARM: &str = "arm";
pub const PERSON: &str = "person";
pub const OTHER_GLOVE: &str = "other-glove";
pub const OTHER_ARM: &str = "other-arm";
pub const LAYOUT: &str = "layout";

/// Returns the kind of a further layout.
pub fn profile(name: &str) -> String {
    format!("layout:{name}")
}
