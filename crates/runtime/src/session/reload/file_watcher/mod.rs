//! Detection of changes to one file by events of the operating system, without polling.

#[cfg(target_os = "linux")]
mod linux;
#[cfg(target_os = "linux")]
use linux as platform;
#[cfg(not(target_os = "linux"))]
mod unsupported;
#[cfg(not(target_os = "linux"))]
use unsupported as platform;
#[cfg(all(test, target_os = "linux"))]
mod tests;
mod watch_set;

use std::io;
use std::mem;
use std::path::{Path, absolute};
use std::thread;

use crossbeam_channel::{Receiver, bounded};
use notify::event::{AccessKind, AccessMode};
use notify::{Config, ErrorKind, Event, EventKind, RecommendedWatcher, RecursiveMode, Watcher};

use self::watch_set::WatchSet;

/// Number of attempts to watch a path whose directories or links change at the same time.
const MAX_ATTEMPTS: usize = 8;

/// A watcher of one file and of the directories and symbolic links that lead to it.
///
/// It resolves the path once. After a change the caller creates a new watcher, since the path may lead to another file.
/// A move of a directory above the parent of the file is not detected.
pub(super) struct FileWatcher {
    changes: Receiver<()>,
    /// Ends its thread when it is dropped.
    _watcher: RecommendedWatcher,
}

impl FileWatcher {
    /// Watches the file at `path`, which may not exist yet.
    ///
    /// # Errors
    /// If the system has no events, too many watches or threads exist, or the file is on a file system that other machines can
    /// change without an event.
    pub fn new(path: &str) -> io::Result<Self> {
        let path = absolute(path)?;
        for _ in 0..MAX_ATTEMPTS {
            let set = WatchSet::resolve(&path);
            let watcher = match Self::watch(&set) {
                // A directory was removed after the path was resolved.
                Err(error) if error.kind() == io::ErrorKind::NotFound => continue,
                watcher => watcher?,
            };
            // Changes of links and directories before the watch are detected here, later ones by the watch.
            if WatchSet::resolve(&path) == set {
                return Ok(watcher);
            }
        }
        Err(io::Error::other("the path keeps changing"))
    }

    fn watch(set: &WatchSet) -> io::Result<Self> {
        check_threads()?;
        let (sender, changes) = bounded(1);
        let relevant = set.clone();
        let handler = move |event: notify::Result<Event>| {
            if event.map_or(true, |event| is_change(&event, &relevant)) {
                // A full channel reports a change already.
                let _ = sender.try_send(());
            }
        };
        let mut watcher = notify::recommended_watcher(handler).map_err(into_io)?;
        if watcher.configure(Config::default()).is_err() {
            // The last thread was taken since the check. Every other call of a watcher without a thread panics, also when it is
            // dropped, so its descriptor stays open.
            mem::forget(watcher);
            return Err(io::Error::other("the system permits no further thread"));
        }
        for directory in &set.directories {
            if !platform::reports_remote_changes(directory)? {
                let reason = "other machines can change this file system without an event";
                return Err(io::Error::other(reason));
            }
            add(&mut watcher, directory)?;
        }
        if let Some(file) = &set.file {
            match add(&mut watcher, file) {
                // Its directory reports when it is created. A file that cannot be read is not watched.
                Err(error)
                    if matches!(
                        error.kind(),
                        io::ErrorKind::NotFound | io::ErrorKind::PermissionDenied
                    ) => {}
                result => result?,
            }
        }
        Ok(Self {
            changes,
            _watcher: watcher,
        })
    }

    /// Returns the channel that receives when the file may have changed.
    pub fn changes(&self) -> &Receiver<()> {
        &self.changes
    }
}

/// Fails if the system permits no further thread: a watcher that cannot start its thread could not be freed.
fn check_threads() -> io::Result<()> {
    let thread = thread::Builder::new().name("watch check".into());
    let ended = thread.spawn(|| ())?.join();
    ended.map_err(|_| io::Error::other("a thread ended early"))
}

fn add(watcher: &mut RecommendedWatcher, path: &Path) -> io::Result<()> {
    watcher
        .watch(path, RecursiveMode::NonRecursive)
        .map_err(into_io)
}

/// Returns `true` if an event can mean a change of the file. Opening and reading, as this program does, is not a change.
fn is_change(event: &Event, set: &WatchSet) -> bool {
    let is_written = match event.kind {
        EventKind::Access(kind) => kind == AccessKind::Close(AccessMode::Write),
        _ => true,
    };
    let is_relevant = event.paths.iter().any(|path| set.contains(path));
    event.need_rescan() || is_written && is_relevant
}

fn into_io(error: notify::Error) -> io::Error {
    match error.kind {
        ErrorKind::Io(error) => error,
        ErrorKind::PathNotFound => io::ErrorKind::NotFound.into(),
        _ => io::Error::other(error),
    }
}
