//! The client, as its messages show it.

use std::io::{ErrorKind, Read};
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::sync::Arc;

use arrayvec::ArrayVec;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;
use rustix::net::{SendFlags, send};

use crate::output::watchdog::{WatchdogMessage, WatchdogReply};
use crate::output::watchdog_process::ClientLoss;
use crate::output::watchdog_process::client_signs::ClientSigns;
use crate::output::watchdog_process::record::SharedRecord;

/// The receiver of the client's messages.
pub struct ClientState {
    socket: UnixStream,
    /// The handle of the thread that presses keys; readable when it has ended.
    thread: Option<OwnedFd>,
    signs: ClientSigns,
    /// The bytes of an incomplete message.
    incomplete: Vec<u8>,
}

impl ClientState {
    /// Creates a receiver that keeps `record` up to date.
    pub fn new(socket: UnixStream, thread: Option<OwnedFd>, record: Arc<SharedRecord>) -> Self {
        Self {
            socket,
            thread,
            signs: ClientSigns::new(record),
            incomplete: Vec::new(),
        }
    }

    /// Receives messages until the client is lost. A client that is hung is lost again after its next message.
    pub fn wait_for_loss(&mut self) -> ClientLoss {
        let loss = self.receive_until_loss();
        self.signs.lose(loss);
        loss
    }

    fn receive_until_loss(&mut self) -> ClientLoss {
        loop {
            if let Some(loss) = self.wait_for_message() {
                return loss;
            }
            let mut bytes = [0; 64 * WatchdogMessage::BYTES];
            match self.socket.read(&mut bytes) {
                Ok(0) => return ClientLoss::Exited,
                Ok(count) => self.handle(&bytes[..count]),
                Err(error) => match error.kind() {
                    ErrorKind::Interrupted => {}
                    _ => return ClientLoss::Exited,
                },
            }
        }
    }

    /// Waits until a message can be read. Returns the loss of the client if none follows, or none has come in time.
    fn wait_for_message(&self) -> Option<ClientLoss> {
        let socket = PollFd::new(&self.socket, PollFlags::IN);
        let thread = self.thread.as_ref();
        let thread = thread.map(|thread| PollFd::new(thread, PollFlags::IN));
        let mut polled: ArrayVec<_, 2> = std::iter::once(socket).chain(thread).collect();
        let timeout = self.signs.timeout();
        let timeout = timeout.and_then(|timeout| Timespec::try_from(timeout).ok());
        match poll(&mut polled, timeout.as_ref()) {
            Ok(0) => Some(ClientLoss::Hung),
            // Messages that the thread sent before its end come first.
            Ok(_) if !polled[0].revents().is_empty() => None,
            Ok(_) => Some(ClientLoss::Exited),
            Err(Errno::INTR) => self.wait_for_message(),
            Err(_) => Some(ClientLoss::Exited),
        }
    }

    fn handle(&mut self, bytes: &[u8]) {
        self.incomplete.extend(bytes);
        let complete = self.incomplete.len() - self.incomplete.len() % WatchdogMessage::BYTES;
        for record in self.incomplete[..complete].as_chunks().0 {
            let message = WatchdogMessage::from_bytes(*record);
            if let Some(reply) = message.and_then(|message| self.signs.receive(message)) {
                self.reply(reply);
            }
        }
        self.incomplete.drain(..complete);
    }

