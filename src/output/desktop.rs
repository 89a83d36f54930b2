//! Keys, characters and a pointer for the desktop that the user sits at.
//!
//! A connection to a display can be slow or hang, so it lives on a thread of its own; the loop only
//! puts orders into a queue. On X11 a key outlives whoever pressed it: the server keeps it down until
//! somebody lets go of it. So the thread lets go of everything when its queue is closed, however that
//! comes about: [`close`](Sink::close), a drop, or a panic of the loop.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, TrySendError, bounded};

use super::pending_motion::{PendingMotion, StatelessAction};
use super::pressed_keys::PressedKeys;
use super::watchdog::{WatchdogClient, WatchdogSettings};
use super::worker::{Injector, Worker, WorkerRequest, WorkerStatus};
use super::{OutputError, OutputKind, Sink, platform};
use crate::device::{Capabilities, Capability, EventKind, KeyCode, KeyKind, OutputEvent};

const OUTPUT: &str = "desktop";

/// Presses are taken until half of it is full, motion until three quarters are. The last quarter is
/// more than there are keys, so that a release always finds room: no more are down than there are.
const QUEUE: usize = 4 * PressedKeys::CAPACITY;

const ROOM_FOR_PRESSES: usize = QUEUE / 2;

/// All that a [`Motion`] gives at once still leaves room for every release.
const ROOM_FOR_MOTION: usize = QUEUE - PressedKeys::CAPACITY - 3;

/// How long a display may take to answer before it counts as not there.
const CONNECT_LIMIT: Duration = Duration::from_secs(5);

/// How long [`Desktop::close`](Sink::close) waits.
const CLOSE_LIMIT: Duration = Duration::from_secs(1);

/// An output that presses keys and buttons, writes characters and moves the pointer on the desktop.
///
/// While more than half of the queue is full, presses and characters are refused and
/// [counted](Sink::refused_presses); the release of a refused press is ignored, no other ever is. While
/// three quarters are full, motion waits: places supersede each other, ways and turns of the wheel add
/// up ([counted](Sink::superseded_motions)), and all go out before the next press, so that a click lands
/// where it is meant to. The wheel turns in whole clicks, a rest is kept.
pub struct Desktop {
    orders: Option<Sender<WorkerRequest>>,
    accepted: PressedKeys,
    refused: u64,
    motion: PendingMotion,
    superseded: u64,
    report: Arc<WorkerStatus>,
    thread: Option<JoinHandle<()>>,
    ended: Receiver<()>,
}

impl Desktop {
    /// Connects to `display`: an X server, which has a colon in its name (`:0`), or a Wayland compositor, which has
    /// none (`wayland-1`, or the path of its socket). Without one, to the desktop of the session: the
    /// compositor that `WAYLAND_DISPLAY` names and nobody else; where it is not set, the X server of `DISPLAY`.
    ///
    /// A compositor has to have what is needed; an X server has everything. Where the system has neither,
    /// the name changes nothing.
    pub fn open(display: Option<&str>, needs: &Capabilities) -> Result<Self, OutputError> {
        let display = display.map(str::to_owned);
        let needs_pointer = needs.iter().any(is_of_a_pointer);
        Self::start(None, move || {
            platform::open(display.as_deref(), needs_pointer)
        })
    }

    /// Connects to the desktop of the session, with a guardian that lets go of keys when this program cannot.
    pub fn open_with_watchdog(
        launch: &WatchdogSettings,
        needs: &Capabilities,
    ) -> Result<Self, OutputError> {
        let needs_pointer = needs.iter().any(is_of_a_pointer);
        Self::start(Some(launch), move || platform::open(None, needs_pointer))
    }

    /// Runs the thread and waits until it is connected.
    fn start<C: Injector>(
        launch: Option<&WatchdogSettings>,
        mut connect: impl FnMut() -> Result<C, String> + Send + 'static,
    ) -> Result<Self, OutputError> {
        let (orders, queue) = bounded(QUEUE);
        let (ready, readiness) = bounded(1);
        let (end, ended) = bounded::<()>(0);
        let report = Arc::new(WorkerStatus::default());
        let of_thread = Arc::clone(&report);
        let launch = launch.cloned();
        let thread = thread::Builder::new()
            .name("desktop output".into())
            .spawn(move || {
                let _end = end;
                let guarded = |injector: C| {
                    let guard = |launch| WatchdogClient::start(launch, injector.release_target());
                    let guard = launch.as_ref().map(guard).transpose()?;
                    Ok((injector, guard))
                };
                let (injector, guard) = match connect().and_then(guarded) {
                    Ok(guarded) => guarded,
                    Err(reason) => return drop(ready.send(Err(reason))),
                };
                if ready.send(Ok(())).is_ok() {
                    let worker = Worker::new(injector, &of_thread).with_watchdog(guard);
                    worker.run(&queue, connect);
                }
            })
            .map_err(|error| refuse(format!("no thread for it: {error}")))?;
        match readiness.recv_timeout(CONNECT_LIMIT) {
            Ok(Ok(())) => {}
            Ok(Err(reason)) => return Err(refuse(reason)),
            Err(RecvTimeoutError::Timeout) => {
                return Err(refuse("the display does not answer".into()));
            }
            Err(RecvTimeoutError::Disconnected) => {
                return Err(refuse("connecting to the display panicked".into()));
            }
        }
        Ok(Self {
            orders: Some(orders),
            accepted: PressedKeys::default(),
            refused: 0,
            motion: PendingMotion::default(),
            superseded: 0,
            report,
            thread: Some(thread),
            ended,
        })
    }

