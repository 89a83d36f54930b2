//! Scripts from files and texts.

use std::path::{Path, is_separator};

use super::Script;
use crate::files::OpenDocument;
use ademan_core::contact::TargetNames;
use ademan_core::document::{Document, DocumentError};

/// Reads a script for targets with these names: the file at a path, or the text itself.
///
/// A text is a script if it has more than one word or is an action, and the path of a file otherwise. With a folder or `.txt`, it
/// is the path of a file that exists, also if it has several words.
pub fn open_script(path_or_text: &str, names: &TargetNames) -> Result<Script, DocumentError> {
    if is_text(path_or_text, Path::new(path_or_text)) {
        Script::from_text(path_or_text, names)
    } else {
        Script::parse(Document::from_path(path_or_text)?, names)
    }
}

/// Returns what [`open_script`] takes for what a file in `folder` means by `path_or_text`: a relative path starts in `folder`.
pub(crate) fn resolve_script(folder: &Path, path_or_text: &str) -> String {
    let path = folder.join(path_or_text);
    if is_text(path_or_text, &path) {
        path_or_text.to_owned()
    } else {
        path.to_string_lossy().into_owned()
    }
}

/// Returns `true` for the text of a script, and `false` for what names the file at `path`.
fn is_text(path_or_text: &str, path: &Path) -> bool {
    let is_script = path_or_text.is_empty() || Script::is_script(path_or_text);
    let is_path = path_or_text.contains(is_separator) || path_or_text.ends_with(".txt");
    is_script && !(is_path && path.is_file())
}
