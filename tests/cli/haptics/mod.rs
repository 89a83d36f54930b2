//! Feedback to a LucidGloves glove, over each line that it may be connected by.

mod glove;

use std::thread;
use std::time::Duration;

use ademan::hand::Finger;
use ademan::session::control_socket::Client;
use crossbeam_channel::Receiver;
use tempfile::TempDir;

use self::glove::{CARRIERS, Carrier, Glove};
use crate::support::process::{Process, signal};
use crate::support::run::{ARMED, TIMEOUT, next_event, start_with_lines};

/// Keys at the fingertips of a half-bent hand.
const LAYOUT: &str = r#"Layout(
    name: "Five keys",
    description: "a key under each fingertip",
    boards: [(
        pose: (anchor: wrist, bearing_deg: 35, forward_mm: 120, height_mm: -50),
        pitch_mm: 15,
        size_mm: Box(13, 30),
        keys: [
            (name: "M", code: "T", finger: "middle", at_mm: (-10, 27)),
            (name: "R", code: "A", finger: "ring", at_mm: (5, 21)),
        ],
    )],
)"#;

/// A curl at which the ring finger is on its pressed key.
const PRESSED: f64 = 0.3;

/// A line of feedback that frees all fingers.
const FREE: &str = "A0B0C0D0E0";

/// A program that reads a glove.
struct Run {
    program: Process,
    glove: Glove,
    events: Receiver<String>,
    messages: Receiver<String>,
    folder: TempDir,
}

impl Run {
    /// Starts the program and waits until it is armed.
    fn start(glove: Glove, arguments: &[&str]) -> Self {
        // A busy machine that delays lines must not end the press.
        Self::with_setup(glove, "stall_timeout_ms: 10000", arguments)
    }

    fn with_setup(glove: Glove, fields: &str, arguments: &[&str]) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(folder.path().join("my.ron"), LAYOUT).expect("a file");
        let setup = format!("Setup(layout: \"my.ron\", role: Both, {fields})");
        std::fs::write(folder.path().join("setup.ron"), setup).expect("a file");
        let mut command = crate::ademan(["run", "setup.ron", "--control", "c.sock"]);
        command
            .args(["--source", &glove.source])
            .args(arguments)
            .current_dir(folder.path());
        let (program, events, messages) = start_with_lines(&mut command);
        let run = Self {
            program,
            glove,
            events,
            messages,
            folder,
        };
        run.wait_for_message(ARMED);
        run
    }

    fn wait_for_message(&self, text: &str) {
        loop {
            let line = self.messages.recv_timeout(TIMEOUT);
            if line.expect("a message").contains(text) {
                return;
            }
        }
    }

    fn press(&self) {
        // Longer than the debounce time of the keys.
        std::thread::sleep(Duration::from_millis(60));
        self.glove.curl(Finger::Ring, PRESSED);
        assert_eq!(next_event(&self.events), "down A");
    }

    fn lift(&self) {
        self.glove.curl(Finger::Ring, 0.0);
        assert_eq!(next_event(&self.events), "up A");
    }

    fn signal(&self, name: &str) {
        signal(name, self.program.0.id());
    }

    fn pause(&self) {
        let path = self.folder.path().join("c.sock");
        let mut client = Client::connect(&path).expect("the session listens");
        let answer = client.request(r#"{"command":"pause"}"#);
        assert!(answer.expect("an answer").contains("true"));
    }
}

/// Returns the value of the ring finger of a line in which the others are free.
fn ring_force(line: &str) -> Option<u32> {
    let rest = line.strip_prefix("A0B0C0D")?.strip_suffix("E0")?;
    rest.parse().ok()
}

/// Asserts that the ring finger is held where it pressed: beyond that curl, and not at the end of the range.
fn assert_held(line: &str) {
    let force = ring_force(line);
    let range = 1000 - (1000.0 * PRESSED) as u32 - 50..950;
    assert!(force.is_some_and(|force| range.contains(&force)), "{line}");
}

#[test]
fn a_finger_that_presses_is_held_until_it_releases() {
    for carrier in CARRIERS {
        let run = Run::start(Glove::start(carrier), &["--haptics", "force"]);
        assert_eq!(run.glove.next_feedback(), FREE, "{carrier:?}");
        for _ in 0..2 {
            run.press();
            assert_held(&run.glove.next_feedback());
            run.lift();
            assert_eq!(run.glove.next_feedback(), FREE, "{carrier:?}");
        }
        run.signal("TERM");
    }
}

#[test]
fn a_glove_of_the_legacy_encoding_is_told_forces_in_that_encoding() {
    let run = Run::start(Glove::start_legacy(), &["--haptics", "force"]);
    let free = "0&0&0&0&0";
    let mut first = run.glove.next_feedback();
    if first == FREE {
        // Before the first reading nothing tells the encoding.
        first = run.glove.next_feedback();
    }
    assert_eq!(first, free);
    for _ in 0..2 {
        run.press();
        let held = run.glove.next_feedback();
        let force = held.strip_prefix("0&0&0&");
        let force = force.and_then(|rest| rest.strip_suffix("&0"));
        assert_held(&format!("A0B0C0D{}E0", force.expect("five numbers")));
        run.lift();
        assert_eq!(run.glove.next_feedback(), free);
    }
}

#[test]
fn a_touch_and_a_press_are_felt_as_pulses() {
    for carrier in CARRIERS {
        assert!((0..5).any(|_| are_felt(carrier)), "{carrier:?}");
    }
}

