//! The validity of a queued press: its generation and its age.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use ademan_core::time::NO_DEADLINE;

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

impl PressTicket {
    /// Returns the time at which the press was queued.
    pub fn queued_at(&self) -> Instant {
        self.queued_at
    }
}

impl PressTickets {
    /// Creates an issuer of tickets that are valid for `max_age`.
    pub fn new(max_age: Duration) -> Self {
        Self {
            generation: AtomicU64::new(0),
            max_age,
        }
    }

    /// Returns a ticket for a press that is queued now, on the basis of the state in this generation.
    pub fn issue(&self, generation: u64) -> PressTicket {
        PressTicket {
            generation,
            queued_at: Instant::now(),
        }
    }

    /// Returns the generation of valid tickets.
    pub fn generation(&self) -> u64 {
        self.generation.load(Ordering::Acquire)
    }

    /// Returns the time after which the press is too old.
    pub fn deadline(&self, ticket: PressTicket) -> Instant {
        // Tickets of tests never expire.
        let deadline = ticket.queued_at.checked_add(self.max_age);
        deadline.unwrap_or_else(|| ticket.queued_at + NO_DEADLINE)
    }

    /// Invalidates all tickets of the generations so far. Returns the next generation.
    pub fn void(&self) -> u64 {
        self.generation.fetch_add(1, Ordering::AcqRel) + 1
    }

    /// Invalidates all tickets of the generation of a press that was dropped: those after it rely on its effect. Does nothing
    /// if they are invalid already.
    pub fn void_with(&self, dropped: PressTicket) {
        let generation = dropped.generation;
        let _ = self.generation.compare_exchange(
            generation,
            generation + 1,
            Ordering::AcqRel,
            Ordering::Acquire,
        );
    }

    /// Returns `true` if the press may still be sent.
    pub fn is_valid(&self, ticket: PressTicket) -> bool {
        self.is_current(ticket) && ticket.queued_at.elapsed() <= self.max_age
    }

    /// Returns `true` if nothing has made the ticket void, however old it is.
    pub fn is_current(&self, ticket: PressTicket) -> bool {
        ticket.generation == self.generation.load(Ordering::Acquire)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ticket_is_valid_until_it_is_void_or_too_old() {
        let tickets = PressTickets::new(Duration::from_secs(3600));
        let first = tickets.issue(0);
        assert!(tickets.is_valid(first));
        let generation = tickets.void();
        let second = tickets.issue(generation);
        assert!(!tickets.is_valid(first) && tickets.is_valid(second));
        assert!(!tickets.is_valid(tickets.issue(0)));
        let expired = PressTickets::new(Duration::ZERO);
        let ticket = expired.issue(0);
        std::thread::sleep(Duration::from_millis(1));
        assert!(!expired.is_valid(ticket) && expired.is_current(ticket));
    }

    #[test]
    fn a_dropped_press_makes_those_after_it_void_once() {
        let tickets = PressTickets::new(Duration::from_secs(3600));
        let (first, second) = (tickets.issue(0), tickets.issue(0));
        tickets.void_with(first);
        tickets.void_with(second);
        assert!(!tickets.is_valid(second));
        assert_eq!(tickets.generation(), 1);
    }
}
