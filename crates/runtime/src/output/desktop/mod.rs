//! The output `desktop`: keys, characters and a pointer on the desktop of the session.
//!
//! A connection to a display can block, so it has a thread of its own; the loop puts requests into a queue. Where a press
//! can be revoked, the loop writes keys itself (`direct_keys`), and the thread confirms them.
//!
//! An X server keeps a key pressed after its client is gone. The thread therefore releases every key when its queue is
//! closed: by [`close`](Sink::close), by a drop or by a panic of the loop.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, TrySendError, bounded};

use super::watchdog::{OnRelease, WatchdogClient, WatchdogSettings};
use super::{Backend, OpenRequest, OutputError, Sink, TextField};
use crate::advice;
use crate::priority;
use ademan_core::device::pressed_keys::{KeyDirection, PressedKeys};
use ademan_core::device::{Capabilities, Capability, EventKind, KeyCode, KeyKind, OutputEvent};
use burst::Stroke;
pub(super) use connect::connect;
use direct_keys::{DirectAnswers, DirectKeys};
use injector::Injector;
use pending_motion::PendingMotion;
use press_ticket::{MAX_PRESS_AGE, PressTicket};
pub use wayland::SUPPORTS_WAYLAND;
use worker::{Worker, WorkerRequest};
use worker_status::WorkerStatus;

#[cfg(all(feature = "ime", feature = "wayland", target_os = "linux"))]
pub(super) mod composing;
mod burst;
mod check;
mod connect;
mod direct_keys;
#[cfg_attr(
    target_os = "linux",
    allow(dead_code, reason = "compiled on Linux to be checked there")
)]
mod enigo_display;
mod followed_focus;
pub(super) mod injector;
mod key_reporter;
mod loop_monitor;
pub(super) mod pending_motion;
mod press_ticket;
mod system;
mod wayland;
pub(super) mod worker;
mod worker_status;
mod x11;

/// The backend `desktop`.
pub const BACKEND: Backend = Backend {
    name: "desktop",
    argument: None,
    is_argument_required: false,
    summary: "keys, characters and a pointer on the desktop of the session",
    capabilities,
    is_log: false,
    is_fixed_when_open: false,
    check: Some(check::run),
    open,
};

/// Capacity of the queue. Presses are accepted until it is half full, motion until all that remains is needed for
/// releases: the last quarter exceeds the number of keys, so that a release always finds room.
const QUEUE: usize = 4 * PressedKeys::CAPACITY;

/// Length of the queue above which presses are dropped.
const PRESS_LIMIT: usize = QUEUE / 2;

/// Length of the queue from which motion waits. It leaves room for every release and for the requests of one
/// [`PendingMotion::drain`].
const MOTION_LIMIT: usize = QUEUE - PressedKeys::CAPACITY - 3;

/// Longest time in which a display has to answer when the output is opened.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(5);

/// Longest time that [`Desktop::close`](Sink::close) waits.
const CLOSE_TIMEOUT: Duration = Duration::from_secs(1);

/// A sink that presses keys and buttons, types characters and moves the pointer on a desktop.
///
/// Neighboring taps and characters with one time are a burst, which arrives entirely or not at all: a text, a correction. While the
/// queue is more than half full, presses and bursts are dropped and [counted](Sink::dropped_presses), as are those that the display
/// has not executed within 250 ms or that a [call](Sink::void_presses) made void, bursts that the display cannot type now, and
/// bursts that would delete text in a window that got the focus since the last press or, on X11, after a press of another keyboard
/// or mouse, which is noticed once the field was [asked for](Sink::text_field). After
/// a dropped press, and after the watchdog has released keys, the sink [has stalled](Sink::has_stalled). With a watchdog,
/// [`send`](Sink::send) must be called at least every 50 ms while a key is pressed: after some 200 ms without a call the sink
/// releases all keys and has stalled. The release of a
/// dropped press is ignored; no other release is. While the queue is three quarters full, motion is
/// [coalesced](Sink::coalesced_motions): the last position counts, relative motion and scrolls are summed. Scrolls that wait for
/// 250 ms, and all motion that a [call](Sink::void_presses) made void, are lost. Pending motion
/// is sent before the next press, so that a click arrives at its position. The
/// wheel turns by whole detents; the remainder is kept.
pub struct Desktop {
    requests: Option<Sender<WorkerRequest>>,
    /// Number of requests to the thread.
    requested: u64,
    /// Number of requests to the thread, up to the request that confirms the last press of the loop.
    requested_with_direct_press: u64,
    /// `true` if the thread has executed all requests except confirmations of events that the loop has written.
    is_thread_idle: bool,
    /// `true` if the loop has written a release since the last call of [`send`](Sink::send) began.
    has_written_release: bool,
    /// The loop's own connection, if the display supports one.
    direct_keys: Option<DirectKeys>,
    opened_direct_keys: Receiver<DirectKeys>,
    accepted: PressedKeys,
    dropped_presses: u64,
    /// The generation of the tickets of presses. After a stall the tickets have another generation.
    generation: u64,
    /// The generation of the field that the last press or character was for.
    field: u32,
    motion: PendingMotion,
    coalesced_motions: u64,
    status: Arc<WorkerStatus>,
    thread: Option<JoinHandle<()>>,
    thread_ended: Receiver<()>,
}