    fn press(&mut self, key: KeyCode) -> Result<(), OutputError> {
        if !self.has_room_for_a_press()? || !self.accepted.press(key) {
            return Ok(());
        }
        self.move_on()?;
        self.order(WorkerRequest::Press(key))
    }

    fn write(&mut self, character: char) -> Result<(), OutputError> {
        if !self.has_room_for_a_press()? {
            return Ok(());
        }
        self.move_on()?;
        self.order(WorkerRequest::Perform(StatelessAction::Write(character)))
    }

    /// Whether a press may be ordered; one that may not is counted.
    fn has_room_for_a_press(&mut self) -> Result<bool, OutputError> {
        let has_room = self.waiting()? < ROOM_FOR_PRESSES;
        self.refused += u64::from(!has_room);
        Ok(has_room)
    }

    fn release(&mut self, key: KeyCode) -> Result<(), OutputError> {
        if !self.accepted.release(key) {
            return Ok(());
        }
        let moved = self.move_on();
        self.order(WorkerRequest::Release(key)).and(moved)
    }

    fn add_motion(&mut self, action: EventKind) -> Result<(), OutputError> {
        self.motion.add(action);
        let has_room = self.waiting()? < ROOM_FOR_MOTION;
        self.superseded += u64::from(!has_room);
        self.move_on()
    }

    /// Orders the motion that waits, if there is room.
    fn move_on(&mut self) -> Result<(), OutputError> {
        if self.waiting()? >= ROOM_FOR_MOTION {
            return Ok(());
        }
        for impulse in self.motion.drain() {
            self.order(WorkerRequest::Perform(impulse))?;
        }
        Ok(())
    }

    /// How many orders have not been followed yet.
    fn waiting(&self) -> Result<usize, OutputError> {
        let orders = self.orders.as_ref();
        orders
            .map(Sender::len)
            .ok_or_else(|| failed("it is closed"))
    }

    fn order(&self, order: WorkerRequest) -> Result<(), OutputError> {
        let Some(orders) = &self.orders else {
            return Err(failed("it is closed"));
        };
        match orders.try_send(order) {
            Ok(()) => Ok(()),
            Err(TrySendError::Full(_)) => Err(failed("its queue is full")),
            Err(TrySendError::Disconnected(_)) => Err(failed("its thread has ended")),
        }
    }

    fn outcome(&self) -> Result<(), OutputError> {
        match (self.report.failure.get(), self.report.stuck_keys.get()) {
            (None, None) => Ok(()),
            (Some(failure), None) => Err(failed(failure)),
            (failure, Some(stuck)) => {
                let failure = failure.map_or("a release failed", String::as_str);
                Err(failed(&format!("{failure}; may still be down: {stuck}")))
            }
        }
    }
}

impl Sink for Desktop {
    fn send(&mut self, events: &[OutputEvent]) -> Result<(), OutputError> {
        self.report.loop_calls.fetch_add(1, Ordering::Relaxed);
        let mut outcome = Ok(());
        for event in events {
            let ordered = match event.kind {
                EventKind::KeyUp(key) => self.release(key),
                _ if self.report.failure.get().is_some() => Ok(()),
                EventKind::KeyDown(key) => self.press(key),
                EventKind::Character(character) => self.write(character),
                EventKind::MoveBy(..) | EventKind::MoveTo(..) | EventKind::Scroll(..) => {
                    self.add_motion(event.kind)
                }
                _ => Ok(()),
            };
            outcome = outcome.and(ordered);
        }
        outcome.and(self.outcome())
    }

    fn kind(&self) -> OutputKind {
        OutputKind::Desktop
    }

    fn close(&mut self) -> Result<(), OutputError> {
        self.orders = None;
        self.motion = PendingMotion::default();
        if self.ended.recv_timeout(CLOSE_LIMIT) == Err(RecvTimeoutError::Timeout) {
            return Err(failed(
                "it did not take everything within a second; keys may still be down",
            ));
        }
        if let Some(thread) = self.thread.take()
            && thread.join().is_err()
        {
            return Err(failed("its thread panicked; keys may still be down"));
        }
        self.outcome()
    }

    fn dropped_presses(&self) -> u64 {
        self.refused
    }

    fn coalesced_motions(&self) -> u64 {
        self.superseded
    }
}

impl Drop for Desktop {
    fn drop(&mut self) {
        let _ = self.close();
    }
}

/// Whether it takes a pointer to do this.
fn is_of_a_pointer(need: Capability) -> bool {
    match need {
        Capability::RelativeMotion | Capability::AbsoluteMotion | Capability::Scroll => true,
        Capability::Key(key) => key.kind() == KeyKind::Mouse,
        _ => false,
    }
}

fn refuse(reason: String) -> OutputError {
    OutputError::Open {
        output: OUTPUT.into(),
        reason,
    }
}

fn failed(reason: &str) -> OutputError {
    OutputError::Send {
        output: OUTPUT.into(),
        reason: reason.into(),
    }
}

#[cfg(test)]
mod tests;
