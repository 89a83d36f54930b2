//! Requests to a display that records them.

mod bursts;
mod direct;
#[cfg(target_os = "linux")]
mod hung_loop;
#[cfg(target_os = "linux")]
mod reports;

use super::burst::Stroke;
#[cfg(all(feature = "ime", feature = "wayland", target_os = "linux"))]
use super::composing::Composing;
use super::direct_keys::DirectConnection;
use super::injector::WindowId;
use super::key_reporter::KeyReporter;
use super::pending_motion::StatelessAction;
use super::*;
use crate::output::RETRIES;
use crate::output::tests::{down, event, up, wait_until};
use ademan_core::device::pressed_keys::KeyDirection;
use std::sync::Mutex;

/// A display that records keys and actions as lines.
#[derive(Clone, Default)]
pub(in crate::output) struct TestDisplay(Arc<Mutex<DisplayState>>);

#[derive(Default)]
struct DisplayState {
    lines: Vec<String>,
    /// Number of the next calls that fail.
    failures: usize,
    is_first_connection_broken: bool,
    rejects_connections: bool,
    connections: usize,
    /// Number of times that a worker waited until the display responds.
    waits: usize,
    /// Number of actions that a worker has handed over.
    actions: usize,
    /// Calls of connections block.
    is_blocked: bool,
    /// The window with the focus, if the display reports it.
    focus: Option<WindowId>,
    /// Another keyboard or mouse was pressed, which the worker has not noticed.
    has_foreign_press: bool,
    direct: direct::DirectState,
}

struct Connection {
    display: TestDisplay,
    index: usize,
    gate: Receiver<()>,
}

impl TestDisplay {
    /// Opens a sink on this display. Each call of the connection blocks until the returned gate is dropped; presses may
    /// wait for that.
    pub(in crate::output) fn open(&self) -> (Desktop, Sender<()>) {
        self.open_with_max_age(Duration::MAX)
    }

    fn open_with_max_age(&self, max_press_age: Duration) -> (Desktop, Sender<()>) {
        self.open_with(None, max_press_age)
    }

    fn open_with(
        &self,
        watchdog: Option<&WatchdogSettings>,
        max_press_age: Duration,
    ) -> (Desktop, Sender<()>) {
        let (gate, gate_dropped) = bounded::<()>(0);
        let display = self.clone();
        let sink = Desktop::start(watchdog, max_press_age, move || {
            let mut state = display.0.lock().unwrap();
            let index = state.connections;
            state.connections += 1;
            if state.rejects_connections {
                return Err("no room".into());
            }
            Ok(Box::new(Connection {
                display: display.clone(),
                index,
                gate: gate_dropped.clone(),
            }))
        });
        (sink.unwrap(), gate)
    }

    fn set_blocked(&self, is_blocked: bool) {
        self.0.lock().unwrap().is_blocked = is_blocked;
    }

    pub(in crate::output) fn lines(&self) -> Vec<String> {
        self.0.lock().unwrap().lines.clone()
    }
}

impl Connection {
    fn wait_for_gate(&self) {
        let _ = self.gate.recv();
        while self.display.0.lock().unwrap().is_blocked {
            thread::yield_now();
        }
    }
}

impl Injector for Connection {
    fn inject(&mut self, key: KeyCode, direction: KeyDirection) -> Result<(), String> {
        self.wait_for_gate();
        let mut state = self.display.0.lock().unwrap();
        if state.is_first_connection_broken && self.index == 0 {
            return Err("the display is gone".into());
        }
        if state.failures > 0 {
            state.failures -= 1;
            return Err("busy".into());
        }
        let sign = match direction {
            KeyDirection::Press => '+',
            KeyDirection::Release => '-',
        };
        state.lines.push(format!("{sign}{key}"));
        Ok(())
    }

    fn perform(&mut self, action: StatelessAction) -> Result<(), String> {
        self.display.0.lock().unwrap().actions += 1;
        self.wait_for_gate();
        let mut state = self.display.0.lock().unwrap();
        state.lines.push(format!("{action:?}"));
        Ok(())
    }

    fn type_burst(&mut self, burst: &[Stroke], _: &mut KeyReporter) -> Result<bool, String> {
        let _ = self.gate.recv();
        let mut state = self.display.0.lock().unwrap();
        let text = burst::text(burst);
        if text == "\0" {
            drop(state);
            panic!("meant to happen");
        }
        if state.failures > 0 {
            state.failures -= 1;
            return Err("busy".into());
        }
        let can_type = text.is_ascii();
        if can_type {
            state
                .lines
                .push(format!("type {}", bursts::describe(burst)));
        }
        Ok(can_type)
    }

