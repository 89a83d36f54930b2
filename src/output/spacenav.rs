//! A 6-DoF mouse for CAD and 3D programs: a server that speaks the spacenav protocol.
//!
//! Programs that know spacenavd or libspnav find it where the environment variable `SPNAV_SOCKET` says.
//! Nothing here needs a driver, a daemon or a special right: the socket is the user's own.
//!
//! Clients may be slow or hang, so they live on a thread of their own; the loop only puts orders into a
//! queue and rings a bell. However the queue is closed, the thread then tells all clients that every axis
//! is at rest and every button up.

mod client;
mod protocol;
mod server;

use std::io::{self, Write};
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, TrySendError, bounded};

use self::server::Server;
use super::reach::SPACENAV_BUTTONS;
use super::socket::{Listener, SocketError, default_path};
use super::{OutputError, OutputKind, Sink};
use crate::device::{Axis, EventKind, KeyCode, OutputEvent};
use crate::time::Timestamp;

const OUTPUT: &str = "spacenav";

/// What an axis at its end says: the range of a SpaceMouse.
const FULL: f32 = 350.0;

/// The axes in the order of the protocol: right, up and away from the wearer, then the turns about them
/// (`spnav_posrot_moveobj` in libspnav `src/util.c`).
const AXES: [Axis; 6] = [
    Axis::MoveX,
    Axis::MoveZ,
    Axis::MoveY,
    Axis::TurnX,
    Axis::TurnZ,
    Axis::TurnY,
];

/// How many buttons there are.
const BUTTONS: usize = SPACENAV_BUTTONS.len();

const QUEUE: usize = 64;

/// Presses are taken until half of the queue is full.
const ROOM_FOR_PRESSES: usize = QUEUE / 2;

/// Motion leaves room for what is never refused: a release of every button, and one rest of all axes, after
/// which there is nothing to rest.
const ROOM_FOR_MOTION: usize = QUEUE - BUTTONS - 1;

/// How long [`Spacenav::close`](Sink::close) waits.
const CLOSE_LIMIT: Duration = Duration::from_secs(1);

/// Where the axes stand, in the order and units of the protocol.
type Axes = [i32; 6];

const REST: Axes = [0; 6];

/// What the loop wants to be told to clients.
#[derive(Clone, Copy, Debug, PartialEq)]
enum ServerMessage {
    Move(Axes, Timestamp),
    Press(usize),
    Release(usize),
}

/// An output that is a 6-DoF mouse with four buttons, for up to 16 programs at once.
///
/// A frame in which an axis changes is one motion with all six, −350..=350 each. While the queue is nearly
/// full, the latest motion waits for the next frame ([counted](Sink::superseded_motions)), but a return to
/// rest never does; while it is half full, presses are refused and [counted](Sink::refused_presses). The
/// release of a press that was taken always finds room.
///
/// A client that takes nothing for a second is cut off; no other notices.
pub struct Spacenav {
    orders: Option<Sender<ServerMessage>>,
    bell: Option<UnixStream>,
    axes: Axes,
    ordered: Axes,
    time: Timestamp,
    is_down: [bool; BUTTONS],
    refused: u64,
    superseded: u64,
    thread: Option<JoinHandle<()>>,
    ended: Receiver<()>,
    path: PathBuf,
}

impl Spacenav {
    /// Listens at `path`, or without one at `ademan/spnav.sock` in `$XDG_RUNTIME_DIR`, and says where.
    ///
    /// The socket is its owner's alone. One that a dead owner has left is taken over, one that is in use is
    /// refused, as is a path longer than 107 bytes.
    pub fn open(path: Option<&Path>) -> Result<Self, OutputError> {
        let path = match path {
            None => default_path("spnav.sock")
                .ok_or_else(|| refuse("XDG_RUNTIME_DIR names no folder"))?,
            Some(path) => std::path::absolute(path).map_err(refuse)?,
        };
        let cannot =
            |error: SocketError| refuse(format!("cannot listen at {}: {error}", path.display()));
        let listener = Listener::open(&path).map_err(cannot)?;
        let spacenav = Self::start(listener, path).map_err(refuse)?;
        tracing::info!(
            "a 6-DoF mouse is at hand for programs started with SPNAV_SOCKET={}",
            spacenav.path.display()
        );
        Ok(spacenav)
    }

