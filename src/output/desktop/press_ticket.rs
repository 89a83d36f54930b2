//! The validity of a queued press: its generation and its age.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use crate::time::NO_DEADLINE;

/// Longest time between the request of a press and its transmission. A display that responds takes less than a
/// millisecond; after a longer time, the person no longer expects the press.
pub const MAX_PRESS_AGE: Duration = Duration::from_millis(250);

/// A mark of a queued press or character.
#[derive(Clone, Copy, Debug)]
pub struct PressTicket {
    generation: u64,
    queued_at: Instant,
}

/// The issuer of tickets, shared by the loop and the thread of an output.
#[derive(Debug)]
pub struct PressTickets {
    generation: AtomicU64,
    max_age: Duration,
}

impl PressTickets {
    /// Creates an issuer of tickets that are valid for `max_age`.
    pub fn new(max_age: Duration) -> Self {
        Self {
            generation: AtomicU64::new(0),
            max_age,
        }
    }

    /// Returns a ticket for a press that is queued now.
    pub fn issue(&self) -> PressTicket {
        PressTicket {
            generation: self.generation.load(Ordering::Acquire),
            queued_at: Instant::now(),
        }
    }

    /// Returns the time after which the press is too old.
    pub fn deadline(&self, ticket: PressTicket) -> Instant {
        // Tests have tickets that are valid for ever.
        let deadline = ticket.queued_at.checked_add(self.max_age);
        deadline.unwrap_or_else(|| ticket.queued_at + NO_DEADLINE)
    }

    /// Invalidates all tickets so far.
    pub fn void(&self) {
        self.generation.fetch_add(1, Ordering::AcqRel);
    }

    /// Returns `true` if the press may still be sent.
    pub fn is_valid(&self, ticket: PressTicket) -> bool {
        ticket.generation == self.generation.load(Ordering::Acquire)
            && ticket.queued_at.elapsed() <= self.max_age
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ticket_is_valid_until_it_is_void_or_too_old() {
        let tickets = PressTickets::new(Duration::from_secs(3600));
        let first = tickets.issue();
        assert!(tickets.is_valid(first));
        tickets.void();
        let second = tickets.issue();
        assert!(!tickets.is_valid(first) && tickets.is_valid(second));
        let expired = PressTickets::new(Duration::ZERO);
        let ticket = expired.issue();
        std::thread::sleep(Duration::from_millis(1));
        assert!(!expired.is_valid(ticket));
    }
}