    #[cfg(all(feature = "ime", feature = "wayland", target_os = "linux"))]
    fn compose(&mut self, composing: &Composing) -> Result<bool, String> {
        let verb = if composing.is_committed {
            "commit"
        } else {
            "show"
        };
        let mut state = self.display.0.lock().unwrap();
        state.lines.push(format!("{verb} {}", composing.text));
        Ok(true)
    }

    fn focus(&self) -> Option<WindowId> {
        self.display.0.lock().unwrap().focus
    }

    fn poll_focus(&mut self) -> Option<WindowId> {
        self.focus()
    }

    fn poll_foreign_press(&mut self) -> bool {
        std::mem::take(&mut self.display.0.lock().unwrap().has_foreign_press)
    }

    fn wait_until_responsive(&mut self) -> Result<(), String> {
        self.display.0.lock().unwrap().waits += 1;
        self.wait_for_gate();
        Ok(())
    }

    fn open_direct_connection(&mut self) -> Option<DirectConnection> {
        direct::open(&self.display)
    }
}

/// Opens a sink on a new display whose connection blocks until the gate is dropped.
fn open_gated() -> (TestDisplay, Desktop, Sender<()>) {
    let display = TestDisplay::default();
    let (sink, gate) = display.open();
    (display, sink, gate)
}

/// Opens a sink on a new display whose connection never blocks.
fn open_responding() -> (TestDisplay, Desktop) {
    let (display, sink, gate) = open_gated();
    drop(gate);
    (display, sink)
}

#[test]
fn closing_sends_the_queue_and_releases_keys_modifiers_last() {
    let (display, mut sink, gate) = open_gated();
    sink.send(&[down(1, "ShiftLeft"), down(1, "A"), up(1, "B")])
        .unwrap();
    sink.send(&[up(2, "A"), down(2, "C")]).unwrap();
    drop(gate);
    sink.close().unwrap();
    sink.close().unwrap();
    let lines = ["+ShiftLeft", "+A", "-A", "+C", "-C", "-ShiftLeft"];
    assert_eq!(display.lines(), lines);
    let error = sink.send(&[down(3, "A")]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the output `desktop` failed: it is closed"
    );
}

#[test]
fn a_panic_of_the_owner_releases_all_keys() {
    let (display, mut sink) = open_responding();
    let owner = thread::spawn(move || {
        sink.send(&[down(1, "A")]).unwrap();
        panic!("meant to happen");
    });
    assert!(owner.join().is_err());
    assert_eq!(display.lines(), ["+A", "-A"]);
}

#[test]
fn a_full_queue_drops_presses_but_no_release() {
    let (display, mut sink) = open_responding();
    sink.send(&[down(0, "ShiftLeft")]).unwrap();
    display.wait_for_lines(1);
    display.set_blocked(true);
    for time in 0..QUEUE as u64 {
        sink.send(&[down(time, "A"), up(time, "A")]).unwrap();
    }
    assert!(sink.dropped_presses() > 0 && sink.has_stalled());
    sink.send(&[up(1, "ShiftLeft")]).unwrap();
    display.set_blocked(false);
    sink.close().unwrap();
    assert_eq!(display.lines(), ["+ShiftLeft", "-ShiftLeft"]);
    assert_eq!(sink.dropped_presses(), QUEUE as u64);
}

/// Sends a press, a character and a turn of the wheel that wait in the queue.
fn queue_a_press(sink: &mut Desktop) {
    let others = [EventKind::Character('x'), EventKind::Scroll(0, 240)];
    sink.send(&[down(1, "A")]).unwrap();
    sink.send(&others.map(|kind| event(1, kind))).unwrap();
}

#[test]
fn void_presses_and_their_releases_are_not_sent_and_later_presses_are() {
    let (display, mut sink, gate) = open_gated();
    sink.send(&[event(1, EventKind::MoveBy(1, 0))]).unwrap();
    wait_until("an action", || display.0.lock().unwrap().actions > 0);
    queue_a_press(&mut sink);
    sink.void_presses();
    sink.send(&[up(2, "A"), down(2, "B")]).unwrap();
    drop(gate);
    sink.close().unwrap();
    // The display had received the motion before.
    assert_eq!(display.lines(), ["MoveBy(1, 0)", "+B", "-B"]);
    assert_eq!(sink.dropped_presses(), 2);
}

