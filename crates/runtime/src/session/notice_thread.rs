//! The thread that passes the notices of a session to its owner.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::Duration;

use crossbeam_channel::{Receiver, Sender, bounded};

use super::notice::Notice;
use super::options::NoticeReceiver;

/// Maximum number of notices that wait for the user's receiver.
const QUEUE_LENGTH: usize = 64;

/// Longest wait at the end of a session for room in the queue, and again for the notices that the user's receiver has not handled
/// yet.
const FLUSH_TIMEOUT: Duration = Duration::from_secs(1);

/// Sends notices without waiting; drops and counts them when the queue is full.
#[derive(Clone)]
pub(super) struct NoticeSender {
    sender: Sender<Option<Notice>>,
    missed: Arc<AtomicU64>,
}

impl NoticeSender {
    /// Sends a notice.
    pub fn send(&self, notice: Notice) {
        if self.sender.try_send(Some(notice)).is_err() {
            self.missed.fetch_add(1, Ordering::Relaxed);
        }
    }
}

/// A thread that hands notices to the user's receiver, which may block on a terminal.
pub(super) struct NoticeThread {
    sender: NoticeSender,
    /// Disconnected when all notices were handled.
    finished: Receiver<()>,
}

impl NoticeThread {
    /// Starts the thread, which calls the receiver with each notice.
    pub fn start(mut on_notice: NoticeReceiver) -> io::Result<Self> {
        let (sender, notices) = bounded::<Option<Notice>>(QUEUE_LENGTH);
        let missed = Arc::new(AtomicU64::new(0));
        let sender = NoticeSender {
            sender,
            missed: missed.clone(),
        };
        let (finish, finished) = bounded::<()>(0);
        thread::Builder::new()
            .name("notices".into())
            .spawn(move || {
                // `None` marks the end: other threads may keep their senders.
                for notice in notices.iter().map_while(|notice| notice) {
                    on_notice(notice);
                    let missed = missed.swap(0, Ordering::Relaxed);
                    if missed > 0 {
                        on_notice(Notice::Missed(missed));
                    }
                }
                drop(finish);
            })?;
        Ok(Self { sender, finished })
    }

    /// Returns a sender for any thread.
    pub fn sender(&self) -> NoticeSender {
        self.sender.clone()
    }

    /// Waits until all notices were handled: up to 1 s for room in the queue, and up to 1 s for the receiver.
    pub fn finish(&self) {
        let sender = &self.sender.sender;
        if sender.send_timeout(None, FLUSH_TIMEOUT).is_ok() {
            let _ = self.finished.recv_timeout(FLUSH_TIMEOUT);
        }
    }
}
