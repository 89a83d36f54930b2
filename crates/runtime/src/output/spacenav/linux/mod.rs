//! The 6-DoF mouse: a server that speaks the spacenav protocol.
//!
//! Programs that use spacenavd or libspnav connect to the socket in the environment variable `SPNAV_SOCKET`. The server
//! needs neither a driver nor a daemon nor permissions: the socket belongs to the user.
//!
//! Clients may be slow or hang, so the server has a thread of its own; the loop only puts messages into a queue and
//! wakes the thread. When the queue is closed for any reason, the thread centers all axes and releases all buttons for
//! every client.

mod client;
mod protocol;
mod server;

use std::io::{self, Write};
use std::os::unix::fs::FileTypeExt;
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, TrySendError, bounded};

use super::{BACKEND, BUTTONS, capabilities};
use crate::output::socket::{Listener, SocketError, check_path, connect_to_any, default_path};
use crate::output::{OpenRequest, OutputError, Sink};
use ademan_core::device::{Axis, Capabilities, EventKind, KeyCode, OutputEvent};
use ademan_core::message::{escape_path, shell_word};
use ademan_core::time::Timestamp;
use server::Server;

/// Value of a fully deflected axis, as a SpaceMouse reports it.
const AXIS_MAX: f32 = 350.0;

/// The axes in the order of the protocol: motion to the right, up and away from the wearer, then rotation about these
/// directions (`spnav_posrot_moveobj` in libspnav `src/util.c`).
const AXES: [Axis; 6] = [
    Axis::MoveX,
    Axis::MoveZ,
    Axis::MoveY,
    Axis::TurnX,
    Axis::TurnZ,
    Axis::TurnY,
];

/// Name of the socket in the runtime folder.
const SOCKET: &str = "spnav.sock";

/// Number of buttons.
const BUTTON_COUNT: usize = BUTTONS.len();

/// Capacity of the queue.
const QUEUE: usize = 64;

/// Presses are accepted until the queue is half full.
const PRESS_LIMIT: usize = QUEUE / 2;

/// Motion leaves room for what is never dropped: a release of every button, and one centering of all axes.
const MOTION_LIMIT: usize = QUEUE - BUTTON_COUNT - 1;

/// Longest time that [`Spacenav::close`](Sink::close) waits.
const CLOSE_TIMEOUT: Duration = Duration::from_secs(1);

/// Time after which motion is repeated while an axis is deflected. A SpaceMouse sends motion all the time, and programs move
/// their view by one step per event.
const REPEAT_PERIOD: Duration = Duration::from_millis(16);

/// Axis positions in the order and range of the protocol.
type Axes = [i32; 6];

const CENTERED: Axes = [0; 6];

/// A message from the loop to the server.
#[derive(Clone, Copy, Debug, PartialEq)]
enum ServerMessage {
    Move(Axes, Timestamp),
    Press(usize),
    Release(usize),
}

/// A sink that is a 6-DoF mouse with four buttons for up to 16 programs at once.
///
/// A step in which an axis changes is one motion with all six axes, −350..=350 each. While an axis is deflected, the motion is
/// repeated every 16 ms, as long as the loop calls the sink. While the queue is nearly full,
/// the latest motion waits for the next step ([counted](Sink::coalesced_motions)), but the centering of all axes does
/// not. While the queue is half full, presses are dropped and [counted](Sink::dropped_presses). The release of a button
/// is never dropped.
///
/// A client that reads nothing for 1 s is disconnected without an effect on the others.
pub struct Spacenav {
    messages: Option<Sender<ServerMessage>>,
    /// A byte on it wakes the server.
    waker: Option<UnixStream>,
    axes: Axes,
    sent_axes: Axes,
    sent_at: Instant,
    repeat_period: Duration,
    time: Timestamp,
    is_pressed: [bool; BUTTON_COUNT],
    dropped_presses: u64,
    has_stalled: bool,
    coalesced_motions: u64,
    thread: Option<JoinHandle<()>>,
    thread_ended: Receiver<()>,
}

