//! The files of a folder as pages.

use std::collections::BTreeMap;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::pages;
use crate::files::{FileError, open_regular};
use ademan_core::message::escape_path;

/// Most files of a folder, and the most bytes of all of them: a page has some 40 files with 3 MB, 9 MB more with
/// text decoders and 20 MB with a webcam.
const MAX_FILES: usize = 500;
const MAX_BYTES: u64 = 64 << 20;

/// The first page.
const INDEX: &str = "index.html";

/// The types of files, by the end of their names. Files of other types are not served.
const TYPES: [(&str, &str); 10] = [
    ("html", "text/html; charset=utf-8"),
    ("css", "text/css; charset=utf-8"),
    ("js", "text/javascript; charset=utf-8"),
    ("mjs", "text/javascript; charset=utf-8"),
    ("json", "application/json"),
    ("wasm", "application/wasm"),
    ("svg", "image/svg+xml"),
    ("png", "image/png"),
    ("task", "application/octet-stream"),
    ("adm", "application/octet-stream"),
];

/// The reason why a folder cannot be served.
#[derive(Debug, thiserror::Error)]
pub enum PageFolderError {
    /// It holds no page.
    #[error(
        "{} has no {INDEX}: the page is not built, or it is elsewhere; run web/build in the sources of Ademán, and name the folder that it makes: --dir target/web",
        escape_path(.0)
    )]
    NotBuilt(PathBuf),
    /// A file in it cannot be read.
    #[error("cannot read {}: {error}", escape_path(.path))]
    Unreadable {
        /// The file or folder.
        path: PathBuf,
        /// The cause.
        error: FileError,
    },
    /// It is something else than a page.
    #[error(
        "{} holds more than {MAX_FILES} files or 64 MiB, so it is not the folder of a page; name another one with --dir",
        escape_path(.0)
    )]
    TooLarge(PathBuf),
}

/// The files that lie in a folder, read once: a request chooses one of them and is never a path on the disk.
#[derive(Debug)]
pub struct PageFolder {
    /// By path in a request, such as `/page.css`.
    answers: BTreeMap<String, Arc<[u8]>>,
}

impl PageFolder {
    /// Reads the files of a folder that have a type of a page.
    pub fn read(folder: &Path) -> Result<Self, PageFolderError> {
        if !folder.join(INDEX).is_file() {
            return Err(PageFolderError::NotBuilt(folder.into()));
        }
        let unreadable = |path: &Path, error| PageFolderError::Unreadable {
            path: path.into(),
            error,
        };
        let entries = fs::read_dir(folder).map_err(|error| unreadable(folder, error.into()))?;
        let (mut answers, mut left) = (BTreeMap::new(), MAX_BYTES);
        for entry in entries.flatten() {
            let path = entry.path();
            let Some((name, kind)) = entry.file_name().to_str().and_then(named) else {
                continue;
            };
            let mut body = Vec::new();
            let file = open_regular(&path).map_err(|error| unreadable(&path, error))?;
            let read = file.take(left + 1).read_to_end(&mut body);
            read.map_err(|error| unreadable(&path, error.into()))?;
            left = match left.checked_sub(body.len() as u64) {
                Some(left) if answers.len() < MAX_FILES => left,
                _ => return Err(PageFolderError::TooLarge(folder.into())),
            };
            answers.insert(name, pages::answer_of_folder(kind, &body).into());
        }
        Ok(Self { answers })
    }

    /// Returns the answer with the file of a path, which all clients share; `None` if there is no such file.
    pub fn answer(&self, path: &str) -> Option<&Arc<[u8]>> {
        self.answers.get(path)
    }
}

/// Returns the path and the type of a file of a page.
fn named(file: &str) -> Option<(String, &'static str)> {
    let (_, end) = file.rsplit_once('.')?;
    let (_, kind) = TYPES.iter().find(|(own, _)| *own == end)?;
    let path = match file {
        INDEX => "/".to_owned(),
        _ => format!("/{file}"),
    };
    Some((path, kind))
}
