//! The files that a name stands for: a path, a file in the configuration folder, a shipped one.

use std::fs;
use std::path::{Path, PathBuf, is_separator};

use super::{config_folder, in_config_folder as path_in_config_folder};
use ademan_core::document::{Document, DocumentError, FileKind};
use ademan_core::message::{escape, escape_path};

/// The folders of layouts, gloves, arms and persons in the configuration folder.
const FOLDERS: [&str; 4] = ["layouts", "gloves", "arms", "persons"];

/// The end of the name of a RON file.
const EXTENSION: &str = ".ron";

/// The meaning of a name.
pub(super) enum Found {
    /// A file, and its name in messages.
    File { path: PathBuf, name: String },
    /// A file that comes with the program.
    Shipped(Document),
}

/// Returns what a name stands for, in this order: a shipped file with its folder; for a [path](is_path), the file there in `folder`, with
/// or without `.ron`; a file of this kind, or of any, in the configuration folder; a shipped file. A file that hides a shipped one is
/// reported.
pub(super) fn find(folder: &Path, name: &str, kind: Option<FileKind>) -> Option<Found> {
    let shipped = shipped(name);
    if !is_bare(name) && !name.ends_with(EXTENSION) && shipped.is_some() {
        return shipped.map(Found::Shipped);
    }
    if let Some((path, name)) = file_in(folder, name).filter(|_| is_path(name)) {
        return Some(Found::File { path, name });
    }
    match (in_config_folder(name, kind), shipped) {
        (Some(path), shipped) => {
            let own_name = path.to_string_lossy().into_owned();
            if shipped.is_some() {
                tracing::info!(
                    "using {}, which hides the `{}` that comes with the program",
                    escape(&own_name),
                    escape(name)
                );
            }
            Some(Found::File {
                path,
                name: own_name,
            })
        }
        (None, Some(document)) => {
            report_unused(folder, name);
            Some(Found::Shipped(document))
        }
        (None, None) => None,
    }
}

/// Returns the name under which [`find`] without a folder finds what it finds in `folder`, or the error about a file in `folder` that
/// was meant.
pub(super) fn resolve(
    folder: &Path,
    name: &str,
    kind: Option<FileKind>,
) -> Result<String, DocumentError> {
    if !is_path(name) {
        return match (in_config_folder(name, kind), shipped(name)) {
            (None, None) if file_in(folder, name).is_some() => Err(not_found(folder, name, kind)),
            (None, Some(_)) if !folder.as_os_str().is_empty() => {
                report_unused(folder, name);
                Ok(name.to_owned())
            }
            _ => Ok(name.to_owned()),
        };
    }
    Ok(match find(folder, name, kind) {
        Some(Found::File { path, .. }) => path.to_string_lossy().into_owned(),
        // As a path it would mean the working folder.
        Some(Found::Shipped(_)) => name.strip_suffix(EXTENSION).unwrap_or(name).to_owned(),
        None => folder.join(name).to_string_lossy().into_owned(),
    })
}

/// Reports a file in `folder` that has the name of a shipped one, and may be meant.
fn report_unused(folder: &Path, name: &str) {
    if let Some((path, file)) = file_in(folder, name) {
        tracing::info!(
            "`{}` is the file that comes with the program; to use {}, write ./{}",
            escape(name),
            escape_path(&path),
            escape(&file)
        );
    }
}

/// Returns `true` for a name that means a file in a folder: it has a folder, or `.ron`.
pub(super) fn is_path(name: &str) -> bool {
    !is_bare(name) || name.ends_with(EXTENSION)
}

/// Returns the file with a name in a folder, with or without `.ron`, and its name.
fn file_in(folder: &Path, name: &str) -> Option<(PathBuf, String)> {
    let names = [name.to_owned(), format!("{name}{EXTENSION}")];
    let mut files = names
        .into_iter()
        .map(|file_name| (folder.join(&file_name), file_name));
    files.find(|(path, _)| is_no_directory(path))
}

/// Returns the names of the files of a kind in the configuration folder, without `.ron`.
pub fn own_names(kind: FileKind) -> Vec<String> {
    names_in(folders(Some(kind)))
}

/// Returns the error for a name that stands for nothing, which suggests files of a kind, or of all kinds. In `folder`, there may be a
/// file with that name.
pub(super) fn not_found(folder: &Path, name: &str, kind: Option<FileKind>) -> DocumentError {
    if let Some((_, file)) = file_in(folder, name).filter(|_| !is_path(name)) {
        let message = format!(
            "a name without a folder stands for a file in the configuration folder or for one that comes with the program; to use the \
             file in this folder, write ./{}",
            escape(&file)
        );
        return DocumentError::for_file(name, message);
    }
    DocumentError::no_such_file(name, kind, &names_in(folders(kind)))
}

/// Returns the folders in the configuration folder that have files of a kind, or of any kind.
fn folders(kind: Option<FileKind>) -> &'static [&'static str] {
    match kind {
        None => &FOLDERS,
        Some(FileKind::Layout) => &["layouts"],
        Some(FileKind::Glove) => &["gloves"],
        Some(FileKind::Arm) => &["arms"],
        Some(FileKind::Person) => &["persons"],
        Some(FileKind::Setup | FileKind::Learned) => &[],
    }
}

fn shipped(name: &str) -> Option<Document> {
    Document::shipped(name).ok()
}

/// Returns the names of the files in folders of the configuration folder, sorted in each.
fn names_in(folders: &[&str]) -> Vec<String> {
    let Some(config) = config_folder() else {
        return Vec::new();
    };
    let names_in_one = |folder: &&str| {
        let entries = fs::read_dir(config.join(folder)).into_iter().flatten();
        let names = entries.flatten().filter_map(|entry| {
            let name = entry.file_name().into_string().ok()?;
            Some(name.strip_suffix(EXTENSION)?.to_owned())
        });
        let mut names: Vec<String> = names.collect();
        names.sort_unstable();
        names
    };
    folders.iter().flat_map(names_in_one).collect()
}

/// Returns the file with a name in the configuration folder, in the folder of a kind or of any.
fn in_config_folder(name: &str, kind: Option<FileKind>) -> Option<PathBuf> {
    if !is_bare(name) {
        return None;
    }
    let file = if name.ends_with(EXTENSION) {
        name.to_owned()
    } else {
        format!("{name}{EXTENSION}")
    };
    let mut searched = folders(kind).iter();
    searched.find_map(|folder| path_in_config_folder(Path::new(folder).join(&file)))
}

/// Returns `true` for a name without a folder.
fn is_bare(name: &str) -> bool {
    !name.contains(is_separator)
}

/// Returns `true` if there is a file or device at a path, of whatever kind.
fn is_no_directory(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|metadata| !metadata.is_dir())
}