impl Spacenav {
    /// Listens at `path`, by default `ademan/spnav.sock` in `$XDG_RUNTIME_DIR`, and logs the path.
    ///
    /// Only the owner may connect. A socket left behind by a dead server is replaced; a socket in use and a path longer
    /// than 107 bytes are errors.
    pub fn open(path: Option<&Path>) -> Result<Self, OutputError> {
        let path = socket_path(path).map_err(open_error)?;
        let listener = Listener::open(&path).map_err(|error: SocketError| {
            open_error(format!("cannot listen on {}: {error}", escape_path(&path)))
        })?;
        let spacenav = Self::start(listener).map_err(open_error)?;
        tracing::info!(
            "6-DoF mouse for programs started with SPNAV_SOCKET={}",
            shell_word(&path.to_string_lossy())
        );
        Ok(spacenav)
    }

    fn start(listener: Listener) -> io::Result<Self> {
        let (messages, queue) = bounded(QUEUE);
        let (end, thread_ended) = bounded::<()>(0);
        let (waker, wake_ups) = UnixStream::pair()?;
        waker.set_nonblocking(true)?;
        let server = Server::new(listener, wake_ups, queue)?;
        let run = move || {
            let _end = end;
            server.run();
        };
        let thread = thread::Builder::new()
            .name("spacenav output".into())
            .spawn(run)?;
        let mut spacenav = Self::with_channels(messages, waker, thread_ended);
        spacenav.thread = Some(thread);
        Ok(spacenav)
    }

    fn with_channels(
        messages: Sender<ServerMessage>,
        waker: UnixStream,
        thread_ended: Receiver<()>,
    ) -> Self {
        Self {
            messages: Some(messages),
            waker: Some(waker),
            axes: CENTERED,
            sent_axes: CENTERED,
            sent_at: Instant::now(),
            repeat_period: REPEAT_PERIOD,
            time: Timestamp(0),
            is_pressed: [false; BUTTON_COUNT],
            dropped_presses: 0,
            has_stalled: false,
            coalesced_motions: 0,
            thread: None,
            thread_ended,
        }
    }

    fn press(&mut self, key: KeyCode) -> Result<(), OutputError> {
        let Some(button) = button_number(key).filter(|button| !self.is_pressed[*button]) else {
            return Ok(());
        };
        self.has_stalled |= self.queue_length()? >= PRESS_LIMIT;
        if self.has_stalled {
            self.dropped_presses += 1;
            return Ok(());
        }
        self.is_pressed[button] = true;
        self.send_message(ServerMessage::Press(button))
    }

    fn release(&mut self, key: KeyCode) -> Result<(), OutputError> {
        let Some(button) = button_number(key).filter(|button| self.is_pressed[*button]) else {
            return Ok(());
        };
        self.is_pressed[button] = false;
        self.send_message(ServerMessage::Release(button))
    }

    fn set_axis(&mut self, axis: Axis, value: f32) {
        if let Some(index) = AXES.iter().position(|known| *known == axis) {
            self.axes[index] = (value.clamp(-1.0, 1.0) * AXIS_MAX).round() as i32;
        }
    }

    /// Sends the axes if they have changed or a repetition is due, and the queue has room.
    fn send_motion(&mut self) -> Result<(), OutputError> {
        let since_sent = self.sent_at.elapsed();
        if self.axes == self.sent_axes {
            if self.axes == CENTERED || since_sent < self.repeat_period {
                return Ok(());
            }
            self.time = self.time + since_sent;
        }
        if self.queue_length()? >= MOTION_LIMIT && self.axes != CENTERED {
            self.coalesced_motions += 1;
            return Ok(());
        }
        self.sent_axes = self.axes;
        self.sent_at = Instant::now();
        self.send_message(ServerMessage::Move(self.axes, self.time))
    }

    fn queue_length(&self) -> Result<usize, OutputError> {
        let messages = self.messages.as_ref();
        messages
            .map(Sender::len)
            .ok_or_else(|| send_error("it is closed"))
    }

    fn send_message(&self, message: ServerMessage) -> Result<(), OutputError> {
        let (Some(messages), Some(mut waker)) = (&self.messages, self.waker.as_ref()) else {
            return Err(send_error("it is closed"));
        };
        match messages.try_send(message) {
            Ok(()) => {
                // A full waker has bytes that will wake the server.
                let _ = waker.write(&[1]);
                Ok(())
            }
            Err(TrySendError::Full(_)) => Err(send_error("its queue is full")),
            Err(TrySendError::Disconnected(_)) => Err(send_error("its thread has ended")),
        }
    }
}

