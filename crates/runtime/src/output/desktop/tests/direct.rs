//! Key events that the loop writes to the display itself.

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use super::*;
use crate::output::desktop::direct_keys::{AnswerReader, KeyWriter};

/// Longer than a test needs for anything else.
const SLOW_ANSWER: Duration = Duration::from_secs(3);

/// The connections of loops to a display.
#[derive(Default)]
pub struct DirectState {
    pub is_supported: bool,
    /// The display executes nothing that the loop writes.
    hangs: bool,
    /// The display answers after [`SLOW_ANSWER`].
    is_slow: bool,
    /// Nothing can be written.
    pub is_full: bool,
    /// Number of connections that were opened, and of ends that were dropped.
    opened: usize,
    closed_ends: usize,
}

pub fn open(display: &TestDisplay) -> Option<DirectConnection> {
    let direct = &mut display.0.lock().unwrap().direct;
    if !direct.is_supported {
        return None;
    }
    direct.opened += 1;
    let is_open = Arc::new(AtomicBool::new(true));
    let end = || End(display.clone(), Arc::clone(&is_open));
    Some((Box::new(end()), Box::new(end())))
}

/// Either end of a connection, which is open until one is dropped.
struct End(TestDisplay, Arc<AtomicBool>);

impl KeyWriter for End {
    fn write(&mut self, key: KeyCode, direction: KeyDirection) -> bool {
        let mut state = self.0.0.lock().unwrap();
        if state.direct.is_full {
            return false;
        }
        state.lines.push(format!("loop: {direction:?} {key}"));
        true
    }
}

impl AnswerReader for End {
    fn wait_for_answer(&mut self, _: Instant) -> bool {
        let display = self.0.clone();
        let is_slow = || display.0.lock().unwrap().direct.is_slow;
        let start = Instant::now();
        while is_slow() && self.discard_events() && start.elapsed() < SLOW_ANSWER {
            thread::yield_now();
        }
        !self.0.0.lock().unwrap().direct.hangs && self.discard_events()
    }

    fn discard_events(&mut self) -> bool {
        self.1.load(Ordering::Acquire)
    }
}

impl Drop for End {
    fn drop(&mut self) {
        self.1.store(false, Ordering::Release);
        self.0.0.lock().unwrap().direct.closed_ends += 1;
    }
}

fn open_sink() -> (TestDisplay, Desktop, Sender<()>) {
    let display = TestDisplay::default();
    display.0.lock().unwrap().direct.is_supported = true;
    let (sink, gate) = display.open();
    (display, sink, gate)
}

impl TestDisplay {
    pub fn set_direct(&self, set: impl FnOnce(&mut DirectState)) {
        set(&mut self.0.lock().unwrap().direct);
    }

    pub fn wait_for_lines(&self, count: usize) {
        wait_until("lines", || self.lines().len() >= count);
    }
}

/// Waits until the thread has executed all requests.
pub fn wait_until_idle(sink: &Desktop) {
    let executed = || sink.status.executed.load(Ordering::Acquire);
    wait_until("an idle thread", || executed() >= sink.requested);
}

#[test]
fn the_loop_writes_keys_itself_and_the_thread_releases_them_at_the_end() {
    let (display, mut sink, gate) = open_sink();
    sink.send(&[down(1, "ShiftLeft"), down(1, "A")]).unwrap();
    wait_until_idle(&sink);
    sink.send(&[up(2, "A")]).unwrap();
    drop(gate);
    sink.close().unwrap();
    let lines = [
        "loop: Press ShiftLeft",
        "loop: Press A",
        "loop: Release A",
        "-ShiftLeft",
    ];
    assert_eq!(display.lines(), lines);
    let state = display.0.lock().unwrap();
    assert_eq!((state.direct.opened, state.direct.closed_ends), (1, 2));
}

#[test]
fn a_press_follows_what_the_thread_still_has_to_do() {
    let (display, mut sink, gate) = open_sink();
    sink.send(&[event(1, EventKind::MoveBy(1, 0)), down(1, "MouseLeft")])
        .unwrap();
    sink.send(&[up(2, "MouseLeft")]).unwrap();
    drop(gate);
    wait_until_idle(&sink);
    sink.send(&[down(3, "A")]).unwrap();
    let lines = ["MoveBy(1, 0)", "+MouseLeft", "-MouseLeft", "loop: Press A"];
    assert_eq!(display.lines(), lines);
}

#[test]
fn a_release_follows_what_the_thread_still_has_to_do() {
    let (display, mut sink, gate) = open_sink();
    sink.send(&[down(1, "A"), event(1, EventKind::Character('x'))])
        .unwrap();
    sink.send(&[up(2, "A")]).unwrap();
    drop(gate);
    sink.close().unwrap();
    assert_eq!(display.lines(), ["loop: Press A", "type x", "-A"]);
}

