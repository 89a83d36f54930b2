//! Orders on their way to a display that writes down what it is told.

use super::*;
use crate::output::RETRIES;
use crate::output::tests::{down, event, up};
use enigo::Direction;
use std::sync::Mutex;
use std::time::Instant;

/// A display that writes down what it is told.
#[derive(Clone, Default)]
struct Desk(Arc<Mutex<State>>);

#[derive(Default)]
struct State {
    lines: Vec<String>,
    failures: usize,
    first_is_broken: bool,
    takes_no_other: bool,
    connections: usize,
}

struct Connection {
    desk: Desk,
    number: usize,
    gate: Receiver<()>,
}

impl Desk {
    /// A sink on this display; each key waits until the returned gate is dropped.
    fn open(&self) -> (Desktop, Sender<()>) {
        let (gate, closed_gate) = bounded::<()>(0);
        let desk = self.clone();
        let sink = Desktop::start(None, move || {
            let mut state = desk.0.lock().unwrap();
            let number = state.connections;
            state.connections += 1;
            if state.takes_no_other {
                return Err("no room".into());
            }
            Ok(Connection {
                desk: desk.clone(),
                number,
                gate: closed_gate.clone(),
            })
        });
        (sink.unwrap(), gate)
    }

    fn lines(&self) -> Vec<String> {
        self.0.lock().unwrap().lines.clone()
    }
}

impl Injector for Connection {
    fn inject(&mut self, key: KeyCode, direction: Direction) -> Result<(), String> {
        let _ = self.gate.recv();
        let mut state = self.desk.0.lock().unwrap();
        if state.first_is_broken && self.number == 0 {
            return Err("the display is gone".into());
        }
        if state.failures > 0 {
            state.failures -= 1;
            return Err("busy".into());
        }
        let sign = if direction == Direction::Press {
            '+'
        } else {
            '-'
        };
        state.lines.push(format!("{sign}{key}"));
        Ok(())
    }

    fn perform(&mut self, impulse: StatelessAction) -> Result<(), String> {
        let _ = self.gate.recv();
        let mut state = self.desk.0.lock().unwrap();
        if impulse == StatelessAction::Write('\0') {
            drop(state);
            panic!("meant to happen");
        }
        if state.failures > 0 {
            state.failures -= 1;
            return Err("busy".into());
        }
        state.lines.push(format!("{impulse:?}"));
        Ok(())
    }
}

#[test]
fn closing_delivers_what_waits_and_lets_go_with_modifiers_last() {
    let desk = Desk::default();
    let (mut sink, gate) = desk.open();
    sink.send(&[down(1, "ShiftLeft"), down(1, "A"), up(1, "B")])
        .unwrap();
    sink.send(&[up(2, "A"), down(2, "C")]).unwrap();
    drop(gate);
    sink.close().unwrap();
    sink.close().unwrap();
    let lines = ["+ShiftLeft", "+A", "-A", "+C", "-C", "-ShiftLeft"];
    assert_eq!(desk.lines(), lines);
    let error = sink.send(&[down(3, "A")]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the output `desktop` failed: it is closed"
    );
}

#[test]
fn a_panic_of_whoever_holds_it_lets_go_of_everything() {
    let desk = Desk::default();
    let (mut sink, gate) = desk.open();
    drop(gate);
    let holder = thread::spawn(move || {
        sink.send(&[down(1, "A")]).unwrap();
        panic!("meant to happen");
    });
    assert!(holder.join().is_err());
    assert_eq!(desk.lines(), ["+A", "-A"]);
}

#[test]
fn when_the_queue_fills_presses_are_refused_and_no_release_is() {
    let desk = Desk::default();
    let (mut sink, gate) = desk.open();
    sink.send(&[down(0, "ShiftLeft")]).unwrap();
    for time in 0..QUEUE as u64 {
        sink.send(&[down(time, "A"), up(time, "A")]).unwrap();
    }
    assert!(sink.dropped_presses() > 0);
    sink.send(&[up(1, "ShiftLeft")]).unwrap();
    let refused = sink.dropped_presses() as usize;
    drop(gate);
    sink.close().unwrap();
    let count = |line: &str| desk.lines().iter().filter(|found| *found == line).count();
    assert_eq!(count("+A"), QUEUE - refused);
    assert_eq!(count("-A"), count("+A"));
    assert_eq!(count("-ShiftLeft"), 1);
}

#[test]
fn sending_does_not_wait_for_a_display_that_hangs_and_closing_waits_a_second() {
    let desk = Desk::default();
    let (mut sink, gate) = desk.open();
    sink.send(&[down(1, "A")]).unwrap();
    let start = Instant::now();
    let error = sink.close().unwrap_err();
    assert!(start.elapsed() < 3 * CLOSE_LIMIT);
    assert!(error.to_string().contains("may still be down"), "{error}");
    drop(gate);
    sink.close().unwrap();
    assert_eq!(desk.lines(), ["+A", "-A"]);
}

#[test]
fn a_display_that_is_busy_three_times_loses_nothing() {
    let desk = Desk::default();
    let (mut sink, gate) = desk.open();
    desk.0.lock().unwrap().failures = RETRIES;
    sink.send(&[down(1, "A")]).unwrap();
    drop(gate);
    sink.close().unwrap();
    assert_eq!(desk.lines(), ["+A", "-A"]);
}