    fn reply(&self, reply: WatchdogReply) {
        // A client that does not read replies is stopped; the next read shows it.
        let flags = SendFlags::DONTWAIT | SendFlags::NOSIGNAL;
        let _ = send(&self.socket, &[reply.to_byte()], flags);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::tests::key;
    use crate::output::watchdog::{HEARTBEAT_TIMEOUT, ReleaseTarget};
    use crate::output::watchdog_process::MIN_READ_TIMEOUT;
    use std::io::Write;
    use std::time::{Duration, Instant};

    fn client() -> (UnixStream, ClientState) {
        let (socket, watchdog) = UnixStream::pair().unwrap();
        (socket, ClientState::new(watchdog, None, Arc::default()))
    }

    fn send(mut socket: &UnixStream, messages: &[WatchdogMessage]) {
        for message in messages {
            socket.write_all(&message.to_bytes()).unwrap();
        }
    }

    #[test]
    fn keys_that_are_pressed_when_the_client_exits_are_known() {
        let (socket, mut client) = client();
        let (a, shift) = (key("A"), key("ShiftLeft"));
        send(
            &socket,
            &[
                WatchdogMessage::KeyDown(shift),
                WatchdogMessage::KeyDown(a),
                WatchdogMessage::KeyUp(a),
            ],
        );
        drop(socket);
        assert_eq!(client.wait_for_loss(), ClientLoss::Exited);
        let record = client.signs.record.lock().clone();
        assert_eq!(record.pressed.release_order().collect::<Vec<_>>(), [shift]);
    }

    #[test]
    fn a_client_whose_thread_has_ended_has_exited_although_its_socket_is_open() {
        let (socket, watchdog) = UnixStream::pair().unwrap();
        let a = key("A");
        let thread = std::thread::scope(|scope| {
            let send_and_end = || {
                send(&socket, &[WatchdogMessage::KeyDown(a)]);
                ReleaseTarget::Display.thread_handle()
            };
            scope.spawn(send_and_end).join().unwrap()
        });
        let Some(thread) = thread else {
            println!("SKIPPED: this kernel has no handles of threads");
            return;
        };
        let mut client = ClientState::new(watchdog, Some(thread), Arc::default());
        assert_eq!(client.wait_for_loss(), ClientLoss::Exited);
        assert!(client.signs.record.lock().pressed.contains(a));
    }

    #[test]
    fn a_key_and_an_axis_stay_in_the_record_until_the_client_reports_their_release() {
        let (socket, mut client) = client();
        let a = key("A");
        let pressed = [WatchdogMessage::KeyDown(a), WatchdogMessage::AxesDeflected];
        send(&socket, &pressed);
        for _ in 0..2 {
            assert_eq!(client.wait_for_loss(), ClientLoss::Hung);
            assert!(client.signs.record.is_client_lost());
            let record = client.signs.record.lock().clone();
            assert!(record.pressed.contains(a) && record.are_axes_deflected);
            send(&socket, &[WatchdogMessage::Heartbeat]);
        }
        let released = [WatchdogMessage::KeyUp(a), WatchdogMessage::AxesCentered];
        send(&socket, &released);
        drop(socket);
        while client.wait_for_loss() != ClientLoss::Exited {}
        assert!(client.signs.record.lock().is_empty());
    }

    #[test]
    fn each_heartbeat_has_a_reply() {
        let (mut socket, mut client) = client();
        send(&socket, &[WatchdogMessage::Heartbeat; 3]);
        socket.shutdown(std::net::Shutdown::Write).unwrap();
        assert_eq!(client.wait_for_loss(), ClientLoss::Exited);
        drop(client);
        let mut replies = Vec::new();
        socket.read_to_end(&mut replies).unwrap();
        assert_eq!(replies, [WatchdogReply::Alive.to_byte(); 3]);
    }

    #[test]
    fn the_first_reply_after_a_release_says_so() {
        let (mut socket, mut client) = client();
        send(&socket, &[WatchdogMessage::KeyDown(key("A"))]);
        assert_eq!(client.wait_for_loss(), ClientLoss::Hung);
        send(&socket, &[WatchdogMessage::Heartbeat; 2]);
        socket.shutdown(std::net::Shutdown::Write).unwrap();
        while client.wait_for_loss() != ClientLoss::Exited {}
        drop(client);
        let mut replies = Vec::new();
        socket.read_to_end(&mut replies).unwrap();
        let expected = [WatchdogReply::Released, WatchdogReply::Alive];
        assert_eq!(replies, expected.map(WatchdogReply::to_byte));
    }

    #[test]
    fn a_probe_has_a_reply() {
        let (mut socket, mut client) = client();
        send(&socket, &[WatchdogMessage::KeyDown(key("A"))]);
        assert_eq!(client.wait_for_loss(), ClientLoss::Hung);
        send(&socket, &[WatchdogMessage::Probe]);
        socket.shutdown(std::net::Shutdown::Write).unwrap();
        assert_eq!(client.wait_for_loss(), ClientLoss::Exited);
        drop(client);
        let mut replies = Vec::new();
        socket.read_to_end(&mut replies).unwrap();
        assert_eq!(replies, [WatchdogReply::Probed.to_byte()]);
    }

    /// A busy machine may delay the heartbeats, so the test searches the times at which they were sent for a gap.
    #[test]
    fn a_silent_client_is_hung_only_while_a_key_is_pressed() {
        let (socket, mut client) = client();
        let a = key("A");
        let times = std::thread::scope(|scope| {
            let sender = scope.spawn(|| {
                let mut times = Vec::new();
                let mut send_timed = |message| {
                    times.push(Instant::now());
                    send(&socket, &[message]);
                };
                send_timed(WatchdogMessage::KeyDown(a));
                send_timed(WatchdogMessage::KeyUp(a));
                std::thread::sleep(2 * HEARTBEAT_TIMEOUT);
                send_timed(WatchdogMessage::KeyDown(a));
                for _ in 0..6 {
                    std::thread::sleep(Duration::from_millis(50));
                    send_timed(WatchdogMessage::Heartbeat);
                }
                times
            });
            assert_eq!(client.wait_for_loss(), ClientLoss::Hung);
            let loss = Instant::now();
            let times = sender.join().unwrap().into_iter();
            times
                .filter(|time| *time < loss)
                .chain([loss])
                .collect::<Vec<_>>()
        });
        assert!(client.signs.record.lock().pressed.contains(a));
        // No key is pressed between the second and the third message.
        let mut gaps = times.windows(2).enumerate();
        let is_loss = |(index, gap): (usize, &[Instant])| {
            index != 1 && gap[1] - gap[0] >= HEARTBEAT_TIMEOUT - MIN_READ_TIMEOUT
        };
        assert!(gaps.any(is_loss), "{times:?}");
    }

    #[test]
    fn a_message_that_arrives_in_parts_is_decoded() {
        let (socket, mut client) = client();
        let bytes = WatchdogMessage::KeyDown(key("A")).to_bytes();
        std::thread::scope(|scope| {
            scope.spawn(move || {
                for byte in bytes {
                    (&socket).write_all(&[byte]).unwrap();
                    std::thread::sleep(Duration::from_millis(5));
                }
            });
            assert_eq!(client.wait_for_loss(), ClientLoss::Exited);
        });
        assert!(client.signs.record.lock().pressed.contains(key("A")));
    }
}
