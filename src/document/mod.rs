//! RON files as text with positions.
//!
//! Layouts, gloves, arms, setups and simulation scripts are all read through a [`Document`]. A document keeps its text, so that an
//! error can name the line and column, show the line, and underline the part that is wrong.

mod all_errors;
mod error;
mod field_names;
mod format;
mod pairs;
mod ranged;
mod ron_error;
mod scan;
mod search;
mod shipped;
mod spanned;
#[cfg(feature = "studio")]
mod tree;

pub use error::{DocumentError, DocumentFault};
pub(crate) use error::{byte_offset, line_number};
pub(crate) use field_names::Structure;
pub(crate) use format::{Format, first_error};
pub use pairs::Pairs;
pub(crate) use ranged::{format_number, ranged_numbers};
pub use search::{own_gloves, own_layouts};
pub use shipped::{shipped_gloves, shipped_layouts};
pub use spanned::Spanned;
#[cfg(feature = "studio")]
pub(crate) use tree::{Item, Node, quote, quoted_content, read_tree};

use std::fs;
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};

use ron::extensions::Extensions;
use serde::Deserialize;

use self::search::Found;
use crate::files::{self, FileError};

/// The largest file that is read, in bytes: 1 MiB.
pub const MAX_BYTES: u64 = 1 << 20;

/// Some editors write a byte order mark at the start of a UTF-8 file.
const BYTE_ORDER_MARK: char = '\u{feff}';

/// The text of a file and the name under which errors report it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Document {
    /// The name that the user gave, or for a shipped file its path, such as `layouts/keyboards/arrows.ron`.
    pub file: String,
    /// The text, without a byte order mark.
    pub text: String,
    /// The file from which the text was read.
    path: Option<PathBuf>,
}

impl Document {
    /// Reads the file with this name.
    ///
    /// A name with a folder or with `.ron` is a path: `./mine` and `mine.ron` are the file `mine.ron` in the working folder. Any other
    /// name never means the working folder, to which other users may write. The first of these that exists is read:
    ///
    /// 1. for `keyboards/arrows`, the shipped file with its folder; for a path, the file there, also with `.ron`,
    /// 2. for a name without a folder, `NAME.ron` in `layouts`, `gloves` or `arms` of the
    ///    [configuration folder](files::config_folder),
    /// 3. the shipped file: `arrows`, `keyboards/arrows.ron`.
    ///
    /// A file that hides a shipped one is logged. A file that [other users may change](files::open_trusted) is rejected, and so is
    /// one larger than [`MAX_BYTES`], without being read to its end.
    pub fn open(name: &str) -> Result<Self, DocumentError> {
        Self::open_relative_to(Path::new(""), name)
    }

    /// As [`open`](Self::open), with relative paths resolved against `folder`.
    pub fn open_relative_to(folder: &Path, name: &str) -> Result<Self, DocumentError> {
        match search::find(folder, name) {
            Some(Found::File { path, name }) => Self::read(&path, &name),
            Some(Found::Shipped(document)) => Ok(document),
            None => {
                let path = folder.join(name);
                let is_absent = fs::metadata(&path).is_err_and(|error| is_not_found(&error));
                if search::is_path(name) && !is_absent {
                    return Self::read(&path, name);
                }
                let message = search::not_found_message(folder, name);
                Err(DocumentError::for_file(name, message))
            }
        }
    }

    /// Returns the name under which [`open`](Self::open) finds what a file in `folder` means by `name`. A relative path starts in
    /// `folder`, as with [`open_relative_to`](Self::open_relative_to).
    ///
    /// # Errors
    /// Fails for a name without a folder that stands for nothing, if a file in `folder` was meant.
    pub fn resolve(folder: &Path, name: &str) -> Result<String, DocumentError> {
        search::resolve(folder, name).map_err(|message| DocumentError::for_file(name, message))
    }

    /// Returns the path of the file from which the text was read. `None` for a shipped file or a text.
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    /// Reads the regular file at `path`, if no other user may change it. Does not fall back to a shipped file.
    pub fn from_path(path: &str) -> Result<Self, DocumentError> {
        Self::read(Path::new(path), path)
    }

    /// Returns the shipped file with that name. Ignores files on the disk.
    pub fn shipped(name: &str) -> Result<Self, DocumentError> {
        shipped::find(name).ok_or_else(|| {
            DocumentError::for_file(name, search::not_found_message(Path::new(""), name))
        })
    }

    /// Makes a document of a text. `file` names it in errors.
    pub fn new(file: impl Into<String>, text: impl Into<String>) -> Self {
        let mut text = text.into();
        if text.starts_with(BYTE_ORDER_MARK) {
            text.drain(..BYTE_ORDER_MARK.len_utf8());
        }
        Self {
            file: file.into(),
            text,
            path: None,
        }
    }

    fn read(path: &Path, name: &str) -> Result<Self, DocumentError> {
        let file_error = |message: String| DocumentError::for_file(name, message);
        let mut bytes = Vec::new();
        let file = files::open_trusted(path).map_err(|error| file_error(reason(error)))?;
        file.take(MAX_BYTES + 1)
            .read_to_end(&mut bytes)
            .map_err(|error| file_error(reason(error.into())))?;
        if bytes.len() as u64 > MAX_BYTES {
            return Err(file_error("the file is larger than 1 MiB".into()));
        }
        match String::from_utf8(bytes) {
            Ok(text) => Ok(Self {
                path: Some(path.to_owned()),
                ..Self::new(name, text)
            }),
            Err(error) => {
                let offset = error.utf8_error().valid_up_to();
                let text = String::from_utf8_lossy(error.as_bytes());
                let message = "the file is not valid UTF-8, save it in that encoding";
                Err(DocumentError::at(name, &text, offset..offset + 1, message))
            }
        }
    }

    /// Deserialises the text; see [`parse_ron`].
    pub fn parse<'a, T: Deserialize<'a>>(&'a self) -> Result<T, DocumentError> {
        self.parse_as(&Format::PLAIN)
    }

    /// Deserialises the text as a format, with all errors.
    pub(crate) fn parse_as<'a, T: Deserialize<'a>>(
        &'a self,
        format: &Format,
    ) -> Result<T, DocumentError> {
        let read = ron_options().from_str(&self.text);
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
    ron_options().from_str(text).map_err(|error| {
        let explained = ron_error::explain(text, &error, &Format::PLAIN);
        DocumentError::at(file, text, explained.range, explained.message)
    })
}

fn ron_options() -> ron::Options {
    ron::Options::default().with_default_extension(Extensions::IMPLICIT_SOME)
}

/// Returns the reason why a file cannot be read.
fn reason(error: FileError) -> String {
    match error {
        FileError::Io(error) if is_not_found(&error) => "there is no such file".into(),
        FileError::Io(error) => format!("cannot read the file: {error}"),
        error => error.to_string(),
    }
}

fn is_not_found(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::NotFound | ErrorKind::NotADirectory | ErrorKind::InvalidInput
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_name_suggests_the_nearest_shipped_file() {
        let error = Document::open("qwerty-falt").unwrap_err();
        assert_eq!(
            error.to_string(),
            "qwerty-falt: there is no such file, and no shipped one of that name, did you mean `qwerty-flat`?"
        );
    }

    #[test]
    fn a_byte_order_mark_is_not_part_of_the_text() {
        let read = |text: &str| Document::new("a.ron", text).parse::<u8>();
        assert_eq!(read("\u{feff}7"), Ok(7));
        let error = read("\u{feff}x").unwrap_err();
        assert_eq!((error.line(), error.column()), (Some(1), Some(1)));
    }
}
