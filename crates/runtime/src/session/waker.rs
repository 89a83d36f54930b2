//! A way to wake the session loop from any thread.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::Thread;

use crate::capture::WakeUp;

/// Wakes the loop thread, which waits while there is nothing to do.
#[derive(Clone, Debug, Default)]
pub(super) struct Waker(Arc<Shared>);

#[derive(Debug, Default)]
struct Shared {
    /// `true` if a message was queued since the loop last looked.
    has_messages: AtomicBool,
    target: Mutex<Option<WakeTarget>>,
}

/// A waiting thread.
#[derive(Debug)]
pub(super) enum WakeTarget {
    /// The thread is parked.
    Parked(Thread),
    /// The thread polls descriptors.
    Polling(WakeUp),
}

impl Waker {
    /// Wakes the loop. Must be called after the message was queued.
    pub fn wake(&self) {
        self.0.has_messages.store(true, Ordering::Release);
        match &*self.lock_target() {
            Some(WakeTarget::Parked(thread)) => thread.unpark(),
            Some(WakeTarget::Polling(wake_up)) => wake_up.wake(),
            None => {}
        }
    }

    /// Sets the thread to wake. Messages queued before this call are in the queue.
    pub fn attach(&self, target: WakeTarget) {
        *self.lock_target() = Some(target);
    }

    /// Calls `next` for the next message, but only if one may be queued: the loop asks after every reading, and looking into
    /// all queues costs it as much as a stage of the pipeline.
    pub fn receive<T>(&self, next: impl FnOnce() -> Option<T>) -> Option<T> {
        let has_messages = &self.0.has_messages;
        // Cleared before `next` looks: a message that is queued later sets the flag again.
        if !has_messages.load(Ordering::Relaxed) || !has_messages.swap(false, Ordering::Acquire) {
            return None;
        }
        let message = next();
        // More messages may wait after this one.
        if message.is_some() {
            has_messages.store(true, Ordering::Relaxed);
        }
        message
    }

    fn lock_target(&self) -> MutexGuard<'_, Option<WakeTarget>> {
        self.0.target.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use std::thread;
    use std::time::Duration;

    use crossbeam_channel::bounded;

    use super::*;
    use crate::output::tests::wait_until;

    #[test]
    fn the_queues_are_looked_into_only_after_a_wake_up() {
        let waker = Waker::default();
        let receive = || waker.receive(|| Some('a'));
        assert_eq!(receive(), None);
        waker.wake();
        assert_eq!(receive(), Some('a'));
    }

    #[test]
    fn a_message_after_another_is_received_without_a_second_wake_up() {
        let waker = Waker::default();
        let mut queue = ['a', 'b'].into_iter();
        waker.wake();
        let mut receive = || waker.receive(|| queue.next());
        assert_eq!([receive(), receive()], [Some('a'), Some('b')]);
        assert_eq!(receive(), None);
    }

    #[test]
    fn a_message_that_is_queued_during_a_look_is_not_missed() {
        const MESSAGES: u32 = 20_000;
        let (waker, (sender, queue)) = (Waker::default(), bounded(1));
        let loop_waker = waker.clone();
        let receiver = thread::spawn(move || {
            let mut received = 0_u32;
            while received < MESSAGES {
                match loop_waker.receive(|| queue.try_recv().ok()) {
                    Some(_) => received += 1,
                    None => thread::yield_now(),
                }
            }
        });
        // Room for the next message means that the last one was received: a missed one would never be.
        for number in 0..MESSAGES {
            let sent = sender.send_timeout(number, Duration::from_secs(60));
            sent.expect("no message is missed");
            waker.wake();
        }
        wait_until("the last message", || receiver.is_finished());
        receiver.join().unwrap();
    }
}
