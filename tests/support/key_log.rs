//! A log of every press, repeat and release of keys and buttons on an X server.
//!
//! The extension RECORD reports the events of all devices in the order in which the server processed them, whoever has
//! the focus or a grab. Polling the state of the keyboard would miss a press that is shorter than the interval.

use std::collections::BTreeSet;
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use x11rb::protocol::record::{self, ConnectionExt, EnableContextReply};
use x11rb::protocol::xproto::{
    BUTTON_PRESS_EVENT, BUTTON_RELEASE_EVENT, KEY_PRESS_EVENT, KEY_RELEASE_EVENT, KeyPressEvent,
};
use x11rb::rust_connection::RustConnection;
use x11rb::x11_utils::TryParse;

use super::x11::{XServer, wait_for};

/// Categories of recorded data, from the protocol of the extension.
const FROM_SERVER: u8 = 0;
const START_OF_DATA: u8 = 4;

/// The length of an event in the protocol.
const EVENT_BYTES: usize = 32;

/// A key or a button by its X11 code.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Input {
    Key(u16),
    Button(u8),
}

/// A change of a key or a button.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    Press,
    /// The server reports a key again that is already pressed (auto-repeat).
    Repeat,
    Release,
}

/// An event with the time at which the server processed it, to about 10 ms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KeyEvent {
    pub time: Instant,
    pub input: Input,
    pub action: Action,
}

/// A log that grows in a thread of its own until the server exits.
pub struct KeyLog {
    events: Arc<Mutex<Vec<KeyEvent>>>,
}

impl KeyLog {
    /// Starts to record. Events before this call are not in the log.
    pub fn start(server: &XServer) -> Self {
        Self::on_display(server.display())
    }

    /// Starts to record while these keys are pressed. The next event of each is a repeat or a release.
    pub fn start_while_pressed(server: &XServer, keys: &[u16]) -> Self {
        let pressed = keys.iter().map(|&code| Input::Key(code)).collect();
        Self::record(server.display(), pressed)
    }

    /// Starts to record on the server of this name.
    pub fn on_display(display: &str) -> Self {
        Self::record(display, BTreeSet::new())
    }

    /// Starts to record on a server where these keys and buttons are pressed.
    fn record(display: &str, mut pressed: BTreeSet<Input>) -> Self {
        let (connection, _) = x11rb::connect(Some(display)).expect("the server answers");
        let context = create_context(&connection);
        let events = Arc::new(Mutex::new(Vec::new()));
        let log = Self {
            events: Arc::clone(&events),
        };
        let (started, start) = crossbeam_channel::bounded(1);
        thread::spawn(move || {
            let replies = connection.record_enable_context(context);
            let mut clock = None;
            for reply in replies.expect("the server runs").map_while(Result::ok) {
                if reply.category == START_OF_DATA {
                    clock = Some((Instant::now(), reply.server_time));
                    let _ = started.send(());
                }
                let clock = clock.expect("the start of the data comes first");
                let new = decode(&reply, clock, &mut pressed);
                events.lock().expect("no panic").extend(new);
            }
        });
        start.recv().expect("the server records");
        log
    }

    /// Returns all events so far.
    pub fn events(&self) -> Vec<KeyEvent> {
        self.events.lock().expect("no panic").clone()
    }

    /// Returns the number of events so far.
    pub fn len(&self) -> usize {
        self.events.lock().expect("no panic").len()
    }

    /// Returns the keys and buttons that are pressed after all events so far.
    pub fn pressed(&self) -> BTreeSet<Input> {
        pressed(&self.events.lock().expect("no panic"))
    }

    /// Returns the number of presses after the first `skip` events.
    pub fn presses_after(&self, skip: usize) -> usize {
        let events = self.events.lock().expect("no panic");
        let after = events.iter().skip(skip);
        after.filter(|event| event.action == Action::Press).count()
    }

    /// Checks that there was no press so far.
    pub fn assert_no_press(&self) {
        assert_eq!(self.presses_after(0), 0, "{:?}", self.events());
    }

    /// Waits for a press after the first `skip` events. Returns `false` after the time-out.
    pub fn wait_for_press(&self, skip: usize) -> bool {
        wait_for(|| self.presses_after(skip) > 0)
    }
}

/// Returns the keys and buttons that are pressed after these events.
pub fn pressed(events: &[KeyEvent]) -> BTreeSet<Input> {
    let mut pressed = BTreeSet::new();
    for event in events {
        match event.action {
            Action::Press | Action::Repeat => pressed.insert(event.input),
            Action::Release => pressed.remove(&event.input),
        };
    }
    pressed
}

/// Creates a context that records the presses and releases of all devices.
fn create_context(connection: &RustConnection) -> record::Context {
    let context = x11rb::connection::Connection::generate_id(connection).expect("an id for it");
    let range = record::Range {
        device_events: record::Range8 {
            first: KEY_PRESS_EVENT,
            last: BUTTON_RELEASE_EVENT,
        },
        ..record::Range::default()
    };
    connection
        .record_create_context(context, 0, &[record::CS::ALL_CLIENTS.into()], &[range])
        .expect("the server runs")
        .check()
        .expect("the server has the extension RECORD");
    context
}

/// Decodes the events of a reply and updates the set of pressed keys. `clock` is a time and the time stamp of the server
/// at that time, in milliseconds.
fn decode(
    reply: &EnableContextReply,
    clock: (Instant, u32),
    pressed: &mut BTreeSet<Input>,
) -> Vec<KeyEvent> {
    if reply.category != FROM_SERVER {
        return Vec::new();
    }
    let events = reply.data.chunks_exact(EVENT_BYTES).map(|bytes| {
        // Events of buttons have the same format.
        let (event, _) = KeyPressEvent::try_parse(bytes).expect("an event");
        let input = match event.response_type {
            KEY_PRESS_EVENT | KEY_RELEASE_EVENT => Input::Key(event.detail.into()),
            _ => Input::Button(event.detail),
        };
        let action = match event.response_type {
            KEY_PRESS_EVENT | BUTTON_PRESS_EVENT => {
                if pressed.insert(input) {
                    Action::Press
                } else {
                    Action::Repeat
                }
            }
            _ => {
                pressed.remove(&input);
                Action::Release
            }
        };
        // The clock of the server is coarse, so an event may seem to precede the start.
        let since = event.time.wrapping_sub(clock.1).cast_signed().max(0);
        KeyEvent {
            time: clock.0 + Duration::from_millis(since.unsigned_abs().into()),
            input,
            action,
        }
    });
    events.collect()
}
