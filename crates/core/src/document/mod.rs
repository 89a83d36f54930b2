//! RON files as text with positions.
//!
//! Layouts, gloves, arms, persons, setups and simulation scripts are all read through a [`Document`]. A document keeps its text, so that an
//! error can name the line and column, show the line, and underline the part that is wrong.

mod all_errors;
mod error;
mod field_names;
mod fields;
mod format;
mod pairs;
mod ranged;
mod reader;
mod ron_error;
mod scan;
mod shipped;
mod spanned;
mod tree;

pub use crate::schema;
pub use error::byte_offset;
pub(crate) use error::line_number;
pub use error::{DocumentError, DocumentFault};
pub use field_names::Structure;
#[doc(hidden)]
pub use fields::{Attributes, Values, add_table};
pub use fields::{FieldType, Row, Shape, Table, json_form, json_schema, tables_of};
pub use format::{Format, first_error};
pub use pairs::Pairs;
pub(crate) use ranged::{format_number, ranged_numbers};
pub(crate) use scan::reindented;
pub use shipped::{FileKind, shipped_gloves, shipped_layouts, shipped_mesh, shipped_persons};
pub use spanned::Spanned;
pub use tree::{Item, Node, quote, quoted_content, read_tree};

use std::path::PathBuf;

use ron::extensions::Extensions;
use serde::Deserialize;

/// The largest document that is read from a file, in bytes: 1 MiB.
pub const MAX_DOCUMENT_BYTES: u64 = 1 << 20;

/// The byte order mark, which some editors write at the start of a text in UTF-8.
pub const BYTE_ORDER_MARK: &str = "\u{feff}";

/// The text of a file and the name under which errors report it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Document {
    /// The name that the user gave, or for a shipped file its path, such as `layouts/keyboards/arrows.ron`.
    pub file: String,
    /// The text, without a byte order mark.
    pub text: String,
    /// The file from which the text was read. `None` for a shipped file or a text.
    pub path: Option<PathBuf>,
}

impl Document {
    /// Returns the shipped file with that name; the folder and `.ron` are optional.
    pub fn shipped(name: &str) -> Result<Self, DocumentError> {
        shipped::find(name).ok_or_else(|| DocumentError::no_such_file(name, None, &[]))
    }

    /// Makes a document of a text. `file` names it in errors.
    pub fn new(file: impl Into<String>, text: impl Into<String>) -> Self {
        let mut text = text.into();
        if text.starts_with(BYTE_ORDER_MARK) {
            text.drain(..BYTE_ORDER_MARK.len());
        }
        Self {
            file: file.into(),
            text,
            path: None,
        }
    }

    /// Deserialises the text; see [`parse_ron`].
    pub fn parse<'a, T: Deserialize<'a>>(&'a self) -> Result<T, DocumentError> {
        self.parse_as(&Format::PLAIN)
    }

    /// Deserialises the text as a format, with all errors.
    pub fn parse_as<'a, T: Deserialize<'a>>(&'a self, format: &Format) -> Result<T, DocumentError> {
        let read = reader::read(&self.text);
        read.map_err(|error| all_errors::all_errors(self, format, error))
    }

    /// Returns the value of the first field with this name.
    pub fn field_value(&self, name: &str) -> Option<&str> {
        scan::field_value(&self.text, name)
    }

    /// Returns an error at `slice`, a slice of [`text`](Self::text) such as [`Spanned::text`].
    pub fn error_at(&self, slice: &str, message: impl std::fmt::Display) -> DocumentError {
        DocumentError::at_slice(&self.file, &self.text, slice, message)
    }
}

/// Deserialises a RON text, from which the value may borrow. `file` names the text in errors.
///
/// Optional fields are written without `Some`. An error has a position, states what is expected there, and suggests the
/// nearest valid name. Nesting deeper than 128 levels is an error.
pub fn parse_ron<'a, T: Deserialize<'a>>(text: &'a str, file: &str) -> Result<T, DocumentError> {
    reader::read(text).map_err(|error| {
        let explained = ron_error::explain(text, &error, &Format::PLAIN);
        DocumentError::at(file, text, explained.range, explained.message)
    })
}

fn ron_options() -> ron::Options {
    ron::Options::default().with_default_extension(Extensions::IMPLICIT_SOME)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_byte_order_mark_is_not_part_of_the_text() {
        let read = |text: &str| Document::new("a.ron", text).parse::<u8>();
        assert_eq!(read("\u{feff}7"), Ok(7));
        let error = read("\u{feff}x").unwrap_err();
        assert_eq!((error.line(), error.column()), (Some(1), Some(1)));
    }
}
