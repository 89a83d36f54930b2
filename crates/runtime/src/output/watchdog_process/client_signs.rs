//! Signs of life of the client, and the replies to them.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::record::SharedRecord;
use super::{ClientLoss, MIN_READ_TIMEOUT};
use crate::output::watchdog::{HEARTBEAT_TIMEOUT, WatchdogMessage, WatchdogReply};

/// The record of the client's keys, and when it last gave a sign of life.
pub struct ClientSigns {
    /// The keys that the client may have pressed.
    pub(super) record: Arc<SharedRecord>,
    last_message: Instant,
    /// `true` if keys were released since the last reply to a heartbeat, because the client was hung.
    has_released: bool,
}

impl ClientSigns {
    /// Creates the signs of a client that has just started; messages keep `record` up to date.
    pub fn new(record: Arc<SharedRecord>) -> Self {
        Self {
            record,
            last_message: Instant::now(),
            has_released: false,
        }
    }

    /// Returns the time until the client counts as hung; `None` if it does already, or has nothing pressed.
    pub fn timeout(&self) -> Option<Duration> {
        let can_hang = !self.record.is_client_lost() && !self.record.lock().is_empty();
        let remaining = HEARTBEAT_TIMEOUT.saturating_sub(self.last_message.elapsed());
        // The system may have delayed this process and not the client, so the time-out is never zero.
        can_hang.then_some(remaining.max(MIN_READ_TIMEOUT))
    }

    /// Applies a message, and returns the reply to it, if it has one. Each message but a probe is a sign of life.
    pub fn receive(&mut self, message: WatchdogMessage) -> Option<WatchdogReply> {
        self.record.lock().apply(message);
        if message != WatchdogMessage::Probe {
            self.last_message = Instant::now();
            self.record.set_client_lost(false);
        }
        match message {
            WatchdogMessage::Heartbeat if std::mem::take(&mut self.has_released) => {
                Some(WatchdogReply::Released)
            }
            WatchdogMessage::Heartbeat => Some(WatchdogReply::Alive),
            WatchdogMessage::Probe => Some(WatchdogReply::Probed),
            _ => None,
        }
    }

    /// Notes the loss of the client.
    pub fn lose(&mut self, loss: ClientLoss) {
        self.record.set_client_lost(true);
        self.has_released |= loss == ClientLoss::Hung;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::tests::key;

    #[test]
    fn a_probe_of_a_client_that_hangs_is_no_sign_of_life() {
        let record = Arc::<SharedRecord>::default();
        let mut signs = ClientSigns::new(Arc::clone(&record));
        signs.receive(WatchdogMessage::KeyDown(key("A")));
        signs.lose(ClientLoss::Hung);
        signs.receive(WatchdogMessage::Probe);
        assert!(record.is_client_lost());
        assert_eq!(signs.timeout(), None, "it hangs already");
        signs.receive(WatchdogMessage::Heartbeat);
        assert!(!record.is_client_lost());
        assert!(signs.timeout().is_some());
    }
}