impl Sink for Spacenav {
    fn send(&mut self, events: &[OutputEvent]) -> Result<(), OutputError> {
        let mut result = Ok(());
        for event in events {
            self.time = event.time;
            let sent = match event.kind {
                EventKind::Axis(axis, value) => {
                    self.set_axis(axis, value);
                    Ok(())
                }
                EventKind::KeyDown(key) => self.press(key),
                EventKind::KeyUp(key) => self.release(key),
                _ => Ok(()),
            };
            result = result.and(sent);
        }
        result.and(self.send_motion())
    }

    fn capabilities(&self) -> Capabilities {
        capabilities()
    }

    fn void_presses(&mut self) {
        self.has_stalled = false;
    }

    fn has_stalled(&self) -> bool {
        self.has_stalled
    }

    fn close(&mut self) -> Result<(), OutputError> {
        self.messages = None;
        self.waker = None;
        if self.thread_ended.recv_timeout(CLOSE_TIMEOUT) == Err(RecvTimeoutError::Timeout) {
            return Err(send_error("it did not end within 1 s"));
        }
        match self.thread.take().map(JoinHandle::join) {
            Some(Err(_)) => Err(send_error("its thread panicked")),
            _ => Ok(()),
        }
    }

    fn dropped_presses(&self) -> u64 {
        self.dropped_presses
    }

    fn coalesced_motions(&self) -> u64 {
        self.coalesced_motions
    }
}

impl Drop for Spacenav {
    fn drop(&mut self) {
        let _ = self.close();
    }
}

/// Opens the output.
pub fn open(request: &OpenRequest) -> Result<Box<dyn Sink>, OutputError> {
    let path = request.argument.map(Path::new);
    Ok(Box::new(Spacenav::open(path)?))
}

fn button_number(key: KeyCode) -> Option<usize> {
    BUTTONS.iter().position(|name| *name == key.name())
}

/// Checks that a server can listen on the path in the argument, or on the default one, as far as that shows without listening. An error
/// states the cause and the remedy.
pub fn check_presence(argument: Option<&str>) -> Result<(), String> {
    let path = socket_path(argument.map(Path::new)).map_err(with_remedy)?;
    // The folder of the default path is created with the socket.
    let has_folder = argument.is_none() || path.parent().is_some_and(Path::is_dir);
    let is_other = |file: std::fs::Metadata| !file.file_type().is_socket();
    let reason = match check_path(&path) {
        Err(error) => error.to_string(),
        Ok(()) if !has_folder => "there is no such folder".to_owned(),
        Ok(()) if path.symlink_metadata().is_ok_and(is_other) => {
            "the file there is not a socket".to_owned()
        }
        Ok(()) if connect_to_any(&path).is_ok() => SocketError::InUse.to_string(),
        Ok(()) => return Ok(()),
    };
    let path = escape_path(&path);
    Err(with_remedy(format!("cannot listen on {path}: {reason}")))
}

/// Returns the absolute path of the socket, by default in the runtime folder. An error states why there is none.
fn socket_path(path: Option<&Path>) -> Result<PathBuf, String> {
    match path {
        None => default_path(SOCKET).ok_or_else(|| "XDG_RUNTIME_DIR names no folder".to_owned()),
        Some(path) => std::path::absolute(path).map_err(|error| error.to_string()),
    }
}

fn with_remedy(reason: impl ToString) -> String {
    format!("{}; use another path: spacenav:PATH", reason.to_string())
}

fn open_error(reason: impl ToString) -> OutputError {
    OutputError::open(BACKEND.name, with_remedy(reason))
}

