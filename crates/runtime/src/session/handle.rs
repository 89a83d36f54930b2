//! The owner's end of a session.

use std::panic::resume_unwind;
use std::sync::{Arc, OnceLock};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, bounded, never};

use super::command_channel::CommandSender;
use super::layout_trial::LayoutTrial;
use super::sensor_link::SensorLink;
use super::view::{ViewHub, Viewer};
use super::{Session, SessionError, Summary};
use ademan_core::command::Command;
use ademan_core::snapshot::Snapshot;

/// Snapshots that wait for the owner: enough that the two threads of a trace seldom wait for each other.
const QUEUED_SNAPSHOTS: usize = 64;

/// A running session. Dropping it stops the session and waits until everything is released.
pub struct SessionHandle {
    commands: CommandSender,
    snapshots: Receiver<Snapshot>,
    views: ViewHub,
    sensors: Arc<SensorLink>,
    trial: Option<LayoutTrial>,
    /// Receives a signal once the outputs are open, and is disconnected if the session ends before.
    started: Receiver<()>,
    /// The outcome of the start: `true` once the session runs.
    has_started: OnceLock<bool>,
    thread: Option<JoinHandle<Result<Summary, SessionError>>>,
}

impl SessionHandle {
    pub(super) fn snapshot_channel() -> (Sender<Snapshot>, Receiver<Snapshot>) {
        bounded(QUEUED_SNAPSHOTS)
    }

    pub(super) fn spawn(
        mut session: Session,
        commands: CommandSender,
        snapshots: Receiver<Snapshot>,
        views: ViewHub,
        sensors: SensorLink,
    ) -> Result<Self, SessionError> {
        let thread = thread::Builder::new().name("session".into());
        let (sender, started) = bounded(1);
        session.start_signal = Some(sender);
        let trial = session.commands.layouts().map(|link| link.trial().clone());
        Ok(Self {
            commands,
            snapshots,
            views,
            sensors: Arc::new(sensors),
            trial,
            started,
            has_started: OnceLock::new(),
            thread: Some(thread.spawn(move || session.run())?),
        })
    }

    /// Returns the channel for commands.
    pub fn commands(&self) -> &CommandSender {
        &self.commands
    }

    /// Returns the channel of the snapshots of all steps, which is disconnected when the session has ended. Without
    /// [`lossless_snapshots`](super::SessionOptions::lossless_snapshots) a full channel drops the newest ones.
    pub fn snapshots(&self) -> &Receiver<Snapshot> {
        &self.snapshots
    }

    /// Returns the channel for layouts that are tried before they are saved. `None` if the session cannot change its layouts.
    pub fn layout_trial(&self) -> Option<&LayoutTrial> {
        self.trial.as_ref()
    }

    /// Adds a viewer, which receives the present state and then every change, at most about 30 times a second.
    pub fn add_viewer(&self) -> Viewer {
        self.views.add_viewer()
    }

    /// Returns the link that changes the calibration and the filter of the first hand.
    pub fn sensors(&self) -> &Arc<SensorLink> {
        &self.sensors
    }

    /// Waits until the source and the outputs are open, or the session has ended. A compositor takes some tenths of a
    /// second; readings that a simulated hand sends before are dropped. Returns `false` if it has ended before they were open.
    pub fn wait_until_started(&self) -> bool {
        let wait = || self.started.recv().is_ok();
        *self.has_started.get_or_init(wait)
    }

    /// Waits as [`wait_until_started`](Self::wait_until_started) does, for at most `timeout`. Returns `None` if the session has neither
    /// started nor ended by then: a desktop may ask the person whether an output is permitted.
    pub fn wait_for_start(&self, timeout: Duration) -> Option<bool> {
        if let Some(has_started) = self.has_started.get() {
            return Some(*has_started);
        }
        let has_started = match self.started.recv_timeout(timeout) {
            Ok(()) => true,
            Err(RecvTimeoutError::Disconnected) => false,
            Err(RecvTimeoutError::Timeout) => return None,
        };
        Some(*self.has_started.get_or_init(|| has_started))
    }

    /// Stops the session without waiting for its end, which may take long while an output waits for a permission. Outputs that open
    /// later are closed before the first reading.
    pub fn abandon(mut self) {
        // A session that has ended receives nothing.
        let _ = self.commands.send(Command::Stop);
        drop(self.thread.take());
    }

    /// Waits for the end of the session.
    ///
    /// # Panics
    ///
    /// If the session thread panicked. Everything is released then.
    pub fn join(mut self) -> Result<Summary, SessionError> {
        // A lossless session must not wait for this receiver.
        self.snapshots = never();
        let thread = self
            .thread
            .take()
            .expect("only this method and `drop` take it");
        thread.join().unwrap_or_else(|panic| resume_unwind(panic))
    }
}

impl Drop for SessionHandle {
    fn drop(&mut self) {
        if let Some(thread) = self.thread.take() {
            self.snapshots = never();
            let _ = self.commands.send(Command::Stop);
            let _ = thread.join();
        }
    }
}
