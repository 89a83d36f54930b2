//! Files that became incomplete while the session continues.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::notice::Notice;
use super::notice_thread::NoticeSender;

/// The reasons why files of a session are incomplete. Each is sent as a notice at once, and is a line in the state of the session.
#[derive(Clone, Default)]
pub struct WriteFailures {
    reasons: Arc<Mutex<Vec<String>>>,
    notices: Option<NoticeSender>,
}

impl WriteFailures {
    /// Creates an empty list that sends each addition as a notice.
    pub(super) fn new(notices: NoticeSender) -> Self {
        Self {
            reasons: Arc::default(),
            notices: Some(notices),
        }
    }

    /// Adds a reason, from any thread.
    pub(super) fn report(&self, reason: String) {
        self.lock().push(reason.clone());
        if let Some(notices) = &self.notices {
            notices.send(Notice::FileIncomplete(reason));
        }
    }

    /// Returns the reasons so far.
    pub(super) fn reasons(&self) -> Vec<String> {
        self.lock().clone()
    }

    fn lock(&self) -> MutexGuard<'_, Vec<String>> {
        self.reasons.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