impl Desktop {
    /// Connects to `display`: an X server, whose name has a colon (`:0`), or a Wayland compositor, whose name has none
    /// (`wayland-1`, or the path of its socket).
    ///
    /// `None` stands for the desktop of the session: the compositor of `WAYLAND_DISPLAY` if that is set, or else the X
    /// server of `DISPLAY`. A compositor must support `required`; an X server supports everything that
    /// [`BACKEND`] does. Windows and macOS ignore the name.
    pub fn open(display: Option<&str>, required: &Capabilities) -> Result<Self, OutputError> {
        Self::open_with_watchdog(display, None, required)
    }

    /// Connects to `display` as [`open`](Self::open) does, and starts the watchdog, if there is one, which releases keys if this process
    /// cannot. The command of the watchdog has to connect to the same display.
    pub fn open_with_watchdog(
        display: Option<&str>,
        watchdog: Option<&WatchdogSettings>,
        required: &Capabilities,
    ) -> Result<Self, OutputError> {
        let display = display.map(str::to_owned);
        let needs_pointer = required.iter().any(needs_pointer);
        Self::start(watchdog, MAX_PRESS_AGE, move || {
            connect(display.as_deref(), needs_pointer)
        })
    }

    /// Starts the thread and waits until it is connected.
    fn start(
        watchdog: Option<&WatchdogSettings>,
        max_press_age: Duration,
        mut connect: impl FnMut() -> Result<Box<dyn Injector>, String> + Send + 'static,
    ) -> Result<Self, OutputError> {
        let (requests, queue) = bounded(QUEUE);
        let (connected, connection) = bounded(1);
        let (end, thread_ended) = bounded::<()>(0);
        let status = Arc::new(WorkerStatus::new(max_press_age));
        let worker_status = Arc::clone(&status);
        let released_status = Arc::clone(&status);
        let on_release: OnRelease = Arc::new(move || _ = released_status.tickets.void());
        let (direct_answers, opened_direct_keys) = DirectAnswers::new();
        let settings = watchdog.cloned();
        let thread = thread::Builder::new()
            .name("desktop output".into())
            .spawn(move || {
                let _end = end;
                let with_watchdog = |injector: Box<dyn Injector>| {
                    let start = |given| {
                        let target = injector.release_target();
                        WatchdogClient::start(given, target, on_release)
                    };
                    let client = settings.as_ref().map(start).transpose()?;
                    Ok((injector, client))
                };
                let (injector, client) = match connect().and_then(with_watchdog) {
                    Ok(opened) => opened,
                    Err(reason) => return drop(connected.send(Err(reason))),
                };
                let worker = Worker::new(injector, client, direct_answers, &worker_status);
                if connected.send(Ok(())).is_ok() {
                    priority::raise_thread_priority();
                    worker.run(&queue, connect);
                }
            })
            .map_err(|error| open_error(advice::no_thread(&error)))?;
        match connection.recv_timeout(CONNECT_TIMEOUT) {
            Ok(Ok(())) => {}
            Ok(Err(reason)) => return Err(open_error(reason)),
            Err(RecvTimeoutError::Timeout) => {
                return Err(open_error("the display does not answer"));
            }
            Err(RecvTimeoutError::Disconnected) => {
                return Err(open_error("connecting to the display panicked"));
            }
        }
        Ok(Self {
            requests: Some(requests),
            requested: 0,
            requested_with_direct_press: 0,
            is_thread_idle: false,
            has_written_release: false,
            direct_keys: None,
            opened_direct_keys,
            accepted: PressedKeys::default(),
            dropped_presses: 0,
            generation: 0,
            field: 0,
            motion: PendingMotion::default(),
            coalesced_motions: 0,
            status,
            thread: Some(thread),
            thread_ended,
        })
    }

    fn press(&mut self, key: KeyCode) -> Result<(), OutputError> {
        if !self.accept_presses(1, 1)? || !self.accepted.press(key) {
            return Ok(());
        }
        self.send_motion()?;
        if key.kind() == KeyKind::Keyboard {
            self.field = self.status.press_in_field();
        }
        let ticket = self.status.tickets.issue(self.generation);
        let direct = self.write_directly(key, KeyDirection::Press, ticket);
        self.request(direct.unwrap_or(WorkerRequest::Press(key, ticket)))
    }

