//! The thread behind an output that may be slow: it follows orders, tries again, and lets go of
//! everything at the end.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::OnceLock;
use std::thread;

use crossbeam_channel::Receiver;
use enigo::Direction;

use super::held::Held;
use super::motion::Impulse;
use super::{RETRIES, RETRY_PAUSE};
use crate::device::KeyCode;

/// Puts keys and buttons down and up, and does what leaves nothing down; one end of a connection to a display, or a stand-in for it.
pub trait Injector {
    /// Puts `key` down or up; `Ok` only when the display has taken it.
    fn inject(&mut self, key: KeyCode, direction: Direction) -> Result<(), String>;

    /// Does something that is over then.
    fn perform(&mut self, impulse: Impulse) -> Result<(), String>;
}

impl Injector for Box<dyn Injector> {
    fn inject(&mut self, key: KeyCode, direction: Direction) -> Result<(), String> {
        (**self).inject(key, direction)
    }

    fn perform(&mut self, impulse: Impulse) -> Result<(), String> {
        (**self).perform(impulse)
    }
}

/// What the loop wants.
#[derive(Clone, Copy)]
pub enum Order {
    Press(KeyCode),
    Release(KeyCode),
    Once(Impulse),
}

/// What the thread has to say; each is said once.
#[derive(Default)]
pub struct Report {
    pub failure: OnceLock<String>,
    pub stuck: OnceLock<String>,
}

/// The thread's side: what it has put down, and where.
pub struct Worker<'a, C> {
    injector: C,
    held: Held,
    report: &'a Report,
}

impl<'a, C: Injector> Worker<'a, C> {
    pub fn new(injector: C, report: &'a Report) -> Self {
        Self {
            injector,
            held: Held::default(),
            report,
        }
    }

    /// Follows orders until there will be no more, then lets go of everything.
    pub fn work(mut self, queue: &Receiver<Order>, mut connect: impl FnMut() -> Result<C, String>) {
        for order in queue {
            // What is down is to come up even when whatever leads to the display panics.
            if catch_unwind(AssertUnwindSafe(|| self.follow(order))).is_err() {
                self.fail("the connection to the display panicked");
            }
        }
        self.release_all();
        if self.held.is_empty() {
            return;
        }
        // The connection may be gone while the display, and what is down on it, is still there.
        if let Ok(injector) = connect() {
            self.injector = injector;
            self.release_all();
        }
        let stuck: Vec<_> = self.held.release_order().map(KeyCode::name).collect();
        if !stuck.is_empty() {
            let _ = self.report.stuck.set(stuck.join(", "));
        }
    }

    fn follow(&mut self, order: Order) {
        match order {
            Order::Release(key) => self.release(key),
            _ if self.report.failure.get().is_some() => {}
            Order::Press(key) => {
                // Noted first: a press that failed may have arrived all the same.
                self.held.press(key);
                self.inject(key, Direction::Press);
            }
            // Tried once: what failed may have arrived, and a second one would be one too many.
            Order::Once(impulse) => {
                if let Err(reason) = self.injector.perform(impulse) {
                    self.fail(&reason);
                }
            }
        }
    }

    /// Tells of a failure; the first one counts.
    fn fail(&self, reason: &str) {
        let _ = self.report.failure.set(reason.into());
    }

    fn release(&mut self, key: KeyCode) {
        if self.held.contains(key) && self.inject(key, Direction::Release) {
            self.held.release(key);
        }
    }

    fn release_all(&mut self) {
        for key in self.held.clone().release_order() {
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
            thread::sleep(RETRY_PAUSE);
            outcome = self.injector.inject(key, direction);
        }
        if let Err(reason) = &outcome {
            self.fail(reason);
        }
        outcome.is_ok()
    }
}