fn send_error(reason: &str) -> OutputError {
    OutputError::send(BACKEND.name, reason)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::tests::{down, event, up};

    /// Creates a sink without a server.
    fn without_server() -> (Spacenav, Receiver<ServerMessage>, UnixStream) {
        let (messages, queue) = bounded(QUEUE);
        let (waker, wake_ups) = UnixStream::pair().unwrap();
        waker.set_nonblocking(true).unwrap();
        let (_, thread_ended) = bounded(0);
        let mut spacenav = Spacenav::with_channels(messages, waker, thread_ended);
        spacenav.repeat_period = Duration::MAX;
        (spacenav, queue, wake_ups)
    }

    fn lift(micros: u64, value: f32) -> OutputEvent {
        event(micros, EventKind::Axis(Axis::MoveZ, value))
    }

    #[test]
    fn a_step_is_one_motion_if_an_axis_has_changed() {
        let (mut sink, queue, _wake_ups) = without_server();
        let turn = event(7, EventKind::Axis(Axis::TurnY, -2.0));
        let stick = event(7, EventKind::Axis(Axis::LeftX, 1.0));
        sink.send(&[lift(7, 0.5), turn, stick]).unwrap();
        sink.send(&[lift(8, 0.5004)]).unwrap();
        sink.send(&[
            event(9, EventKind::Axis(Axis::TurnY, f32::NAN)),
            lift(9, -0.0),
        ])
        .unwrap();
        let expected = [
            ServerMessage::Move([0, 175, 0, 0, 0, -350], Timestamp(7)),
            ServerMessage::Move(CENTERED, Timestamp(9)),
        ];
        assert_eq!(queue.try_iter().collect::<Vec<_>>(), expected);
    }

    #[test]
    fn while_the_queue_is_full_motion_waits_but_centering_and_releases_are_sent() {
        let (mut sink, queue, _wake_ups) = without_server();
        let buttons = BUTTONS;
        let presses = buttons.map(|name| down(1, name));
        sink.send(&presses).unwrap();
        for step in 1..=100 {
            sink.send(&[lift(2, step as f32 / 100.0)]).unwrap();
        }
        assert_eq!(queue.len(), MOTION_LIMIT);
        assert_eq!(sink.coalesced_motions(), 4 + 100 - MOTION_LIMIT as u64);
        sink.send(&[lift(3, 0.0)]).unwrap();
        sink.send(&[lift(4, 0.3)]).unwrap();
        sink.send(&[lift(5, 0.0)]).unwrap();
        sink.send(&buttons.map(|name| up(6, name))).unwrap();
        sink.send(&[down(7, "PadEast"), up(8, "PadEast")]).unwrap();
        assert_eq!(sink.dropped_presses(), 1);

        let messages: Vec<_> = queue.try_iter().collect();
        let expected = [
            ServerMessage::Move(CENTERED, Timestamp(3)),
            ServerMessage::Release(0),
            ServerMessage::Release(1),
            ServerMessage::Release(2),
            ServerMessage::Release(3),
        ];
        assert!(messages.ends_with(&expected), "{messages:?}");
        sink.send(&[lift(9, 0.4)]).unwrap();
        sink.send(&[]).unwrap();
        assert_eq!(queue.len(), 1, "there is room again");
    }

    #[test]
    fn waiting_motion_is_sent_with_the_next_step_that_has_room() {
        let (mut sink, queue, _wake_ups) = without_server();
        for step in 1..=100 {
            sink.send(&[lift(2, step as f32 / 100.0)]).unwrap();
        }
        let _: Vec<_> = queue.try_iter().collect();
        sink.send(&[]).unwrap();
        let latest = ServerMessage::Move([0, 350, 0, 0, 0, 0], Timestamp(2));
        assert_eq!(queue.try_iter().collect::<Vec<_>>(), [latest]);
    }

    #[test]
    fn motion_is_repeated_while_an_axis_is_deflected() {
        let (mut sink, queue, _wake_ups) = without_server();
        sink.send(&[lift(2, 1.0)]).unwrap();
        sink.send(&[]).unwrap();
        sink.repeat_period = Duration::ZERO;
        sink.send(&[]).unwrap();
        sink.send(&[lift(3, 0.0)]).unwrap();
        sink.send(&[]).unwrap();
        let axes = queue.try_iter().map(|message| match message {
            ServerMessage::Move(axes, _) => axes,
            other => panic!("{other:?}"),
        });
        let up = [0, 350, 0, 0, 0, 0];
        assert_eq!(axes.collect::<Vec<_>>(), [up, up, CENTERED]);
    }

    #[test]
    fn every_button_has_a_key() {
        for (number, name) in BUTTONS.iter().enumerate() {
            assert_eq!(button_number(name.parse().unwrap()), Some(number));
        }
    }
}