    /// Requests all strokes of a burst, or none.
    fn type_burst(&mut self, burst: &[OutputEvent]) -> Result<(), OutputError> {
        let strokes = || burst.iter().filter_map(Stroke::from_event);
        let presses = strokes().filter(Stroke::is_press).count();
        if !self.accept_presses(burst.len(), presses)? {
            return Ok(());
        }
        self.send_motion()?;
        let ticket = self.status.tickets.issue(self.generation);
        // What it deletes was typed before.
        let current = self.status.field.load(Ordering::Acquire);
        let field = std::mem::replace(&mut self.field, current);
        for (stroke, count) in strokes().zip(1..) {
            match stroke {
                Stroke::Key(key, KeyDirection::Press) => _ = self.accepted.press(key),
                Stroke::Key(key, KeyDirection::Release) => _ = self.accepted.release(key),
                Stroke::Character(_) => {}
            }
            self.request(WorkerRequest::Stroke {
                stroke,
                is_last: count == burst.len(),
                ticket,
                field,
            })?;
        }
        Ok(())
    }

    /// Returns `true` if the queue has room for this number of requests. Otherwise counts their presses as dropped and voids all
    /// presses that wait.
    fn accept_presses(&mut self, requests: usize, presses: usize) -> Result<bool, OutputError> {
        let has_room = self.queue_length()? + requests <= PRESS_LIMIT;
        if !has_room {
            self.dropped_presses += presses as u64;
            self.status.tickets.void();
        }
        Ok(has_room)
    }

    fn release(&mut self, key: KeyCode) -> Result<(), OutputError> {
        if !self.accepted.release(key) {
            return Ok(());
        }
        let moved = self.send_motion();
        let ticket = self.status.tickets.issue(self.generation);
        let direct = self.write_directly(key, KeyDirection::Release, ticket);
        let release = direct.unwrap_or(WorkerRequest::Release(key));
        self.request(release).and(moved)
    }

    /// Writes a key event to the display if nothing can arrive before it. Returns the request to confirm the event, or
    /// `None` if it was not written.
    fn write_directly(
        &mut self,
        key: KeyCode,
        direction: KeyDirection,
        ticket: PressTicket,
    ) -> Option<WorkerRequest> {
        // The thread reports a release after it. If the key were pressed again before, the watchdog would not know that press.
        let is_press = direction == KeyDirection::Press;
        let follows_release = is_press && self.has_written_release;
        if !self.is_thread_idle || follows_release || (is_press && self.has_stalled()) {
            return None;
        }
        if let Ok(opened) = self.opened_direct_keys.try_recv() {
            self.direct_keys = Some(opened);
        }
        let direct_keys = self.direct_keys.as_mut()?;
        if is_press && !direct_keys.may_press(ticket.queued_at()) {
            // The thread waits for a reply of the watchdog.
            return None;
        }
        let connection = direct_keys.write(key, direction);
        match (connection, direction) {
            (None, _) => self.direct_keys = None,
            (Some(_), KeyDirection::Press) => self.requested_with_direct_press = self.requested + 1,
            (Some(_), KeyDirection::Release) => self.has_written_release = true,
        }
        connection.map(|number| WorkerRequest::Confirm(key, direction, number, ticket))
    }

    fn move_pointer(&mut self, event: EventKind) -> Result<(), OutputError> {
        self.motion.push(event);
        let has_room = self.queue_length()? < MOTION_LIMIT;
        self.coalesced_motions += u64::from(!has_room);
        self.send_motion()
    }

    /// Sends the pending motion if the queue has room.
    fn send_motion(&mut self) -> Result<(), OutputError> {
        if self.queue_length()? >= MOTION_LIMIT {
            return Ok(());
        }
        for action in self.motion.drain() {
            let ticket = self.status.tickets.issue(self.generation);
            self.request(WorkerRequest::Perform(action, ticket))?;
        }
        Ok(())
    }

    fn queue_length(&self) -> Result<usize, OutputError> {
        let requests = self.requests.as_ref();
        requests
            .map(Sender::len)
            .ok_or_else(|| send_error("it is closed"))
    }

    fn request(&mut self, request: WorkerRequest) -> Result<(), OutputError> {
        let Some(requests) = &self.requests else {
            return Err(send_error("it is closed"));
        };
        // Only what the loop has written itself precedes what it writes next.
        self.is_thread_idle &= matches!(request, WorkerRequest::Confirm(..));
        match requests.try_send(request) {
            Ok(()) => {
                self.requested += 1;
                Ok(())
            }
            Err(TrySendError::Full(_)) => Err(send_error("its queue is full")),
            Err(TrySendError::Disconnected(_)) => Err(send_error("its thread has ended")),
        }
    }