    /// Where clients find it.
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn start(listener: Listener, path: PathBuf) -> io::Result<Self> {
        let (orders, queue) = bounded(QUEUE);
        let (end, ended) = bounded::<()>(0);
        let (bell, heard) = UnixStream::pair()?;
        bell.set_nonblocking(true)?;
        let server = Server::new(listener, heard, queue)?;
        let work = move || {
            let _end = end;
            server.work();
        };
        let thread = thread::Builder::new()
            .name("spacenav output".into())
            .spawn(work)?;
        let mut spacenav = Self::ordering(orders, bell, ended);
        spacenav.thread = Some(thread);
        spacenav.path = path;
        Ok(spacenav)
    }

    fn ordering(orders: Sender<ServerMessage>, bell: UnixStream, ended: Receiver<()>) -> Self {
        Self {
            orders: Some(orders),
            bell: Some(bell),
            axes: REST,
            ordered: REST,
            time: Timestamp(0),
            is_down: [false; BUTTONS],
            refused: 0,
            superseded: 0,
            thread: None,
            ended,
            path: PathBuf::new(),
        }
    }

    fn press(&mut self, code: KeyCode) -> Result<(), OutputError> {
        let Some(button) = button_of(code).filter(|button| !self.is_down[*button]) else {
            return Ok(());
        };
        if self.waiting()? >= ROOM_FOR_PRESSES {
            self.refused += 1;
            return Ok(());
        }
        self.is_down[button] = true;
        self.order(ServerMessage::Press(button))
    }

    fn release(&mut self, code: KeyCode) -> Result<(), OutputError> {
        let Some(button) = button_of(code).filter(|button| self.is_down[*button]) else {
            return Ok(());
        };
        self.is_down[button] = false;
        self.order(ServerMessage::Release(button))
    }

    fn turn(&mut self, axis: Axis, value: f32) {
        if let Some(place) = AXES.iter().position(|known| *known == axis) {
            self.axes[place] = (value.clamp(-1.0, 1.0) * FULL).round() as i32;
        }
    }

    /// Orders the motion that waits, if there is any, and room for it.
    fn move_on(&mut self) -> Result<(), OutputError> {
        if self.axes == self.ordered {
            return Ok(());
        }
        if self.waiting()? >= ROOM_FOR_MOTION && self.axes != REST {
            self.superseded += 1;
            return Ok(());
        }
        self.ordered = self.axes;
        self.order(ServerMessage::Move(self.axes, self.time))
    }

    /// How many orders have not been taken yet.
    fn waiting(&self) -> Result<usize, OutputError> {
        let orders = self.orders.as_ref();
        orders
            .map(Sender::len)
            .ok_or_else(|| failed("it is closed"))
    }

    fn order(&self, order: ServerMessage) -> Result<(), OutputError> {
        let (Some(orders), Some(mut bell)) = (&self.orders, self.bell.as_ref()) else {
            return Err(failed("it is closed"));
        };
        match orders.try_send(order) {
            Ok(()) => {
                // A bell that takes no more has been rung often enough.
                let _ = bell.write(&[1]);
                Ok(())
            }
            Err(TrySendError::Full(_)) => Err(failed("its queue is full")),
            Err(TrySendError::Disconnected(_)) => Err(failed("its thread has ended")),
        }
    }
}

impl Sink for Spacenav {
    fn send(&mut self, events: &[OutputEvent]) -> Result<(), OutputError> {
        let mut outcome = Ok(());
        for event in events {
            self.time = event.time;
            let ordered = match event.kind {
                EventKind::Axis(axis, value) => {
                    self.turn(axis, value);
                    Ok(())
                }
                EventKind::KeyDown(code) => self.press(code),
                EventKind::KeyUp(code) => self.release(code),
                _ => Ok(()),
            };
            outcome = outcome.and(ordered);
        }
        outcome.and(self.move_on())
    }

    fn kind(&self) -> OutputKind {
        OutputKind::Spacenav
    }

    fn close(&mut self) -> Result<(), OutputError> {
        self.orders = None;
        self.bell = None;
        if self.ended.recv_timeout(CLOSE_LIMIT) == Err(RecvTimeoutError::Timeout) {
            return Err(failed("it did not end within a second"));
        }
        match self.thread.take().map(JoinHandle::join) {
            Some(Err(_)) => Err(failed("its thread panicked")),
            _ => Ok(()),
        }
    }

