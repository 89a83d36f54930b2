//! Unsaved work, kept in a file of its own, with a lock that tells two editors of one layout apart.

use std::borrow::Cow;
use std::collections::VecDeque;
use std::fs::{self, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};

use crossbeam_channel::{Receiver, Sender, TrySendError, bounded};

use super::file::EditedFile;
use super::{Edit, LayoutEditor, edit};
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

/// Unsaved work of an earlier run, with its file, which is locked.
#[derive(Debug)]
struct Found {
    path: PathBuf,
    work: UnsavedWork,
    _lock: LockedFile,
}

/// Files with unsaved work. Each run has a file of its own.
#[derive(Debug)]
pub(super) struct Recovery {
    folder: PathBuf,
    /// The part of the names of its files that stands for the layout.
    stem: String,
    /// Lock of the file of this run.
    _lock: Option<LockedFile>,
    /// Another editor has the layout open.
    is_open_elsewhere: bool,
    /// Work of earlier runs that is neither restored nor discarded yet.
    found: VecDeque<Found>,
    jobs: Option<Sender<Job>>,
    /// The other end, to drop a job that is out of date.
    queued: Receiver<Job>,
    error: Arc<Mutex<Option<String>>>,
    /// Reason why the work is kept under the previous name of the layout.
    move_error: Option<String>,
    writer: Option<JoinHandle<()>>,
}

/// The number of files of a layout in which work of earlier runs is looked for.
const MAX_FOUND: usize = 16;

/// The files of a layout that this run locks.
#[derive(Default)]
struct Slots {
    /// The file of this run, with its lock.
    own: Option<(PathBuf, LockedFile)>,
    /// Work of earlier runs.
    found: VecDeque<Found>,
    /// Another editor holds a lock.
    is_open_elsewhere: bool,
}

impl Slots {
    /// Locks the files with work that differs from a text, and the first free file. A file that another editor has locked is neither
    /// offered nor touched.
    fn lock(folder: &Path, stem: &str, text: &str) -> Result<Self, FileError> {
        let mut slots = Self::default();
        for number in 0.. {
            if slots.own.is_some() && number >= MAX_FOUND {
                break;
            }
            let ending = if number == 0 {
                String::new()
            } else {
                format!(".{number}")
            };
            let path = folder.join(format!("{stem}{ending}.ron"));
            let lock = folder.join(format!("{stem}{ending}.lock"));
            if slots.own.is_some() && !path.exists() && !lock.exists() {
                continue;
            }
            let lock = match LockedFile::try_lock(files::open_private(&lock)?) {
                Ok(lock) => lock,
                Err(TryLockError::WouldBlock) => {
                    slots.is_open_elsewhere = true;
                    continue;
                }
                Err(TryLockError::Error(error)) => return Err(error.into()),
            };
            match read(&path).filter(|work| work.text != text) {
                Some(work) => slots.found.push_back(Found {
                    path,
                    work,
                    _lock: lock,
                }),
                None if slots.own.is_none() => slots.own = Some((path, lock)),
                None => {}
            }
        }
        Ok(slots)
    }
}

/// A change of the recovery file.
#[derive(Debug)]
struct Job {
    /// The content; `None`: there is nothing unsaved.
    content: Option<String>,
    /// Work of earlier runs whose files are removed after it. They are locked until then.
    answered: Vec<Found>,
}

impl LayoutEditor {
    /// Keeps unsaved work in a folder from now on, and returns what is there of an earlier run. It stays there until it is
    /// [restored](Self::restore_found_work) or [discarded](Self::discard_found_work).
    ///
    /// The usual folder is `editor` in [`files::state_folder`]. Another thread writes.
    pub fn start_recovery(&mut self, folder: &Path) -> Result<Option<UnsavedWork>, FileError> {
        self.recovery = Some(Recovery::start(folder, &self.file, &self.text)?);
        Ok(self.found_work().cloned())
    }

    /// Returns unsaved work of an earlier run that is neither restored nor discarded yet.
    pub fn found_work(&self) -> Option<&UnsavedWork> {
        let found = self.recovery.as_ref()?.found.front()?;
        Some(&found.work)
    }

    /// Returns `true` if another Studio had the same layout open at the start. Either can save: the other one merges, or asks.
    pub fn is_open_elsewhere(&self) -> bool {
        self.recovery
            .as_ref()
            .is_some_and(|recovery| recovery.is_open_elsewhere)
    }

    /// Returns the reason why unsaved work is not kept at present.
    pub fn recovery_error(&self) -> Option<String> {
        let recovery = self.recovery.as_ref()?;
        let error = recovery.error.lock();
        let error = error.unwrap_or_else(PoisonError::into_inner).clone();
        error.or_else(|| recovery.move_error.clone())
    }

    /// Returns `true` if unsaved work is kept at present, and offered when the layout is opened again.
    pub fn keeps_unsaved_work(&self) -> bool {
        self.recovery.is_some() && self.recovery_error().is_none()
    }

    /// Continues with the found work. Undo restores the text before.
    pub fn restore_found_work(&mut self) {
        if let Some(found) = self.pop_found_work() {
            self.replace_text(&found.work.text);
            self.keep_work(vec![found]);
        }
    }