#[test]
fn a_key_that_is_pressed_again_at_once_is_reported_after_its_release() {
    let (display, mut sink, gate) = open_sink();
    sink.send(&[down(1, "A"), up(1, "A"), down(1, "A")])
        .unwrap();
    drop(gate);
    sink.close().unwrap();
    let lines = ["loop: Press A", "loop: Release A", "+A", "-A"];
    assert_eq!(display.lines(), lines);
}

#[test]
fn a_press_that_is_not_executed_is_revoked_and_the_next_one_has_a_new_connection() {
    let (display, mut sink, gate) = open_sink();
    drop(gate);
    display.set_direct(|direct| direct.hangs = true);
    sink.send(&[down(1, "A")]).unwrap();
    wait_until_idle(&sink);
    display.set_direct(|direct| direct.hangs = false);
    assert_eq!(sink.dropped_presses(), 1);
    assert!(sink.has_stalled());
    sink.void_presses();
    sink.send(&[up(2, "A")]).unwrap();
    wait_until_idle(&sink);
    sink.send(&[down(3, "B")]).unwrap();
    sink.close().unwrap();
    let lines = [
        "loop: Press A",
        "-A",
        "loop: Release A",
        "loop: Press B",
        "-B",
    ];
    assert_eq!(display.lines(), lines);
    let state = display.0.lock().unwrap();
    assert_eq!((state.direct.opened, state.direct.closed_ends), (2, 4));
}

#[test]
fn a_release_that_is_not_executed_is_repeated_by_the_thread() {
    let (display, mut sink, gate) = open_sink();
    drop(gate);
    sink.send(&[down(1, "A")]).unwrap();
    wait_until_idle(&sink);
    display.set_direct(|direct| direct.hangs = true);
    sink.send(&[up(2, "A")]).unwrap();
    wait_until_idle(&sink);
    assert_eq!(display.lines(), ["loop: Press A", "loop: Release A", "-A"]);
    assert_eq!(sink.dropped_presses(), 0);
}

#[test]
fn what_was_written_together_with_a_revoked_press_is_revoked_too() {
    let (display, mut sink, gate) = open_sink();
    display.set_direct(|direct| (direct.hangs, direct.is_slow) = (true, true));
    sink.send(&[down(1, "ShiftLeft"), down(1, "A")]).unwrap();
    display.set_direct(|direct| direct.is_slow = false);
    drop(gate);
    wait_until_idle(&sink);
    assert_eq!(sink.dropped_presses(), 2);
    let lines = display.lines();
    assert_eq!(lines[..2], ["loop: Press ShiftLeft", "loop: Press A"]);
    assert_eq!(lines[2..], ["-ShiftLeft", "-A"]);
}

#[test]
fn what_cannot_be_written_goes_through_the_thread_which_opens_a_new_connection() {
    let (display, mut sink, gate) = open_sink();
    drop(gate);
    display.set_direct(|direct| direct.is_full = true);
    sink.send(&[down(1, "A")]).unwrap();
    display.wait_for_lines(1);
    display.set_direct(|direct| direct.is_full = false);
    wait_until_idle(&sink);
    sink.send(&[down(2, "B")]).unwrap();
    sink.close().unwrap();
    assert_eq!(display.lines(), ["+A", "loop: Press B", "-B", "-A"]);
    let state = display.0.lock().unwrap();
    assert_eq!((state.direct.opened, state.direct.closed_ends), (2, 4));
}

#[test]
fn a_press_that_becomes_void_before_it_is_confirmed_is_revoked() {
    let (display, mut sink, gate) = open_sink();
    drop(gate);
    display.set_direct(|direct| direct.is_slow = true);
    sink.send(&[down(1, "A")]).unwrap();
    sink.void_presses();
    wait_until_idle(&sink);
    assert_eq!(sink.dropped_presses(), 1);
    display.set_direct(|direct| direct.is_slow = false);
    sink.send(&[up(2, "A")]).unwrap();
    wait_until_idle(&sink);
    sink.send(&[down(2, "B")]).unwrap();
    wait_until_idle(&sink);
    sink.void_presses();
    sink.send(&[up(3, "B")]).unwrap();
    wait_until_idle(&sink);
    let lines = [
        "loop: Press A",
        "-A",
        "loop: Release A",
        "loop: Press B",
        "loop: Release B",
    ];
    assert_eq!(display.lines(), lines);
    let state = display.0.lock().unwrap();
    assert_eq!((state.direct.opened, state.direct.closed_ends), (2, 2));
}

#[test]
fn the_loop_writes_no_press_after_a_dropped_one() {
    let (display, mut sink, gate) = open_sink();
    drop(gate);
    display.set_direct(|direct| direct.hangs = true);
    sink.send(&[down(1, "ControlLeft")]).unwrap();
    wait_until_idle(&sink);
    display.set_direct(|direct| direct.hangs = false);
    sink.send(&[down(2, "W")]).unwrap();
    sink.close().unwrap();
    assert_eq!(display.lines(), ["loop: Press ControlLeft", "-ControlLeft"]);
    assert_eq!(sink.dropped_presses(), 2);
}
