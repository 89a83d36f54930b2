//! Checks of the files that a command writes at its end, before the time to compute them is spent.

use std::path::Path;

use ademan::message::escape_path;

use crate::failure::Failure;

/// Refuses a file whose folder does not exist.
pub fn check_folder(path: &Path) -> Result<(), Failure> {
    if folder_of(path).is_dir() {
        return Ok(());
    }
    let name = escape_path(path);
    Err(Failure::wrong_use(format!(
        "cannot write {name}: there is no such folder"
    )))
}

fn folder_of(path: &Path) -> &Path {
    let folder = path.parent().unwrap_or(path);
    if folder.as_os_str().is_empty() {
        Path::new(".")
    } else {
        folder
    }
}
