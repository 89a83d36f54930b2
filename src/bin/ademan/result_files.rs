//! Checks of the files that a command writes at its end, before the time to compute them is spent.

use std::path::{Path, PathBuf};

use ademan::files::{self, folder_of, is_same_file};
use ademan::message::escape_path;

use crate::failure::Failure;

/// Refuses a file that cannot be written, that the command reads, or that is named for another result. Any other file is replaced.
pub fn check(written: &[&Path], read: &[PathBuf]) -> Result<(), Failure> {
    for (index, path) in written.iter().enumerate() {
        let name = escape_path(path);
        if *path == Path::new("-") {
            return Err(Failure::wrong_use(
                "a result is written to a file, not to the standard output; name a file",
            ));
        }
        check_folder(path)?;
        files::check_destination(path).map_err(|error| Failure::cannot_write(path, error))?;
        check_not_read(path, read)?;
        if written[..index].iter().any(|it| is_same_file(path, it)) {
            return Err(Failure::wrong_use(format!(
                "{name} is named for two results; name another file"
            )));
        }
    }
    Ok(())
}

/// Refuses a file that the command reads.
pub fn check_not_read(path: &Path, read: &[PathBuf]) -> Result<(), Failure> {
    if read.iter().any(|it| is_same_file(path, it)) {
        let name = escape_path(path);
        return Err(Failure::wrong_use(format!(
            "{name} is read by this command and is not overwritten; name another file"
        )));
    }
    Ok(())
}

/// Refuses a file whose folder does not exist.
pub fn check_folder(path: &Path) -> Result<(), Failure> {
    if folder_of(path).is_dir() {
        return Ok(());
    }
    let name = escape_path(path);
    Err(Failure::wrong_use(format!(
        "cannot write {name}: there is no such folder; create it, or name a file in another one"
    )))
}
