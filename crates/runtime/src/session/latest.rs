//! A channel that holds the newest value only.

use crossbeam_channel::{Receiver, Sender, TrySendError, bounded};

/// Sends the newest value and drops an older one that was not received yet.
pub(super) struct LatestSender<T> {
    sender: Sender<T>,
    oldest: Receiver<T>,
}

impl<T> LatestSender<T> {
    /// Creates a channel.
    pub fn new() -> (Self, Receiver<T>) {
        let (sender, receiver) = bounded(1);
        let oldest = receiver.clone();
        (Self { sender, oldest }, receiver)
    }

    /// Sends a value without waiting.
    pub fn send(&self, value: T) {
        if let Err(TrySendError::Full(value)) = self.sender.try_send(value) {
            let _ = self.oldest.try_recv();
            let _ = self.sender.try_send(value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_replaces_one_that_was_not_received() {
        let (sender, receiver) = LatestSender::new();
        for value in 0..3 {
            sender.send(value);
        }
        assert_eq!(receiver.try_iter().collect::<Vec<_>>(), [2]);
    }
}