    fn result(&self) -> Result<(), OutputError> {
        match (self.status.failure.get(), self.status.stuck_keys.get()) {
            (None, None) => Ok(()),
            (Some(failure), None) => Err(send_error(failure)),
            (failure, Some(stuck)) => {
                let failure = failure.map_or("a release failed", String::as_str);
                Err(send_error(format!(
                    "{failure}; may still be pressed: {stuck}"
                )))
            }
        }
    }
}

impl Sink for Desktop {
    fn send(&mut self, events: &[OutputEvent]) -> Result<(), OutputError> {
        self.status.loop_calls.fetch_add(1, Ordering::Relaxed);
        self.is_thread_idle = self.status.executed.load(Ordering::Acquire) == self.requested;
        self.has_written_release = false;
        let mut result = Ok(());
        let mut remaining = events;
        while let Some(event) = remaining.first() {
            let length = burst::length(remaining, &self.accepted);
            let (run, others) = remaining.split_at(length.max(1));
            remaining = others;
            let requested = match event.kind {
                EventKind::KeyUp(key) => self.release(key),
                _ if self.status.failure.get().is_some() => Ok(()),
                _ if length > 0 => self.type_burst(run),
                EventKind::KeyDown(key) => self.press(key),
                EventKind::MoveBy(..) | EventKind::MoveTo(..) | EventKind::Scroll(..) => {
                    self.move_pointer(event.kind)
                }
                _ => Ok(()),
            };
            result = result.and(requested);
        }
        result.and(self.result())
    }

    fn capabilities(&self) -> Capabilities {
        capabilities()
    }

    fn close(&mut self) -> Result<(), OutputError> {
        self.requests = None;
        self.motion = PendingMotion::default();
        let ended = self.thread_ended.recv_timeout(CLOSE_TIMEOUT);
        // Closing the connection earlier would revoke what the thread has not confirmed.
        self.direct_keys = None;
        drop(self.opened_direct_keys.try_recv());
        if ended == Err(RecvTimeoutError::Timeout) {
            return Err(send_error(
                "it did not accept everything within 1 s; keys may still be pressed",
            ));
        }
        if let Some(thread) = self.thread.take()
            && thread.join().is_err()
        {
            return Err(send_error("its thread panicked; keys may still be pressed"));
        }
        self.result()
    }

    fn void_presses(&mut self) {
        self.generation = self.status.tickets.void();
        self.motion = PendingMotion::default();
        if self.status.executed.load(Ordering::Acquire) < self.requested_with_direct_press {
            // Closing the connection revokes what the display has not read.
            self.direct_keys = None;
        }
    }

    fn has_stalled(&self) -> bool {
        self.generation != self.status.tickets.generation()
    }

    fn dropped_presses(&self) -> u64 {
        self.dropped_presses + self.status.void_presses.load(Ordering::Relaxed)
    }

    fn coalesced_motions(&self) -> u64 {
        self.coalesced_motions
    }

    fn text_field(&self) -> TextField {
        TextField {
            generation: self.status.follow_field(),
            ..TextField::default()
        }
    }
}

impl Drop for Desktop {
    fn drop(&mut self) {
        let _ = self.close();
    }
}

/// Returns the keys and buttons of keyboards and mice that this system has, characters, and the pointer.
fn capabilities() -> Capabilities {
    let is_supported = |key: &KeyCode| match key.kind() {
        KeyKind::Keyboard => system::has_key(*key),
        KeyKind::Mouse => true,
        KeyKind::Gamepad => false,
    };
    Capabilities {
        keys: KeyCode::all().filter(is_supported).collect(),
        text: true,
        relative_motion: true,
        absolute_motion: true,
        scroll: true,
        ..Capabilities::default()
    }
}

/// Opens the output for the desktop of the session.
fn open(request: &OpenRequest) -> Result<Box<dyn Sink>, OutputError> {
    let opened = Desktop::open_with_watchdog(None, request.watchdog, request.required)?;
    Ok(Box::new(opened))
}

fn needs_pointer(capability: Capability) -> bool {
    match capability {
        Capability::RelativeMotion | Capability::AbsoluteMotion | Capability::Scroll => true,
        Capability::Key(key) => key.kind() == KeyKind::Mouse,
        _ => false,
    }
}

fn open_error(reason: impl ToString) -> OutputError {
    OutputError::open(BACKEND.name, reason)
}

fn send_error(reason: impl ToString) -> OutputError {
    OutputError::send(BACKEND.name, reason)
}

#[cfg(test)]
pub(super) mod tests;