#[test]
fn a_press_that_has_waited_too_long_is_not_sent() {
    let display = TestDisplay::default();
    let (mut sink, gate) = display.open_with_max_age(Duration::ZERO);
    sink.send(&[event(1, EventKind::MoveBy(1, 0))]).unwrap();
    queue_a_press(&mut sink);
    thread::sleep(Duration::from_millis(1));
    drop(gate);
    sink.close().unwrap();
    // The pointer moves all the same: a click after it may be in time.
    assert_eq!(display.lines(), ["MoveBy(1, 0)"]);
    assert_eq!(sink.dropped_presses(), 2);
}

/// Makes events void while the display does not respond, checks that it executes none of them, and returns the number of dropped
/// presses.
fn void_while_the_display_does_not_respond(events: &[OutputEvent]) -> u64 {
    let (display, mut sink, gate) = open_gated();
    sink.send(events).unwrap();
    wait_until("a worker that waits", || {
        display.0.lock().unwrap().waits > 0
    });
    sink.void_presses();
    drop(gate);
    sink.close().unwrap();
    assert_eq!(display.lines(), [""; 0]);
    sink.dropped_presses()
}

#[test]
fn a_press_is_not_sent_if_it_becomes_void_while_the_display_does_not_respond() {
    assert_eq!(void_while_the_display_does_not_respond(&[down(1, "A")]), 1);
}

#[test]
fn neither_sending_nor_closing_waits_for_a_display_that_hangs() {
    let (display, mut sink, gate) = open_gated();
    sink.send(&[down(1, "A")]).unwrap();
    let error = sink.close().unwrap_err();
    assert!(
        error.to_string().contains("may still be pressed"),
        "{error}"
    );
    drop(gate);
    sink.close().unwrap();
    assert_eq!(display.lines(), ["+A", "-A"]);
}

#[test]
fn a_call_that_fails_three_times_is_repeated() {
    let (display, mut sink, gate) = open_gated();
    display.0.lock().unwrap().failures = RETRIES;
    sink.send(&[down(1, "A")]).unwrap();
    drop(gate);
    sink.close().unwrap();
    assert_eq!(display.lines(), ["+A", "-A"]);
}

#[test]
fn after_a_failure_nothing_is_pressed_and_keys_that_may_be_pressed_are_released() {
    let (display, mut sink, gate) = open_gated();
    display.0.lock().unwrap().failures = 1 + RETRIES;
    sink.send(&[down(1, "A"), down(2, "B")]).unwrap();
    drop(gate);
    let error = sink.close().unwrap_err();
    assert_eq!(error.to_string(), "the output `desktop` failed: busy");
    assert_eq!(display.lines(), ["-A"]);
    assert!(sink.send(&[down(3, "C")]).is_err());
}

#[test]
fn keys_are_released_on_a_new_connection_if_the_first_is_lost() {
    let (display, mut sink) = open_responding();
    sink.send(&[down(1, "A")]).unwrap();
    display.wait_for_lines(1);
    display.0.lock().unwrap().is_first_connection_broken = true;
    sink.close().unwrap_err();
    assert_eq!(display.lines(), ["+A", "-A"]);
    assert_eq!(display.0.lock().unwrap().connections, 2);
}

#[test]
fn keys_that_cannot_be_released_are_named() {
    let (display, mut sink) = open_responding();
    sink.send(&[down(1, "ShiftLeft"), down(1, "A")]).unwrap();
    display.wait_for_lines(2);
    let mut state = display.0.lock().unwrap();
    (state.is_first_connection_broken, state.rejects_connections) = (true, true);
    drop(state);
    let error = sink.close().unwrap_err().to_string();
    let end = "the display is gone; may still be pressed: A, ShiftLeft";
    assert!(error.ends_with(end), "{error}");
}

#[test]
fn pointer_wheel_characters_and_buttons_stay_in_order() {
    let (display, mut sink) = open_responding();
    let events = [
        event(1, EventKind::MoveTo(0.5, 0.25)),
        down(1, "MouseLeft"),
        event(1, EventKind::MoveBy(5, -5)),
        up(1, "MouseLeft"),
        event(1, EventKind::Scroll(0, -60)),
        event(1, EventKind::Character('e')),
    ];
    sink.send(&events).unwrap();
    sink.send(&[event(2, EventKind::Scroll(0, -60)), down(2, "MouseRight")])
        .unwrap();
    sink.close().unwrap();
    let lines = [
        "MoveTo(0.5, 0.25)",
        "+MouseLeft",
        "MoveBy(5, -5)",
        "-MouseLeft",
        "type e",
        "Scroll(0, -1)",
        "+MouseRight",
        "-MouseRight",
    ];
    assert_eq!(display.lines(), lines);
    assert_eq!(sink.coalesced_motions(), 0);
}

