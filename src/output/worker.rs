//! The thread behind an output that may be slow: it follows orders, tries again, and lets go of
//! everything at the end.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, never, select};
use enigo::Direction;

use super::pending_motion::StatelessAction;
use super::pressed_keys::PressedKeys;
use super::watchdog::{HEARTBEAT_INTERVAL, ReleaseTarget, WatchdogClient, WatchdogLost};
use super::{RETRIES, RETRY_DELAY};
use crate::device::KeyCode;
use crate::time::NO_DEADLINE;

/// Puts keys and buttons down and up, and does what leaves nothing down; one end of a connection to a display, or a stand-in for it.
pub trait Injector {
    /// Puts `key` down or up; `Ok` only when the display has taken it.
    fn inject(&mut self, key: KeyCode, direction: Direction) -> Result<(), String>;

    /// Does something that is over then.
    fn perform(&mut self, impulse: StatelessAction) -> Result<(), String>;

    /// What a guardian needs to let go of the keys that this has put down.
    fn release_target(&self) -> ReleaseTarget {
        ReleaseTarget::default()
    }
}

impl Injector for Box<dyn Injector> {
    fn inject(&mut self, key: KeyCode, direction: Direction) -> Result<(), String> {
        (**self).inject(key, direction)
    }

    fn perform(&mut self, impulse: StatelessAction) -> Result<(), String> {
        (**self).perform(impulse)
    }

    fn release_target(&self) -> ReleaseTarget {
        (**self).release_target()
    }
}

/// What the loop wants.
#[derive(Clone, Copy)]
pub enum WorkerRequest {
    Press(KeyCode),
    Release(KeyCode),
    Perform(StatelessAction),
}

/// How long the loop may not have called while something is down; after that the guardian is no longer told
/// that all is well.
const LOOP_LIMIT: Duration = Duration::from_secs(1);

/// What the thread has to say, each once, and what the loop tells it.
#[derive(Default)]
pub struct WorkerStatus {
    pub failure: OnceLock<String>,
    pub stuck_keys: OnceLock<String>,
    /// How often the loop has called: it is alive.
    pub loop_calls: AtomicU64,
}

/// The thread's side: what it has put down, and where.
pub struct Worker<'a, C> {
    /// What it does that with.
    pub injector: C,
    /// The account of it; a guardian puts there what somebody else has pressed.
    pub pressed: PressedKeys,
    report: &'a WorkerStatus,
    guard: Option<WatchdogClient>,
    /// Whether the guardian did not take what it was told.
    is_guard_deaf: bool,
    pulse: Pulse,
}

/// When the loop and this thread last showed that they are alive.
struct Pulse {
    beat: Instant,
    calls: u64,
    called: Instant,
}

impl<'a, C: Injector> Worker<'a, C> {
    pub fn new(injector: C, report: &'a WorkerStatus) -> Self {
        let now = Instant::now();
        Self {
            injector,
            pressed: PressedKeys::default(),
            report,
            guard: None,
            is_guard_deaf: false,
            pulse: Pulse {
                beat: now,
                calls: 0,
                called: now,
            },
        }
    }

    /// The same with a guardian that is told of everything that goes down.
    pub fn with_watchdog(mut self, guard: Option<WatchdogClient>) -> Self {
        self.guard = guard;
        self
    }

    /// Follows orders until there will be no more, then lets go of everything.
    pub fn run(
        mut self,
        queue: &Receiver<WorkerRequest>,
        connect: impl FnMut() -> Result<C, String>,
    ) {
        let mut gone = self
            .guard
            .as_ref()
            .map_or_else(never, |guard| guard.exited().clone());
        loop {
            select! {
                recv(queue) -> order => match order {
                    // What is down is to come up even when whatever leads to the display panics.
                    Ok(order) => if catch_unwind(AssertUnwindSafe(|| self.follow(order))).is_err() {
                        self.fail("the connection to the display panicked");
                    },
                    Err(_) => break,
                },
                recv(gone) -> _ => self.is_guard_deaf = true,
                default(self.patience()) => {}
            }
            self.beat_if_due();
            if self.is_guard_deaf {
                gone = self.replace_guard();
            }
        }
        self.finish(connect);
    }

    /// Lets go of everything, if need be on another connection: this one may be gone while the display, and
    /// what is down on it, is still there.
    pub fn finish(&mut self, mut connect: impl FnMut() -> Result<C, String>) {
        self.release_all();
        if self.pressed.is_empty() {
            return;
        }
        if let Ok(injector) = connect() {
            self.injector = injector;
            self.release_all();
        }
        let stuck: Vec<_> = self.pressed.release_order().map(KeyCode::name).collect();
        if !stuck.is_empty() {
            let _ = self.report.stuck_keys.set(stuck.join(", "));
        }
    }

