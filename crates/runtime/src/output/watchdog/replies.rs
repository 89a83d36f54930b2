//! The replies of the watchdog, and the age of the last answered heartbeat.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use crossbeam_channel::{Receiver, Sender, bounded};

use super::message::WatchdogReply;
use super::{MAX_REPLY_AGE, MAX_UNANSWERED, OnRelease};

/// Number of heartbeats whose times are kept: more than may be unanswered.
const KEPT: u64 = 8;
const _: () = assert!(KEPT > MAX_UNANSWERED);

/// The heartbeats and their replies. One thread sends heartbeats at a time.
pub struct Replies {
    start: Instant,
    sent: AtomicU64,
    /// Times of the latest heartbeats, in microseconds after `start`.
    sent_at: [AtomicU64; KEPT as usize],
    answered: AtomicU64,
    arrivals: (Sender<()>, Receiver<()>),
    on_release: OnRelease,
}

impl Replies {
    /// Creates it without a heartbeat.
    pub fn new(on_release: OnRelease) -> Self {
        Self {
            start: Instant::now(),
            sent: AtomicU64::new(0),
            sent_at: Default::default(),
            answered: AtomicU64::new(0),
            arrivals: bounded(1),
            on_release,
        }
    }

    /// Returns the number of heartbeats without a reply.
    pub fn unanswered(&self) -> u64 {
        let answered = self.answered.load(Ordering::Acquire);
        self.sent.load(Ordering::Relaxed).saturating_sub(answered)
    }

    /// Notes a heartbeat before it is sent.
    pub fn note_heartbeat(&self) {
        let sent = self.sent.load(Ordering::Relaxed);
        let time = self.start.elapsed().as_micros() as u64;
        self.sent_at[(sent % KEPT) as usize].store(time, Ordering::Relaxed);
        self.sent.store(sent + 1, Ordering::Release);
    }

    /// Returns `true` if the last answered heartbeat was sent a short time before `now`.
    pub fn are_fresh(&self, now: Instant) -> bool {
        let Some(last) = self.answered.load(Ordering::Acquire).checked_sub(1) else {
            return false;
        };
        let sent_at = self.sent_at[(last % KEPT) as usize].load(Ordering::Relaxed);
        let age = now.saturating_duration_since(self.start).as_micros() as u64;
        age.saturating_sub(sent_at) < MAX_REPLY_AGE.as_micros() as u64
    }

    /// Waits for a reply that makes them [fresh](Self::are_fresh), until `deadline`. Returns `true` if it came.
    pub fn wait_until_fresh(&self, deadline: Instant) -> bool {
        while !self.are_fresh(Instant::now()) {
            if self.arrivals.1.recv_deadline(deadline).is_err() {
                return false;
            }
        }
        true
    }

    /// Notes a reply.
    pub fn receive(&self, reply: WatchdogReply) {
        match reply {
            WatchdogReply::Probed => return,
            WatchdogReply::Released => (self.on_release)(),
            WatchdogReply::Alive => {}
        }
        self.answered.fetch_add(1, Ordering::Release);
        // A signal that waits already has the same effect.
        let _ = self.arrivals.0.try_send(());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use std::sync::atomic::AtomicBool;

    fn replies() -> (Replies, Arc<AtomicBool>) {
        let is_released = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&is_released);
        let on_release = Arc::new(move || flag.store(true, Ordering::Relaxed));
        (Replies::new(on_release), is_released)
    }

    #[test]
    fn a_reply_is_as_old_as_its_heartbeat_and_not_as_its_arrival() {
        let (replies, _) = replies();
        assert!(!replies.are_fresh(Instant::now()));
        replies.note_heartbeat();
        let sent = Instant::now();
        assert!(!replies.are_fresh(sent));
        replies.receive(WatchdogReply::Probed);
        assert_eq!(replies.unanswered(), 1);
        replies.receive(WatchdogReply::Alive);
        assert!(replies.are_fresh(replies.start));
        assert!(!replies.are_fresh(sent + MAX_REPLY_AGE));
        assert!(replies.wait_until_fresh(sent) || sent.elapsed() > MAX_REPLY_AGE);
    }

    #[test]
    fn a_reply_that_reports_releases_does_so_before_it_counts() {
        let (replies, is_released) = replies();
        replies.note_heartbeat();
        replies.receive(WatchdogReply::Released);
        assert!(is_released.load(Ordering::Relaxed));
        assert_eq!(replies.unanswered(), 0);
    }
}
