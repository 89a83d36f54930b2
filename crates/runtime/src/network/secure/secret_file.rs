//! Files with secrets: read only if no other user can read them, and replaced as a whole.

use std::fs;
use std::io::{self, Read};
use std::path::Path;

use super::file_error;
use crate::files::{self, FileError};
use crate::network::NetworkError;

/// Largest file that is read, in bytes.
const MAX_BYTES: u64 = 1 << 16;

/// Returns the text of a file that only its owner can access; `None` if it does not exist.
pub fn read(path: &Path) -> Result<Option<String>, NetworkError> {
    let fail = |error| file_error("read", path, error);
    let file = match files::open_secret(path) {
        Err(FileError::Io(error)) if error.kind() == io::ErrorKind::NotFound => {
            return Ok(None);
        }
        opened => opened.map_err(fail)?,
    };
    let mut text = String::new();
    let mut limited = file.take(MAX_BYTES);
    limited
        .read_to_string(&mut text)
        .map_err(|error| fail(error.into()))?;
    Ok(Some(text))
}

/// Creates a file that only its owner can access, as a whole or not at all. Fails if it exists.
pub fn create(path: &Path, text: &str) -> Result<(), NetworkError> {
    if fs::symlink_metadata(path).is_ok() {
        let error = io::Error::from(io::ErrorKind::AlreadyExists);
        return Err(file_error("write", path, error));
    }
    replace(path, text)
}

/// Replaces a file: a reader sees the old or the new text and never a part of one.
pub fn replace(path: &Path, text: &str) -> Result<(), NetworkError> {
    files::replace_private_text(path, text).map_err(|error| file_error("write", path, error))
}

/// Creates the folder of the files, and those above it.
pub fn create_folder(folder: &Path) -> Result<(), NetworkError> {
    let fail = |error| file_error("write", folder, error);
    if let Some(parent) = folder.parent() {
        fs::create_dir_all(parent).map_err(|error| fail(error.into()))?;
    }
    files::create_private_folder(folder).map_err(fail)
}