    fn dropped_presses(&self) -> u64 {
        self.refused
    }

    fn coalesced_motions(&self) -> u64 {
        self.superseded
    }
}

impl Drop for Spacenav {
    fn drop(&mut self) {
        let _ = self.close();
    }
}

fn button_of(code: KeyCode) -> Option<usize> {
    SPACENAV_BUTTONS
        .iter()
        .position(|name| *name == code.name())
}

fn refuse(reason: impl ToString) -> OutputError {
    OutputError::Open {
        output: OUTPUT.into(),
        reason: format!("{}; name another path: spacenav:PATH", reason.to_string()),
    }
}

fn failed(reason: &str) -> OutputError {
    OutputError::Send {
        output: OUTPUT.into(),
        reason: reason.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::tests::{down, event, up};

    /// A sink to which nobody listens.
    fn unheard() -> (Spacenav, Receiver<ServerMessage>, UnixStream) {
        let (orders, queue) = bounded(QUEUE);
        let (bell, heard) = UnixStream::pair().unwrap();
        bell.set_nonblocking(true).unwrap();
        let (_, ended) = bounded(0);
        (Spacenav::ordering(orders, bell, ended), queue, heard)
    }

    fn lift(micros: u64, value: f32) -> OutputEvent {
        event(micros, EventKind::Axis(Axis::MoveZ, value))
    }

    #[test]
    fn a_frame_is_one_motion_and_nothing_where_no_axis_changed() {
        let (mut sink, queue, _heard) = unheard();
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
            ServerMessage::Move(REST, Timestamp(9)),
        ];
        assert_eq!(queue.try_iter().collect::<Vec<_>>(), expected);
    }

    #[test]
    fn when_nobody_takes_orders_the_latest_motion_waits_and_rest_and_releases_still_go_out() {
        let (mut sink, queue, _heard) = unheard();
        let buttons = SPACENAV_BUTTONS;
        let presses = buttons.map(|name| down(1, name));
        sink.send(&presses).unwrap();
        for step in 1..=100 {
            sink.send(&[lift(2, step as f32 / 100.0)]).unwrap();
        }
        assert_eq!(queue.len(), ROOM_FOR_MOTION);
        assert_eq!(sink.coalesced_motions(), 4 + 100 - ROOM_FOR_MOTION as u64);
        sink.send(&[lift(3, 0.0)]).unwrap();
        sink.send(&[lift(4, 0.3)]).unwrap();
        sink.send(&[lift(5, 0.0)]).unwrap();
        sink.send(&buttons.map(|name| up(6, name))).unwrap();
        sink.send(&[down(7, "PadEast"), up(8, "PadEast")]).unwrap();
        assert_eq!(sink.dropped_presses(), 1);

        let orders: Vec<_> = queue.try_iter().collect();
        let expected = [
            ServerMessage::Move(REST, Timestamp(3)),
            ServerMessage::Release(0),
            ServerMessage::Release(1),
            ServerMessage::Release(2),
            ServerMessage::Release(3),
        ];
        assert!(orders.ends_with(&expected), "{orders:?}");
        sink.send(&[lift(9, 0.4)]).unwrap();
        sink.send(&[]).unwrap();
        assert_eq!(queue.len(), 1, "there is room again");
    }

    #[test]
    fn motion_that_waited_goes_out_with_the_next_frame_that_finds_room() {
        let (mut sink, queue, _heard) = unheard();
        for step in 1..=100 {
            sink.send(&[lift(2, step as f32 / 100.0)]).unwrap();
        }
        let _: Vec<_> = queue.try_iter().collect();
        sink.send(&[]).unwrap();
        let latest = ServerMessage::Move([0, 350, 0, 0, 0, 0], Timestamp(2));
        assert_eq!(queue.try_iter().collect::<Vec<_>>(), [latest]);
    }

    #[test]
    fn every_button_has_a_code() {
        for (number, name) in SPACENAV_BUTTONS.iter().enumerate() {
            assert_eq!(button_of(name.parse().unwrap()), Some(number));
        }
    }
}
