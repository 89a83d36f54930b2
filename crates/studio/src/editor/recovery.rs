//! Unsaved work, kept in a file of its own, and a lock that tells two editors of one layout apart.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};

use crossbeam_channel::{Receiver, Sender, TrySendError, bounded};

use super::LayoutEditor;
use ademan_core::document::Document;
use ademan_core::message::escape_path;
use ademan_runtime::files::{self, FileError, LockedFile, OpenDocument};

/// The first line of a recovery file; the name of the layout follows.
const HEAD: &str = "// Unsaved work on ";

/// Unsaved work of an editor that did not end as it should.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnsavedWork {
    /// The layout that was edited, as its file or name.
    pub name: String,
    /// The text.
    pub text: String,
}

/// Files with unsaved work, and their locks.
#[derive(Debug)]
pub(super) struct Recovery {
    /// Present while this editor holds the lock of its layout.
    lock: Option<LockedFile>,
    jobs: Option<Sender<Job>>,
    /// The other end, to drop a job that is out of date.
    queued: Receiver<Job>,
    error: Arc<Mutex<Option<String>>>,
    writer: Option<JoinHandle<()>>,
}

#[derive(Debug)]
enum Job {
    Write(String),
    Remove,
}

impl LayoutEditor {
    /// Keeps unsaved work in a folder from now on, and returns what is there of an earlier run. Ask whether to
    /// [`restore`](Self::restore) it before the first edit, which replaces it.
    ///
    /// The usual folder is `editor` in [`files::state_folder`]. Another thread writes.
    pub fn start_recovery(&mut self, folder: &Path) -> Result<Option<UnsavedWork>, FileError> {
        let (recovery, found) = Recovery::start(folder, self.name())?;
        self.recovery = Some(recovery);
        Ok(found.filter(|work| work.text != self.text))
    }

    /// Returns `true` if another Studio edits the same layout. Either can save: the other one merges, or asks.
    pub fn is_open_elsewhere(&self) -> bool {
        let is_locked = |recovery: &Recovery| recovery.lock.is_some();
        self.recovery
            .as_ref()
            .is_some_and(|recovery| !is_locked(recovery))
    }

    /// Returns the reason why unsaved work is not kept at present.
    pub fn recovery_error(&self) -> Option<String> {
        let error = &self.recovery.as_ref()?.error;
        error.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Continues with unsaved work. Undo restores the text of the file.
    pub fn restore(&mut self, work: &UnsavedWork) {
        self.replace_text(&work.text);
    }

    /// Discards unsaved work of an earlier run.
    pub fn discard_unsaved_work(&mut self) {
        self.update_recovery();
    }

    /// Keeps the present text, or removes the recovery file if it is saved.
    pub(super) fn update_recovery(&mut self) {
        let Some(recovery) = &self.recovery else {
            return;
        };
        recovery.send(if self.is_modified() {
            Job::Write(format!(
                "{HEAD}{}\n{}",
                self.name().escape_debug(),
                self.text
            ))
        } else {
            Job::Remove
        });
    }
}

impl Recovery {
    fn start(folder: &Path, name: &str) -> Result<(Self, Option<UnsavedWork>), FileError> {
        if let Some(parent) = folder.parent() {
            fs::create_dir_all(parent)?;
        }
        files::create_private_folder(folder)?;
        let stem = stem(name);
        let lock = files::open_private(&folder.join(format!("{stem}.lock")))?;
        let lock = LockedFile::try_lock(lock).ok();
        let own = if lock.is_some() {
            String::new()
        } else {
            format!(".{}", std::process::id())
        };
        let path = folder.join(format!("{stem}{own}.ron"));
        let found = read(&path);
        let (jobs, queued) = bounded(1);
        let error = Arc::default();
        let writer = thread::Builder::new().name("recovery".into()).spawn({
            let (queued, error) = (queued.clone(), Arc::clone(&error));
            move || run(&queued, &path, &error)
        })?;
        let recovery = Self {
            lock,
            jobs: Some(jobs),
            queued,
            error,
            writer: Some(writer),
        };
        Ok((recovery, found))
    }

    /// Queues a job in place of one that has not begun.
    fn send(&self, mut job: Job) {
        let Some(jobs) = &self.jobs else {
            return;
        };
        while let Err(TrySendError::Full(returned)) = jobs.try_send(job) {
            let _ = self.queued.try_recv();
            job = returned;
        }
    }
}

impl Drop for Recovery {
    fn drop(&mut self) {
        self.jobs = None;
        if let Some(writer) = self.writer.take() {
            let _ = writer.join();
        }
    }
}

/// Writes and removes the file until the editor ends.
fn run(jobs: &Receiver<Job>, path: &Path, error: &Mutex<Option<String>>) {
    for job in jobs {
        let outcome = match job {
            Job::Write(text) => files::replace_private_text(path, &text),
            Job::Remove => match fs::remove_file(path) {
                Err(failure) if failure.kind() != std::io::ErrorKind::NotFound => {
                    Err(failure.into())
                }
                _ => Ok(()),
            },
        };
        let message = outcome.err().map(|failure| {
            format!(
                "unsaved work is not kept: {failure}; save the layout soon: {}",
                escape_path(path)
            )
        });
        *error.lock().unwrap_or_else(PoisonError::into_inner) = message;
    }
}

fn read(path: &Path) -> Option<UnsavedWork> {
    let document = Document::from_path(path.to_str()?).ok()?;
    let (head, text) = document.text.split_once('\n')?;
    Some(UnsavedWork {
        name: head.strip_prefix(HEAD)?.to_owned(),
        text: text.to_owned(),
    })
}

/// Returns a file name for the layout with a name: its last part for people, and a hash of the whole path.
fn stem(name: &str) -> String {
    let path = fs::canonicalize(name).unwrap_or_else(|_| PathBuf::from(name));
    let last = path.file_stem().unwrap_or_default().to_string_lossy();
    let is_plain = |c: &char| c.is_ascii_alphanumeric() || *c == '-';
    let last: String = last.chars().filter(is_plain).take(40).collect();
    // FNV-1a.
    let hash = path.as_os_str().as_encoded_bytes().iter();
    let hash = hash.fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3)
    });
    format!("{last}-{hash:016x}")
}