/// Checks the pulses of a slow press. Returns `false` if a busy machine has moved the finger on so fast that its touch had no pulse of
/// its own.
fn are_felt(carrier: Carrier) -> bool {
    let run = Run::start(Glove::start(carrier), &["--haptics", "pulse"]);
    let [off, touch, press] = ["F0.00G0.00H0.00", "F160.00G0.02H0.40", "F160.00G0.03H1.00"];
    assert_eq!(run.glove.next_feedback(), off, "{carrier:?}");
    // The finger is so slow that the pulse of the touch ends before the pulse of the press.
    let mut steps = 1..100;
    let mut next_pulse = || {
        while run.glove.feedback.is_empty()
            && let Some(step) = steps.next()
        {
            run.glove.curl(Finger::Ring, 0.004 * f64::from(step));
            thread::sleep(Duration::from_millis(50));
        }
        run.glove.next_feedback()
    };
    let first = next_pulse();
    if first == press {
        return false;
    }
    assert_eq!(first, touch, "{carrier:?}");
    assert_eq!(next_pulse(), press, "{carrier:?}");
    assert_eq!(next_event(&run.events), "down A");
    run.lift();
    assert_eq!(run.glove.next_feedback(), off, "{carrier:?}");
    true
}

#[test]
fn force_and_pulses_come_in_lines_of_their_own_and_the_forces_last() {
    let run = Run::start(Glove::start(Carrier::Tcp), &["--haptics", "both"]);
    assert_eq!(run.glove.next_feedback(), "F0.00G0.00H0.00");
    assert_eq!(run.glove.next_feedback(), FREE);
    run.press();
    let mut lines = Vec::new();
    while ring_force(lines.last().map_or("", String::as_str)).is_none_or(|force| force == 0) {
        lines.push(run.glove.next_feedback());
    }
    assert_held(lines.last().expect("a line"));
    assert_eq!(lines[lines.len() - 2], "F160.00G0.03H1.00");
}

#[test]
fn all_fingers_are_free_after_every_way_to_stop() {
    type Stop = fn(&Run);
    let ways: [(&str, Stop); 8] = [
        ("pause", Run::pause),
        ("emergency stop", |run| run.signal("USR1")),
        ("interrupt", |run| run.signal("INT")),
        ("end", |run| run.signal("TERM")),
        ("hang-up", |run| run.signal("HUP")),
        ("suspend", |run| run.signal("TSTP")),
        ("reload", |run| {
            let text = LAYOUT.replace("name: \"R\"", "name: \"S\"");
            std::fs::write(run.folder.path().join("my.ron"), text).expect("a file");
        }),
        ("stall", |run| run.glove.fall_silent()),
    ];
    for (name, stop) in ways {
        for carrier in CARRIERS {
            let fields = match name {
                "stall" => "stall_timeout_ms: 1000",
                _ => "stall_timeout_ms: 10000",
            };
            let glove = Glove::start(carrier);
            let run = Run::with_setup(glove, fields, &["--haptics", "force"]);
            assert_eq!(run.glove.next_feedback(), FREE);
            run.press();
            assert_held(&run.glove.next_feedback());
            stop(&run);
            assert_eq!(next_event(&run.events), "up A", "{name}");
            let line = run.glove.next_feedback();
            assert_eq!(line, FREE, "{name} over {carrier:?}");
            if name == "suspend" {
                run.signal("CONT");
            }
        }
    }
}

#[test]
fn a_finger_is_not_held_for_more_than_two_seconds() {
    let run = Run::start(Glove::start(Carrier::Tcp), &["--haptics", "force"]);
    assert_eq!(run.glove.next_feedback(), FREE);
    run.press();
    assert_held(&run.glove.next_feedback());
    assert_eq!(run.glove.next_feedback(), FREE);
    assert!(run.events.is_empty(), "the key is still down");
    run.lift();
}

#[test]
fn a_glove_that_comes_back_is_freed_and_held_again() {
    let run = Run::start(Glove::start(Carrier::Tcp), &["--haptics", "force"]);
    assert_eq!(run.glove.next_feedback(), FREE);
    run.press();
    assert_held(&run.glove.next_feedback());
    run.glove.hang_up();
    assert_eq!(next_event(&run.events), "up A");
    run.glove.curl(Finger::Ring, 0.0);
    run.wait_for_message(ARMED);
    assert_eq!(run.glove.next_feedback(), FREE);
    run.press();
    assert_held(&run.glove.next_feedback());
}

#[test]
fn a_glove_that_never_reads_delays_no_key_and_no_end() {
    let mut run = Run::start(Glove::start_deaf(), &["--haptics", "both"]);
    for _ in 0..3 {
        run.press();
        run.lift();
    }
    run.press();
    run.signal("TERM");
    assert_eq!(next_event(&run.events), "up A");
    let ended = run.program.0.wait().expect("it ends");
    assert_eq!(ended.code(), Some(0));
}

#[test]
fn nothing_is_written_unless_it_is_asked_for() {
    let cases: [(&str, &[&str]); 2] = [("", &[]), ("haptics: Force", &["--haptics", "off"])];
    for (fields, arguments) in cases {
        let fields = format!("stall_timeout_ms: 10000, {fields}");
        let run = Run::with_setup(Glove::start(Carrier::Serial), &fields, arguments);
        run.press();
        run.lift();
        // Time for a line that must not come.
        thread::sleep(Duration::from_millis(300));
        assert!(run.glove.feedback.is_empty(), "{arguments:?}");
    }
}

#[test]
fn a_source_that_takes_no_feedback_is_named() {
    let run = crate::run(["run", "--source", "typist:h", "--haptics", "force"]).done();
    run.reported("no feedback: `haptics` is force");
    run.reported("protocol=lucidgloves");
}
