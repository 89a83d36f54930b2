//! A thread that writes to a file, so that a slow disk does not delay the session loop.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, TrySendError, bounded};

use super::write_failures::WriteFailures;
use crate::advice;
use crate::recorder::RecordError;

/// Steps that wait for the disk: more than 1 s at 175 readings per second.
const QUEUE_LENGTH: usize = 256;

/// Longest time at the end in which the disk accepts nothing, and longest wait for it after it has accepted everything.
const DISK_TIMEOUT: Duration = Duration::from_secs(2);

/// Writes a `T` of every step to a file.
pub(super) struct WriterThread<T> {
    path: PathBuf,
    queue: Sender<T>,
    writer: JoinHandle<Result<(), RecordError>>,
    /// Disconnected when the writer has ended.
    ended: Receiver<()>,
    /// Steps that were written.
    written: Arc<AtomicU64>,
    /// `true` once the system has the whole file, and the writer waits for the disk.
    is_complete: Arc<AtomicBool>,
    is_lossless: bool,
    missed: u64,
    /// `true` once the session waits for the end of the writer, and returns its error.
    is_finishing: Arc<AtomicBool>,
    failures: WriteFailures,
}

/// The steps on their way to the file, until the session ends.
pub(super) struct QueuedSteps<T> {
    queue: Receiver<T>,
    /// Steps that the writer has taken before the present one.
    written: Arc<AtomicU64>,
    is_first: bool,
}

impl<T> Iterator for QueuedSteps<T> {
    type Item = T;

    fn next(&mut self) -> Option<T> {
        self.count();
        self.queue.recv().ok()
    }
}

impl<T> QueuedSteps<T> {
    /// Returns the next step, or an error if none comes within `timeout` or the session has ended.
    pub fn next_within(&mut self, timeout: Duration) -> Result<T, RecvTimeoutError> {
        self.count();
        self.queue.recv_timeout(timeout)
    }

    /// Counts the step that was taken before as written.
    fn count(&mut self) {
        if !std::mem::take(&mut self.is_first) {
            self.written.fetch_add(1, Ordering::Relaxed);
        }
    }
}

impl<T: Send + 'static> WriterThread<T> {
    /// Starts to write to a new file. If the disk is slow, a lossless writer delays the session loop, which no output with an
    /// effect allows; any other writer drops steps and counts them. The first step that is dropped is reported to `failures`. `write`
    /// writes all steps and returns a function that waits until the disk has them.
    pub fn start<S: FnOnce() -> Result<(), RecordError>>(
        path: &Path,
        is_lossless: bool,
        failures: WriteFailures,
        write: impl FnOnce(QueuedSteps<T>) -> Result<S, RecordError> + Send + 'static,
    ) -> Result<Self, RecordError> {
        let (queue, receiver) = bounded(QUEUE_LENGTH);
        let (end, ended) = bounded::<()>(0);
        let written = Arc::new(AtomicU64::new(0));
        let steps = QueuedSteps {
            queue: receiver,
            written: written.clone(),
            is_first: true,
        };
        let is_finishing = Arc::new(AtomicBool::new(false));
        let is_complete = Arc::new(AtomicBool::new(false));
        let (is_end, reports) = (is_finishing.clone(), failures.clone());
        let completed = is_complete.clone();
        let write = move || {
            let _end = end;
            let sync = write(steps).inspect_err(|error| {
                if !is_end.load(Ordering::Relaxed) {
                    reports.report(error.to_string());
                }
            })?;
            completed.store(true, Ordering::Relaxed);
            sync()
        };
        let writer = thread::Builder::new().name("recorder".into()).spawn(write);
        Ok(Self {
            path: path.to_owned(),
            queue,
            writer: writer.map_err(|error| {
                // A further attempt must not fail because of the file of this one.
                let _ = fs::remove_file(path);
                RecordError::Create {
                    path: path.to_owned(),
                    reason: advice::no_thread(&error).to_string(),
                }
            })?,
            ended,
            written,
            is_complete,
            is_lossless,
            missed: 0,
            is_finishing,
            failures,
        })
    }

    /// Queues a step for the writer.
    pub fn push(&mut self, step: T) {
        let is_full = if self.is_lossless {
            let sent = self.queue.send(step);
            self.missed += u64::from(sent.is_err());
            false
        } else {
            let sent = self.queue.try_send(step);
            self.missed += u64::from(sent.is_err());
            matches!(sent, Err(TrySendError::Full(_)))
        };
        // A writer that has ended reports its error itself.
        if is_full && self.missed == 1 {
            let error = self.incomplete("the disk is too slow, steps are missing".into());
            self.failures.report(error.to_string());
        }
    }

    fn incomplete(&self, reason: String) -> RecordError {
        RecordError::Write {
            path: self.path.clone(),
            reason,
        }
    }

    /// Waits until everything is on the disk. A disk that accepts nothing for 2 s is given up. One that has accepted everything is not
    /// waited for after 2 s: the system continues to write.
    pub fn finish(self) -> Result<(), RecordError> {
        self.is_finishing.store(true, Ordering::Relaxed);
        let Self {
            path,
            queue,
            writer,
            ended,
            written,
            is_complete,
            missed,
            ..
        } = self;
        drop(queue);
        let stopped = |reason: String| RecordError::Write { path, reason };
        // The steps that were written, and `true` at the end of the file.
        let progress = || {
            let is_whole = is_complete.load(Ordering::Relaxed);
            (written.load(Ordering::Relaxed), is_whole)
        };
        let mut before = progress();
        let ending = loop {
            if ended.recv_timeout(DISK_TIMEOUT) != Err(RecvTimeoutError::Timeout) {
                break writer.join();
            }
            let now = progress();
            if std::mem::replace(&mut before, now) != now {
                continue;
            }
            let (_, is_whole) = now;
            if !is_whole {
                return Err(stopped("the disk does not respond".into()));
            }
            break Ok(Ok(()));
        };
        match ending {
            Err(_) => Err(stopped("the recorder thread panicked".into())),
            Ok(Err(error)) => Err(error),
            Ok(Ok(())) if missed > 0 => Err(stopped(format!(
                "the disk is too slow, {missed} steps are missing"
            ))),
            Ok(Ok(())) => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns what a session reports at the end of a file whose disk is awaited by `sync`.
    fn finish(
        sync: impl FnOnce() -> Result<(), RecordError> + Send + 'static,
    ) -> Result<(), RecordError> {
        let write = move |steps: QueuedSteps<u8>| {
            steps.for_each(drop);
            Ok(sync)
        };
        let path = Path::new("hand.mcap");
        let writer = WriterThread::start(path, false, WriteFailures::default(), write);
        let mut writer = writer.unwrap();
        writer.push(1);
        writer.finish()
    }

    #[test]
    fn a_disk_that_fails_after_the_last_write_is_reported() {
        let error = finish(|| {
            Err(RecordError::Write {
                path: "hand.mcap".into(),
                reason: "Disk quota exceeded".into(),
            })
        });
        assert_eq!(
            error.unwrap_err().to_string(),
            "the recording hand.mcap is incomplete: Disk quota exceeded"
        );
    }

    #[test]
    fn a_whole_file_is_complete_although_the_disk_needs_longer() {
        let (answer, awaited) = bounded::<()>(0);
        let finished = finish(move || {
            let _ = awaited.recv();
            Ok(())
        });
        assert!(finished.is_ok(), "{finished:?}");
        drop(answer);
    }
}