    /// How long to wait for an order: a guardian wants signs of life while something is down.
    fn patience(&self) -> Duration {
        match self.guard.is_some() && !self.pressed.is_empty() {
            true => HEARTBEAT_INTERVAL.saturating_sub(self.pulse.beat.elapsed()),
            false => NO_DEADLINE,
        }
    }

    fn beat_if_due(&mut self) {
        let Some(guard) = &self.guard else {
            return;
        };
        let now = Instant::now();
        let calls = self.report.loop_calls.load(Ordering::Relaxed);
        // Nothing can be expected of a loop that holds nothing down.
        if calls != self.pulse.calls || self.pressed.is_empty() {
            self.pulse.calls = calls;
            self.pulse.called = now;
        }
        if self.pressed.is_empty() || now - self.pulse.beat < HEARTBEAT_INTERVAL {
            return;
        }
        self.pulse.beat = now;
        if now - self.pulse.called < LOOP_LIMIT {
            self.is_guard_deaf |= guard.send_heartbeat().is_err();
        }
    }

    /// Lets go of everything and starts another guardian; tells when that one ends.
    fn replace_guard(&mut self) -> Receiver<()> {
        self.release_all();
        // The one that is gone was told of these releases in vain.
        self.is_guard_deaf = false;
        let Some(guard) = &mut self.guard else {
            return never();
        };
        match guard.restart() {
            Ok(()) => guard.exited().clone(),
            Err(reason) => {
                self.guard = None;
                self.fail(&reason);
                never()
            }
        }
    }

    /// Tells the guardian of a key; whether it took that.
    fn note(&mut self, key: KeyCode, direction: Direction) -> bool {
        self.tell(|guard| guard.report_key(key, direction))
    }

    /// Tells it whether a character is being written; whether it took that.
    fn note_writing(&mut self, is_writing: bool) -> bool {
        self.tell(|guard| guard.report_text(is_writing))
    }

    fn tell(&mut self, word: impl FnOnce(&WatchdogClient) -> Result<(), WatchdogLost>) -> bool {
        let is_told = self.guard.as_ref().is_none_or(|guard| word(guard).is_ok());
        self.is_guard_deaf |= !is_told;
        is_told
    }

    fn follow(&mut self, order: WorkerRequest) {
        match order {
            WorkerRequest::Release(key) => self.release(key),
            _ if self.report.failure.get().is_some() => {}
            WorkerRequest::Press(key) => {
                // A key that no guardian knows of could stay down.
                if !self.note(key, Direction::Press) {
                    return;
                }
                // Noted first: a press that failed may have arrived all the same.
                self.pressed.press(key);
                self.inject(key, Direction::Press);
            }
            WorkerRequest::Perform(StatelessAction::Write(_)) if !self.note_writing(true) => {}
            // Tried once: what failed may have arrived, and a second one would be one too many.
            WorkerRequest::Perform(impulse) => {
                if let Err(reason) = self.injector.perform(impulse) {
                    self.fail(&reason);
                }
                if let StatelessAction::Write(_) = impulse {
                    self.note_writing(false);
                }
            }
        }
    }

    /// Tells of a failure; the first one counts.
    fn fail(&self, reason: &str) {
        let _ = self.report.failure.set(reason.into());
    }

    fn release(&mut self, key: KeyCode) {
        if self.pressed.contains(key) && self.inject(key, Direction::Release) {
            self.pressed.release(key);
            self.note(key, Direction::Release);
        }
    }

    fn release_all(&mut self) {
        for key in self.pressed.clone().release_order() {
            self.release(key);
        }
    }

    /// Whether the display took it, after some tries. Once it has failed, each order gets one try:
    /// letting go of everything must not take longer than anybody waits.
    fn inject(&mut self, key: KeyCode, direction: Direction) -> bool {
        let retries = match self.report.failure.get() {
            None => RETRIES,
            Some(_) => 0,
        };
        let mut outcome = self.injector.inject(key, direction);
        for _ in 0..retries {
            if outcome.is_ok() {
                break;
            }
            thread::sleep(RETRY_DELAY);
            outcome = self.injector.inject(key, direction);
        }
        if let Err(reason) = &outcome {
            self.fail(reason);
        }
        outcome.is_ok()
    }
}
