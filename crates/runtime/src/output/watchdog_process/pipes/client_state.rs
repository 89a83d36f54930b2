//! The client, as its messages show it.

use std::io::{self, Read, Write};
use std::sync::Arc;
use std::thread;

use crossbeam_channel::{Receiver, RecvTimeoutError, bounded};

use crate::output::watchdog::WatchdogMessage;
use crate::output::watchdog_process::ClientLoss;
use crate::output::watchdog_process::client_signs::ClientSigns;
use crate::output::watchdog_process::record::SharedRecord;

/// Messages that wait. The thread that reads them waits while there are more.
const QUEUED: usize = 64;

/// The receiver of the client's messages.
pub struct ClientState<W> {
    messages: Receiver<[u8; WatchdogMessage::BYTES]>,
    replies: W,
    signs: ClientSigns,
}

impl<W: Write> ClientState<W> {
    /// Creates a receiver that reads `input` on a thread and keeps `record` up to date.
    pub fn new(
        mut input: impl Read + Send + 'static,
        replies: W,
        record: Arc<SharedRecord>,
    ) -> io::Result<Self> {
        let (sender, messages) = bounded(QUEUED);
        // A pipe has no time limit. The end of the input closes the queue.
        let read = move || {
            let mut bytes = [0; WatchdogMessage::BYTES];
            while input.read_exact(&mut bytes).is_ok() && sender.send(bytes).is_ok() {}
        };
        thread::Builder::new().name("messages".into()).spawn(read)?;
        Ok(Self {
            messages,
            replies,
            signs: ClientSigns::new(record),
        })
    }

    /// Receives messages until the client is lost. A client that is hung is lost again after its next message.
    pub fn wait_for_loss(&mut self) -> ClientLoss {
        let loss = loop {
            match self.next() {
                Ok(bytes) => self.handle(bytes),
                Err(RecvTimeoutError::Timeout) => break ClientLoss::Hung,
                Err(RecvTimeoutError::Disconnected) => break ClientLoss::Exited,
            }
        };
        self.signs.lose(loss);
        loss
    }

    fn next(&self) -> Result<[u8; WatchdogMessage::BYTES], RecvTimeoutError> {
        match self.signs.timeout() {
            Some(timeout) => self.messages.recv_timeout(timeout),
            None => Ok(self.messages.recv()?),
        }
    }

    fn handle(&mut self, bytes: [u8; WatchdogMessage::BYTES]) {
        let message = WatchdogMessage::from_bytes(bytes);
        if let Some(reply) = message.and_then(|message| self.signs.receive(message)) {
            // A client that does not read has ended, which the end of the input shows.
            let _ = self.replies.write_all(&[reply.to_byte()]);
            let _ = self.replies.flush();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::tests::key;
    use crate::output::watchdog::WatchdogReply;
    use std::io::{PipeReader, PipeWriter, pipe};

    fn client() -> (PipeWriter, PipeReader, ClientState<PipeWriter>) {
        let (input, messages) = pipe().unwrap();
        let (replies, output) = pipe().unwrap();
        let client = ClientState::new(input, output, Arc::default()).unwrap();
        (messages, replies, client)
    }

    fn send(mut pipe: &PipeWriter, messages: &[WatchdogMessage]) {
        for message in messages {
            pipe.write_all(&message.to_bytes()).unwrap();
        }
    }

    #[test]
    fn keys_that_are_pressed_when_the_client_exits_are_known() {
        let (messages, _, mut client) = client();
        let (a, shift) = (key("A"), key("ShiftLeft"));
        let down = WatchdogMessage::KeyDown;
        send(
            &messages,
            &[down(shift), down(a), WatchdogMessage::KeyUp(a)],
        );
        drop(messages);
        assert_eq!(client.wait_for_loss(), ClientLoss::Exited);
        let record = client.signs.record.lock().clone();
        assert_eq!(record.pressed.release_order().collect::<Vec<_>>(), [shift]);
    }

    #[test]
    fn a_silent_client_hangs_while_a_key_is_pressed_and_the_next_reply_says_that_it_was_released() {
        let (messages, mut replies, mut client) = client();
        let a = key("A");
        send(&messages, &[WatchdogMessage::KeyDown(a)]);
        assert_eq!(client.wait_for_loss(), ClientLoss::Hung);
        assert!(client.signs.record.lock().pressed.contains(a));
        let heartbeats = [WatchdogMessage::Heartbeat; 2];
        send(&messages, &[WatchdogMessage::Probe]);
        send(&messages, &heartbeats);
        send(&messages, &[WatchdogMessage::KeyUp(a)]);
        drop(messages);
        while client.wait_for_loss() != ClientLoss::Exited {}
        assert!(client.signs.record.lock().is_empty());
        drop(client);
        let mut bytes = Vec::new();
        replies.read_to_end(&mut bytes).unwrap();
        let expected = [
            WatchdogReply::Probed,
            WatchdogReply::Released,
            WatchdogReply::Alive,
        ];
        assert_eq!(bytes, expected.map(WatchdogReply::to_byte));
    }

    #[test]
    fn a_message_that_arrives_in_parts_is_decoded_and_an_incomplete_one_is_not() {
        let (mut messages, _, mut client) = client();
        let a = WatchdogMessage::KeyDown(key("A")).to_bytes();
        for byte in a.iter().chain(&a[..3]) {
            messages.write_all(&[*byte]).unwrap();
        }
        drop(messages);
        assert_eq!(client.wait_for_loss(), ClientLoss::Exited);
        assert_eq!(client.signs.record.lock().pressed.count(), 1);
    }
}