#[test]
fn after_a_failure_nothing_is_pressed_and_what_may_be_down_is_let_go_of() {
    let desk = Desk::default();
    let (mut sink, gate) = desk.open();
    desk.0.lock().unwrap().failures = 1 + RETRIES;
    sink.send(&[down(1, "A"), down(2, "B")]).unwrap();
    drop(gate);
    let error = sink.close().unwrap_err();
    assert_eq!(error.to_string(), "the output `desktop` failed: busy");
    assert_eq!(desk.lines(), ["-A"]);
    assert!(sink.send(&[down(3, "C")]).is_err());
}

#[test]
fn when_the_connection_is_lost_keys_are_let_go_of_through_a_new_one() {
    let desk = Desk::default();
    let (mut sink, gate) = desk.open();
    drop(gate);
    sink.send(&[down(1, "A")]).unwrap();
    while desk.lines().is_empty() {
        thread::yield_now();
    }
    desk.0.lock().unwrap().first_is_broken = true;
    sink.close().unwrap_err();
    assert_eq!(desk.lines(), ["+A", "-A"]);
    assert_eq!(desk.0.lock().unwrap().connections, 2);
}

#[test]
fn what_cannot_be_let_go_of_is_named() {
    let desk = Desk::default();
    let (mut sink, gate) = desk.open();
    drop(gate);
    sink.send(&[down(1, "ShiftLeft"), down(1, "A")]).unwrap();
    while desk.lines().len() < 2 {
        thread::yield_now();
    }
    let mut state = desk.0.lock().unwrap();
    (state.first_is_broken, state.takes_no_other) = (true, true);
    drop(state);
    let error = sink.close().unwrap_err().to_string();
    let end = "the display is gone; may still be down: A, ShiftLeft";
    assert!(error.ends_with(end), "{error}");
}

#[test]
fn pointer_wheel_and_characters_go_out_in_order_between_buttons() {
    let desk = Desk::default();
    let (mut sink, gate) = desk.open();
    drop(gate);
    let frame = [
        event(1, EventKind::MoveTo(0.5, 0.25)),
        down(1, "MouseLeft"),
        event(1, EventKind::MoveBy(5, -5)),
        up(1, "MouseLeft"),
        event(1, EventKind::Scroll(0, -60)),
        event(1, EventKind::Character('é')),
    ];
    sink.send(&frame).unwrap();
    sink.send(&[event(2, EventKind::Scroll(0, -60)), down(2, "MouseRight")])
        .unwrap();
    sink.close().unwrap();
    let lines = [
        "MoveTo(0.5, 0.25)",
        "+MouseLeft",
        "MoveBy(5, -5)",
        "-MouseLeft",
        "Write('é')",
        "Scroll(0, -1)",
        "+MouseRight",
        "-MouseRight",
    ];
    assert_eq!(desk.lines(), lines);
    assert_eq!(sink.coalesced_motions(), 0);
}

#[test]
fn when_the_queue_fills_motion_waits_as_one_and_releases_still_find_room() {
    let desk = Desk::default();
    let (mut sink, gate) = desk.open();
    let keys: Vec<_> = KeyCode::all().collect();
    for key in &keys {
        sink.send(&[event(0, EventKind::KeyDown(*key))]).unwrap();
    }
    for _ in 0..2 * QUEUE {
        sink.send(&[event(0, EventKind::MoveBy(1, 0))]).unwrap();
    }
    let superseded = sink.coalesced_motions() as usize;
    assert!(superseded > 0);
    sink.send(&[event(0, EventKind::Character('x'))]).unwrap();
    assert_eq!(sink.dropped_presses(), 1);
    for key in &keys {
        sink.send(&[event(0, EventKind::KeyUp(*key))]).unwrap();
    }
    drop(gate);
    // The motion that waited goes out with the next one.
    while desk.lines().len() < 2 * keys.len() + 2 * QUEUE - superseded {
        thread::yield_now();
    }
    sink.send(&[event(1, EventKind::MoveBy(1, 0))]).unwrap();
    sink.close().unwrap();
    let lines = desk.lines();
    let count = |sign| lines.iter().filter(|line| line.starts_with(sign)).count();
    assert_eq!((count('+'), count('-')), (keys.len(), keys.len()));
    let last = format!("MoveBy({}, 0)", superseded + 1);
    assert_eq!(lines.last(), Some(&last));
}

#[test]
fn what_failed_is_not_done_twice_unless_it_is_a_key() {
    let desk = Desk::default();
    let (mut sink, gate) = desk.open();
    desk.0.lock().unwrap().failures = 1;
    sink.send(&[event(1, EventKind::Character('a'))]).unwrap();
    drop(gate);
    sink.close().unwrap_err();
    assert_eq!(desk.lines(), [""; 0]);
}

#[test]
fn a_panic_on_the_way_to_the_display_lets_go_of_everything() {
    let desk = Desk::default();
    let (mut sink, gate) = desk.open();
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
    assert_eq!(desk.lines(), ["+A", "+MouseLeft", "-MouseLeft", "-A"]);
}

#[test]
fn without_a_display_the_error_says_what_to_do() {
    let error = Desktop::open(Some(":59000"), &Capabilities::default())
        .err()
        .unwrap();
    let start = "cannot open the output `desktop`: no display answers at `:59000`";
    assert!(error.to_string().starts_with(start), "{error}");
}
