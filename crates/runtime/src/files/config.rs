//! The configuration folder of a person.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use etcetera::BaseStrategy;

/// Returns the folder for files of a person, which may not exist: `~/.config/ademan`, below `$XDG_CONFIG_HOME` if it is set,
/// or `%APPDATA%\ademan` on Windows. `None` if the system has no such folder.
pub fn config_folder() -> Option<PathBuf> {
    let strategy = etcetera::choose_base_strategy().ok()?;
    Some(strategy.config_dir().join("ademan"))
}

/// Returns the folder for what programs keep between two runs, which may not exist: `~/.local/state/ademan`, below
/// `$XDG_STATE_HOME` if it is set, or `%LOCALAPPDATA%\ademan` on Windows. `None` if the system has no such folder.
pub fn state_folder() -> Option<PathBuf> {
    let strategy = etcetera::choose_base_strategy().ok()?;
    let folder = strategy.state_dir().unwrap_or_else(|| strategy.cache_dir());
    Some(folder.join("ademan"))
}

/// Returns the folder for the transcripts that setup files name, which may not exist: `transcripts` in the [`state_folder`].
pub fn transcript_folder() -> Option<PathBuf> {
    Some(state_folder()?.join("transcripts"))
}

/// Returns the path of a file of a person in the configuration folder, if there is anything at the path. What cannot be read, such as a
/// link that leads nowhere, is not taken for absent: its reader reports the reason.
pub fn in_config_folder(path: impl AsRef<Path>) -> Option<PathBuf> {
    let path = config_folder()?.join(path);
    match fs::symlink_metadata(&path) {
        Err(error) if is_no_folder_of_the_person(error.kind()) => None,
        _ => Some(path),
    }
}

/// Returns `true` if the file is absent, its folder cannot exist, or the folder is closed, as the home folder of another user is that
/// `su` has left in the environment.
fn is_no_folder_of_the_person(kind: ErrorKind) -> bool {
    matches!(
        kind,
        ErrorKind::NotFound | ErrorKind::NotADirectory | ErrorKind::PermissionDenied
    )
}
