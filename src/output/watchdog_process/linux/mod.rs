//! The watchdog's main loop: receives messages, and releases keys when the client is lost.

mod releaser;

use std::io::{ErrorKind, Read, Write};
use std::os::unix::net::UnixStream;
use std::time::{Duration, Instant};

use crate::device::pressed_keys::PressedKeys;
use crate::output::desktop::worker::{Worker, WorkerStatus};
use crate::output::watchdog::{HEARTBEAT_TIMEOUT, READY, ReleaseTarget, WatchdogMessage};
use releaser::KeyReleaser;

/// Shortest time-out of a read, so that messages that have already arrived are read before the client counts as hung.
const MIN_READ_TIMEOUT: Duration = Duration::from_millis(1);

/// Runs the watchdog: receives messages on the standard input, a Unix socket, and releases the keys of the client if it
/// exits or hangs. Returns when the client has exited.
///
/// `log` receives messages for the user; they do not contain the names of keys.
pub fn run(log: impl Fn(&str)) -> Result<(), String> {
    let stdin = rustix::stdio::stdin().try_clone_to_owned();
    let mut socket = UnixStream::from(stdin.map_err(|error| error.to_string())?);
    if socket.peer_addr().is_err() {
        return Err("the watchdog is started by `ademan` itself, not by hand".into());
    }
    let target = ReleaseTarget::receive(&socket)
        .map_err(|error| format!("no handle to release keys with: {error}"))?;
    let connect = || KeyReleaser::connect(&target);
    let releaser = match connect() {
        Ok(releaser) => releaser,
        Err(reason) => {
            let _ = socket.write_all(reason.as_bytes());
            return Err(reason);
        }
    };
    let status = WorkerStatus::new(Duration::MAX);
    let mut worker = Worker::new(releaser, &status);
    socket
        .write_all(&[READY])
        .map_err(|error| error.to_string())?;
    let mut client = ClientState::new(socket);
    loop {
        let loss = client.wait_for_loss();
        let count = client.pressed.count();
        worker.pressed = std::mem::take(&mut client.pressed);
        worker.finish(connect);
        if std::mem::take(&mut client.are_axes_deflected) {
            worker.injector.center_axes();
        }
        match (loss, count) {
            (ClientLoss::Exited, 0) => return Ok(()),
            (ClientLoss::Exited, _) => {
                log(&format!("the program exited; released its keys ({count})"));
                return Ok(());
            }
            (ClientLoss::Hung, _) => {
                log(&format!(
                    "the program does not respond; released its keys ({count})"
                ));
            }
        }
    }
}

/// The loss of the client.
#[derive(Clone, Copy, Debug, PartialEq)]
enum ClientLoss {
    /// The process has exited, or closed its socket.
    Exited,
    /// It has sent no message for [`HEARTBEAT_TIMEOUT`] while a key is pressed.
    Hung,
}

/// The state of the client, as reported by its messages.
struct ClientState {
    socket: UnixStream,
    pressed: PressedKeys,
    are_axes_deflected: bool,
    last_message: Instant,
    /// The bytes of an incomplete message.
    incomplete: Vec<u8>,
}

impl ClientState {
    fn new(socket: UnixStream) -> Self {
        Self {
            socket,
            pressed: PressedKeys::default(),
            are_axes_deflected: false,
            last_message: Instant::now(),
            incomplete: Vec::new(),
        }
    }

    /// Receives messages until the client is lost.
    fn wait_for_loss(&mut self) -> ClientLoss {
        loop {
            let remaining = HEARTBEAT_TIMEOUT.saturating_sub(self.last_message.elapsed());
            let is_idle = self.pressed.is_empty() && !self.are_axes_deflected;
            // The system may have delayed this process and not the client, so the time-out is never zero.
            let timeout = (!is_idle).then_some(remaining.max(MIN_READ_TIMEOUT));
            if self.socket.set_read_timeout(timeout).is_err() {
                return ClientLoss::Exited;
            }
            let mut bytes = [0; 64 * WatchdogMessage::BYTES];
            match self.socket.read(&mut bytes) {
                Ok(0) => return ClientLoss::Exited,
                Ok(count) => {
                    self.last_message = Instant::now();
                    self.decode(&bytes[..count]);
                }
                Err(error) => match error.kind() {
                    ErrorKind::Interrupted => {}
                    ErrorKind::WouldBlock | ErrorKind::TimedOut => return ClientLoss::Hung,
                    _ => return ClientLoss::Exited,
                },
            }
        }
    }

    fn decode(&mut self, bytes: &[u8]) {
        self.incomplete.extend(bytes);
        let complete = self.incomplete.len() - self.incomplete.len() % WatchdogMessage::BYTES;
        for bytes in self.incomplete[..complete].as_chunks().0 {
            match WatchdogMessage::from_bytes(*bytes) {
                Some(WatchdogMessage::KeyDown(key)) => _ = self.pressed.press(key),
                Some(WatchdogMessage::KeyUp(key)) => _ = self.pressed.release(key),
                Some(WatchdogMessage::AxesDeflected) => self.are_axes_deflected = true,
                Some(WatchdogMessage::AxesCentered) => self.are_axes_deflected = false,
                Some(WatchdogMessage::Heartbeat) | None => {}
            }
        }
        self.incomplete.drain(..complete);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::tests::key;

    fn client() -> (UnixStream, ClientState) {
        let (socket, watchdog) = UnixStream::pair().unwrap();
        (socket, ClientState::new(watchdog))
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
        assert_eq!(client.pressed.release_order().collect::<Vec<_>>(), [shift]);
    }

    #[test]
    fn a_deflected_axis_counts_as_a_pressed_key() {
        let (socket, mut client) = client();
        send(&socket, &[WatchdogMessage::AxesDeflected]);
        assert_eq!(client.wait_for_loss(), ClientLoss::Hung);
        assert!(client.are_axes_deflected);
        send(&socket, &[WatchdogMessage::AxesCentered]);
        drop(socket);
        assert_eq!(client.wait_for_loss(), ClientLoss::Exited);
        assert!(!client.are_axes_deflected);
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
        assert!(client.pressed.contains(a));
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
        assert!(client.pressed.contains(key("A")));
    }
}
