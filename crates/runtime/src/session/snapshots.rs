//! Snapshots for the owner of a session.

use std::time::Instant;

use crossbeam_channel::Sender;

use super::observer::Observer;
use ademan_core::pipeline::Pipeline;
use ademan_core::snapshot::{Snapshot, StepView};

/// Sends a snapshot of each step to the owner of the session, until the owner drops the receiver.
pub(super) struct SnapshotSender {
    /// `None` once the owner has dropped the receiver.
    pub sender: Option<Sender<Snapshot>>,
    /// `true` if the sender waits for a full channel instead of dropping the snapshot.
    pub is_lossless: bool,
}

impl Observer for SnapshotSender {
    fn observe(&mut self, step: &StepView, _: Instant, _: &Pipeline) {
        let Some(sender) = &self.sender else {
            return;
        };
        let is_disconnected = if self.is_lossless {
            sender.send(step.to_snapshot()).is_err()
        } else if sender.is_full() {
            false
        } else {
            let sent = sender.try_send(step.to_snapshot());
            sent.is_err_and(|error| error.is_disconnected())
        };
        if is_disconnected {
            self.sender = None;
        }
    }
}
