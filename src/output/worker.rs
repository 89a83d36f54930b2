//! The thread behind an output that may be slow: it follows orders, tries again, and lets go of
//! everything at the end.

use std::sync::OnceLock;
use std::thread;

use crossbeam_channel::Receiver;
use enigo::Direction;

use super::held::Held;
use super::{RETRIES, RETRY_PAUSE};
use crate::device::KeyCode;

/// Puts keys down and up; one end of a connection to a display, or a stand-in for it.
pub trait Injector {
    /// Puts `key` down or up; `Ok` only when the display has taken it.
    fn inject(&mut self, key: KeyCode, direction: Direction) -> Result<(), String>;
}

/// What the loop wants of a key.
#[derive(Clone, Copy)]
pub struct Order {
    pub key: KeyCode,
    pub direction: Direction,
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
            self.follow(order);
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

    fn follow(&mut self, Order { key, direction }: Order) {
        if direction == Direction::Release {
            return self.release(key);
        }
        if self.report.failure.get().is_some() {
            return;
        }
        // Noted first: a press that failed may have arrived all the same.
        self.held.press(key);
        self.inject(key, direction);
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
            let _ = self.report.failure.set(reason.clone());
        }
        outcome.is_ok()
    }
}
