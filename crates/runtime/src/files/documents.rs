//! Documents from files.

use std::fs;
use std::io::{self, ErrorKind, Read};
use std::path::Path;

use super::search::{self, Found};
use super::{FileError, open_trusted};
use ademan_core::document::{Document, DocumentError, FileKind, MAX_DOCUMENT_BYTES};
use ademan_core::kinematics::ArmModel;
use ademan_core::layout::{Glove, Layout};

/// The ways to find and read a [`Document`].
pub trait OpenDocument: Sized {
    /// Reads the file with this name.
    ///
    /// A name with a folder or with `.ron` is a path: `./mine` and `mine.ron` are the file `mine.ron` in the working folder. Any other
    /// name never means the working folder, to which other users may write. The first of these that exists is read:
    ///
    /// 1. for `keyboards/arrows`, the shipped file with its folder; for a path, the file there, also with `.ron`,
    /// 2. for a name without a folder, `NAME.ron` in `layouts`, `gloves`, `arms` or `persons` of the
    ///    [configuration folder](super::config_folder), in this order,
    /// 3. the shipped file: `arrows`, `keyboards/arrows.ron`.
    ///
    /// A file that hides a shipped one is logged. A file that [other users may change](open_trusted) is rejected, and so is
    /// one larger than [`MAX_DOCUMENT_BYTES`], without being read to its end.
    fn open(name: &str) -> Result<Self, DocumentError> {
        Self::open_relative_to(Path::new(""), name)
    }

    /// As [`open`](Self::open), but in the configuration folder only the folder of this kind is searched. If there is no such file, only
    /// files of this kind are suggested.
    fn open_kind(kind: FileKind, name: &str) -> Result<Self, DocumentError>;

    /// As [`open`](Self::open), with relative paths resolved against `folder`.
    fn open_relative_to(folder: &Path, name: &str) -> Result<Self, DocumentError>;

    /// Returns the name under which [`open_kind`](Self::open_kind) finds what a file in `folder` means by `name`. A relative path starts in
    /// `folder`, as with [`open_relative_to`](Self::open_relative_to).
    ///
    /// # Errors
    /// Fails for a name without a folder that stands for nothing, if a file in `folder` was meant.
    fn resolve(folder: &Path, kind: FileKind, name: &str) -> Result<String, DocumentError>;

    /// Reads the regular file at `path`, if no other user may change it. Does not fall back to a shipped file.
    fn from_path(path: &str) -> Result<Self, DocumentError>;
}

impl OpenDocument for Document {
    fn open_kind(kind: FileKind, name: &str) -> Result<Self, DocumentError> {
        open(Path::new(""), name, Some(kind))
    }

    fn open_relative_to(folder: &Path, name: &str) -> Result<Self, DocumentError> {
        open(folder, name, None)
    }

    fn resolve(folder: &Path, kind: FileKind, name: &str) -> Result<String, DocumentError> {
        search::resolve(folder, name, Some(kind))
    }

    fn from_path(path: &str) -> Result<Self, DocumentError> {
        read(Path::new(path), path)
    }
}

/// Reads the file with a name in a folder; see [`OpenDocument::open`]. `kind` is the kind of the files that are searched and suggested.
fn open(folder: &Path, name: &str, kind: Option<FileKind>) -> Result<Document, DocumentError> {
    match search::find(folder, name, kind) {
        Some(Found::File { path, name }) => read(&path, &name),
        Some(Found::Shipped(document)) => Ok(document),
        None => {
            let path = folder.join(name);
            let is_absent = fs::metadata(&path).is_err_and(|error| is_not_found(&error));
            if (search::is_path(name) || path.is_dir()) && !is_absent {
                return read(&path, name);
            }
            Err(search::not_found(folder, name, kind))
        }
    }
}

/// A description that [`Document::open`](OpenDocument::open) finds by its name or path, such as `qwerty-flat` or `./mine.ron`.
pub trait Load: Sized {
    /// Loads what has this name or path.
    fn load(name: &str) -> Result<Self, DocumentError>;
}

impl Load for Layout {
    /// Loads a layout for the design hand.
    fn load(name: &str) -> Result<Self, DocumentError> {
        Self::from_document(Document::open_kind(FileKind::Layout, name)?)
    }
}

impl Load for Glove {
    fn load(name: &str) -> Result<Self, DocumentError> {
        Self::parse(&Document::open_kind(FileKind::Glove, name)?)
    }
}

impl Load for ArmModel {
    fn load(name: &str) -> Result<Self, DocumentError> {
        Self::parse(&Document::open_kind(FileKind::Arm, name)?)
    }
}

fn read(path: &Path, name: &str) -> Result<Document, DocumentError> {
    let file_error = |message: String| DocumentError::for_file(name, message);
    let mut bytes = Vec::new();
    let file = open_trusted(path).map_err(|error| file_error(reason(error)))?;
    file.take(MAX_DOCUMENT_BYTES + 1)
        .read_to_end(&mut bytes)
        .map_err(|error| file_error(reason(error.into())))?;
    if bytes.len() as u64 > MAX_DOCUMENT_BYTES {
        return Err(file_error("the file is larger than 1 MiB".into()));
    }
    match String::from_utf8(bytes) {
        Ok(text) => Ok(Document {
            path: Some(path.to_owned()),
            ..Document::new(name, text)
        }),
        Err(error) => {
            let offset = error.utf8_error().valid_up_to();
            let text = String::from_utf8_lossy(error.as_bytes());
            let message = "the file is not valid UTF-8, save it in that encoding";
            Err(DocumentError::at(name, &text, offset..offset + 1, message))
        }
    }
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
