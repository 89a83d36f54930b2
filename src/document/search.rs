//! The files that a name stands for: a path, a file in the working folder, one in the configuration folder, a shipped one.

use std::fs;
use std::path::{Component, Path, PathBuf};

use super::{Document, shipped};
use crate::files;
use crate::message::escape;
use crate::names;

/// The folders of layouts, gloves and arms in the configuration folder.
const FOLDERS: [&str; 3] = ["layouts", "gloves", "arms"];

/// The end of the name of a RON file.
const EXTENSION: &str = ".ron";

/// The meaning of a name.
pub(super) enum Found {
    /// A file, and its name in messages.
    File { path: PathBuf, name: String },
    /// A file that comes with the program.
    Shipped(Document),
}

/// Returns what a name stands for, in this order: the file at that path in `folder`, with or without `.ron`; a file in the configuration
/// folder; a shipped file. A file that hides a shipped one is reported.
pub(super) fn find(folder: &Path, name: &str) -> Option<Found> {
    let shipped = shipped::find(name);
    let with_extension = format!("{name}{EXTENSION}");
    let own = [name, &with_extension]
        .into_iter()
        .find_map(|name| {
            let path = folder.join(name);
            is_no_directory(&path).then(|| (path, name.to_owned()))
        })
        .or_else(|| {
            let path = in_config_folder(name)?;
            let name = path.to_string_lossy().into_owned();
            Some((path, name))
        });
    match (own, shipped) {
        (Some((path, own_name)), shipped) => {
            if shipped.is_some() && is_bare(name) && !name.ends_with(EXTENSION) {
                tracing::info!(
                    "using {own_name}, which hides the `{name}` that comes with the program"
                );
            }
            Some(Found::File {
                path,
                name: own_name,
            })
        }
        (None, Some(document)) => Some(Found::Shipped(document)),
        (None, None) => None,
    }
}

/// Returns the names of the layouts in the configuration folder.
pub fn own_layouts() -> Vec<String> {
    own_names("layouts")
}

/// Returns the names of the gloves in the configuration folder.
pub fn own_gloves() -> Vec<String> {
    own_names("gloves")
}

/// Returns the message for a name that stands for nothing.
pub(super) fn not_found_message(name: &str) -> String {
    let own = FOLDERS.iter().flat_map(|folder| own_names(folder));
    let candidates: Vec<String> = shipped::names().map(str::to_owned).chain(own).collect();
    let stem = shipped::file_name(name.strip_suffix(EXTENSION).unwrap_or(name));
    let nearest = names::nearest(stem, candidates.iter().map(String::as_str));
    let suggestion = nearest.map_or(String::new(), |nearest| {
        format!(", did you mean `{}`?", escape(nearest))
    });
    format!("there is no such file, and no shipped one of that name{suggestion}")
}

fn own_names(folder: &str) -> Vec<String> {
    let Some(config) = files::config_folder() else {
        return Vec::new();
    };
    let entries = fs::read_dir(config.join(folder)).into_iter().flatten();
    let names = entries.flatten().filter_map(|entry| {
        let name = entry.file_name().into_string().ok()?;
        Some(name.strip_suffix(EXTENSION)?.to_owned())
    });
    let mut names: Vec<String> = names.collect();
    names.sort_unstable();
    names
}

fn in_config_folder(name: &str) -> Option<PathBuf> {
    if !is_bare(name) {
        return None;
    }
    let file = match name.ends_with(EXTENSION) {
        true => name.to_owned(),
        false => format!("{name}{EXTENSION}"),
    };
    FOLDERS
        .iter()
        .find_map(|folder| files::in_config_folder(Path::new(folder).join(&file)))
}

/// Returns `true` for a name without a folder.
fn is_bare(name: &str) -> bool {
    let mut components = Path::new(name).components();
    matches!(
        (components.next(), components.next()),
        (Some(Component::Normal(_)), None)
    )
}

/// Returns `true` if there is a file or device at a path, of whatever kind.
fn is_no_directory(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|metadata| !metadata.is_dir())
}