    /// Discards the found work.
    pub fn discard_found_work(&mut self) {
        if let Some(found) = self.pop_found_work() {
            self.keep_work(vec![found]);
        }
    }

    fn pop_found_work(&mut self) -> Option<Found> {
        self.recovery.as_mut()?.found.pop_front()
    }

    /// Discards what is not saved of this run: the next one does not offer it.
    pub fn discard_unsaved_work(&mut self) {
        if let Some(recovery) = &self.recovery {
            recovery.send(Job {
                content: None,
                answered: Vec::new(),
            });
        }
    }

    /// Keeps the present text, or removes the recovery file if it is saved.
    pub(super) fn update_recovery(&mut self) {
        self.keep_work(Vec::new());
    }

    /// Keeps unsaved work under the present name from now on, where the next run looks for it. Work that was found under the previous
    /// name still waits for an answer.
    pub(super) fn move_recovery(&mut self) {
        let Some(recovery) = &mut self.recovery else {
            return;
        };
        if recovery.stem == stem(&self.file) {
            return;
        }
        match Recovery::start(&recovery.folder, &self.file, &self.text) {
            Ok(mut moved) => {
                moved.found.append(&mut recovery.found);
                *recovery = moved;
            }
            Err(failure) => {
                recovery.move_error = Some(format!(
                    "unsaved work is kept under the previous name: {failure}; save the layout soon: {}",
                    escape_path(&recovery.folder)
                ));
            }
        }
    }

    /// Keeps the text as it would be with edits that are not finished. Those that are refused are left out.
    pub fn keep_with(&self, edits: &[Edit]) {
        let Some(recovery) = &self.recovery else {
            return;
        };
        let mut text = Cow::Borrowed(self.text.as_str());
        for unfinished in edits {
            if let Ok(edited) = edit(&text, unfinished) {
                text = Cow::Owned(edited.text);
            }
        }
        let is_unsaved = self.is_modified() || text != self.text;
        recovery.send(Job {
            content: is_unsaved.then(|| self.content(&text)),
            answered: Vec::new(),
        });
    }

    /// Returns the content of a recovery file with a text.
    fn content(&self, text: &str) -> String {
        format!("{HEAD}{}\n{text}", self.name().escape_debug())
    }

    /// Keeps the present text, and then removes the files of this work of earlier runs.
    fn keep_work(&mut self, answered: Vec<Found>) {
        let Some(recovery) = &self.recovery else {
            return;
        };
        let content = self.is_modified().then(|| self.content(&self.text));
        recovery.send(Job { content, answered });
    }
}

impl Recovery {
    /// Starts to keep work on the layout of a file, which has this text now.
    fn start(folder: &Path, file: &EditedFile, text: &str) -> Result<Self, FileError> {
        if let Some(parent) = folder.parent() {
            fs::create_dir_all(parent)?;
        }
        files::create_private_folder(folder)?;
        let stem = stem(file);
        let slots = Slots::lock(folder, &stem, text)?;
        let (path, lock) = slots.own.unzip();
        let path = path.unwrap_or_default();
        let (jobs, queued) = bounded(1);
        let error = Arc::default();
        let writer = thread::Builder::new().name("recovery".into()).spawn({
            let (queued, error) = (queued.clone(), Arc::clone(&error));
            move || run(&queued, &path, &error)
        })?;
        Ok(Self {
            folder: folder.to_owned(),
            stem,
            _lock: lock,
            is_open_elsewhere: slots.is_open_elsewhere,
            found: slots.found,
            jobs: Some(jobs),
            queued,
            error,
            move_error: None,
            writer: Some(writer),
        })
    }

    /// Queues a job in place of one that has not begun.
    fn send(&self, mut job: Job) {
        let Some(jobs) = &self.jobs else {
            return;
        };
        while let Err(TrySendError::Full(returned)) = jobs.try_send(job) {
            job = returned;
            if let Ok(replaced) = self.queued.try_recv() {
                job.answered.extend(replaced.answered);
            }
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
        let outcome = match &job.content {
            Some(content) => files::replace_private_text(path, content),
            None => remove(path),
        };
        let mut answered = job.answered.iter();
        let outcome = outcome.and_then(|()| answered.try_for_each(|found| remove(&found.path)));
        let message = outcome.err().map(|failure| {
            format!(
                "unsaved work is not kept: {failure}; save the layout soon: {}",
                escape_path(path)
            )
        });
        *error.lock().unwrap_or_else(PoisonError::into_inner) = message;
    }
}

/// Removes a file, if there is one.
fn remove(path: &Path) -> Result<(), FileError> {
    match fs::remove_file(path) {
        Err(failure) if failure.kind() != io::ErrorKind::NotFound => Err(failure.into()),
        _ => Ok(()),
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

/// Returns a file name for the layout of a file: the last part of its name for people, and a hash of the whole path. A name alone is not
/// looked for on the disk: a recording may have chosen it.
fn stem(file: &EditedFile) -> String {
    let path = file.path().and_then(|path| fs::canonicalize(path).ok());
    let path = path.unwrap_or_else(|| PathBuf::from(file.name()));
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