#[test]
fn a_full_queue_coalesces_motion_and_drops_no_release() {
    let (display, mut sink) = open_responding();
    let keys: Vec<_> = KeyCode::all().collect();
    for (index, key) in keys.iter().enumerate() {
        sink.send(&[event(0, EventKind::KeyDown(*key))]).unwrap();
        display.wait_for_lines(index + 1);
    }
    display.set_blocked(true);
    for _ in 0..2 * QUEUE {
        sink.send(&[event(0, EventKind::MoveBy(1, 0))]).unwrap();
    }
    let coalesced = sink.coalesced_motions() as usize;
    assert!(coalesced > 0);
    for key in &keys {
        sink.send(&[event(0, EventKind::KeyUp(*key))]).unwrap();
    }
    display.set_blocked(false);
    // Coalesced motion is sent with the next one.
    display.wait_for_lines(2 * keys.len() + 2 * QUEUE - coalesced);
    sink.send(&[event(1, EventKind::MoveBy(1, 0))]).unwrap();
    sink.close().unwrap();
    let lines = display.lines();
    let count = |sign| lines.iter().filter(|line| line.starts_with(sign)).count();
    assert_eq!((count('+'), count('-')), (keys.len(), keys.len()));
    let last = format!("MoveBy({}, 0)", coalesced + 1);
    assert_eq!(lines.last(), Some(&last));
}

#[test]
fn the_wheel_does_not_turn_if_that_becomes_void_while_the_display_does_not_respond() {
    void_while_the_display_does_not_respond(&[event(1, EventKind::Scroll(0, 240))]);
}

#[test]
fn motion_without_room_in_the_queue_is_not_sent_after_a_pause() {
    let (display, mut sink, gate) = open_gated();
    for _ in 0..2 * QUEUE {
        sink.send(&[event(0, EventKind::MoveBy(1, 0))]).unwrap();
    }
    assert!(sink.coalesced_motions() > 0);
    sink.void_presses();
    drop(gate);
    direct::wait_until_idle(&sink);
    let count = display.lines().len();
    sink.send(&[event(1, EventKind::MoveBy(0, 5))]).unwrap();
    sink.close().unwrap();
    assert_eq!(display.lines()[count..], ["MoveBy(0, 5)"]);
}

#[test]
fn a_panic_of_the_connection_releases_all_keys() {
    let (display, mut sink, gate) = open_gated();
    sink.send(&[
        down(1, "A"),
        down(1, "MouseLeft"),
        event(1, EventKind::Character('\0')),
    ])
    .unwrap();
    drop(gate);
    let error = sink.close().unwrap_err().to_string();
    assert!(
        error.ends_with("the connection to the display panicked"),
        "{error}"
    );
    assert_eq!(display.lines(), ["+A", "+MouseLeft", "-MouseLeft", "-A"]);
}

#[test]
fn without_a_display_the_error_contains_the_remedy() {
    let error = Desktop::open(Some(":59000"), &Capabilities::default())
        .err()
        .unwrap();
    let start = "cannot open the output `desktop`: no X server answers at `:59000`";
    assert!(error.to_string().starts_with(start), "{error}");
}

#[test]
fn after_a_dropped_press_nothing_is_pressed_until_the_loop_has_noticed() {
    let display = TestDisplay::default();
    // A busy machine may be late with the presses that come in time.
    let max_age = Duration::from_secs(2);
    let (mut sink, gate) = display.open_with_max_age(max_age);
    sink.send(&[down(1, "ControlLeft")]).unwrap();
    thread::sleep(max_age + Duration::from_millis(1));
    sink.send(&[down(2, "W")]).unwrap();
    drop(gate);
    wait_until("a stall", || sink.has_stalled());
    // The layout still believes that Control is pressed.
    sink.send(&[up(3, "W"), down(3, "C")]).unwrap();
    sink.void_presses();
    assert!(!sink.has_stalled());
    sink.send(&[up(4, "C"), up(4, "ControlLeft"), down(5, "A")])
        .unwrap();
    sink.close().unwrap();
    assert_eq!(display.lines(), ["+A", "-A"]);
    assert_eq!(sink.dropped_presses(), 3);
}
