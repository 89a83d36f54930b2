//! The paths to watch for changes of one file.

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::fs;
use std::path::{Component, Path, PathBuf};

/// Largest number of symbolic links on a path, as in the kernel (path_resolution(7)).
const MAX_LINKS: usize = 40;

/// The directory entries whose changes can change the content at a path: the file, and every symbolic link that leads
/// to it. All paths are free of links.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct WatchSet {
    /// The entries.
    pub entries: BTreeSet<PathBuf>,
    /// The directories of the entries.
    pub directories: BTreeSet<PathBuf>,
    /// The file itself, which can also be written through another hard link; `None` if a directory is missing.
    pub file: Option<PathBuf>,
}

impl WatchSet {
    /// Resolves an absolute path. If a directory is missing, its entry is the last one of the set.
    pub fn resolve(path: &Path) -> Self {
        let mut set = Self::default();
        let mut directory = root(path);
        let mut rest = names(path);
        let mut links = 0;
        while let Some(name) = rest.pop() {
            if name == ".." {
                directory.pop();
                continue;
            }
            let entry = directory.join(&name);
            match fs::read_link(&entry) {
                Ok(target) => {
                    set.add(&directory, &entry);
                    links += 1;
                    if links > MAX_LINKS {
                        return set;
                    }
                    if target.is_absolute() {
                        directory = root(&target);
                    }
                    rest.extend(names(&target));
                }
                Err(_) if !rest.is_empty() && entry.is_dir() => directory = entry,
                Err(_) => {
                    set.add(&directory, &entry);
                    set.file = rest.is_empty().then_some(entry);
                    return set;
                }
            }
        }
        set
    }

    fn add(&mut self, directory: &Path, entry: &Path) {
        self.directories.insert(directory.to_owned());
        self.entries.insert(entry.to_owned());
    }

    /// Returns `true` if a change at this path matters. A change of a directory itself is its removal or its move.
    pub fn contains(&self, path: &Path) -> bool {
        self.entries.contains(path) || self.directories.contains(path)
    }
}

/// Returns the root of an absolute path.
fn root(path: &Path) -> PathBuf {
    let is_root = |part: &Component| matches!(part, Component::Prefix(_) | Component::RootDir);
    path.components().take_while(is_root).collect()
}

/// Returns the names in a path, the last one first.
fn names(path: &Path) -> Vec<OsString> {
    let name = |part: Component| match part {
        Component::Normal(name) => Some(name.to_owned()),
        Component::ParentDir => Some("..".into()),
        _ => None,
    };
    path.components().rev().filter_map(name).collect()
}
