//! The stand-in on systems without folders.

use std::path::PathBuf;

pub fn base_folder() -> Option<PathBuf> {
    None
}

pub fn state_folder() -> Option<PathBuf> {
    None
}
