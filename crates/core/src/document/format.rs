//! Formats of files: what an error message needs to know beside the text.

use ron::error::SpannedError;
use serde::Deserialize;

use super::field_names::Structure;
use super::reader;

/// A format of file.
pub struct Format {
    /// The name at the start of the text, which is usually written: `Layout`.
    pub name: &'static str,
    /// The remedy for an empty file, or an empty text.
    pub remedy: &'static str,
    /// Reads a text and returns its first error.
    pub reread: fn(&str) -> Option<SpannedError>,
    /// Returns the structures of the format, so that an error can name the one that has a field.
    pub structures: fn() -> Vec<Structure>,
}

impl Format {
    /// A format of which nothing is known.
    pub const PLAIN: Self = Self {
        name: "",
        remedy: "",
        reread: |_| None,
        structures: Vec::new,
    };
}

/// Reads a text as `T` and returns the first error.
pub fn first_error<'a, T: Deserialize<'a>>(text: &'a str) -> Option<SpannedError> {
    reader::read::<T>(text).err()
}
