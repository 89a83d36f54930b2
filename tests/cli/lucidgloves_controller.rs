//! The stick, the trigger and the buttons of a glove on a pseudo-terminal, with the layout that makes a mouse of them.
//!
//! The lines are written by the rule of the firmware, and not by our encoder.

use std::io::Write;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;

use crossbeam_channel::Receiver;
use serialport::{SerialPort, TTYPort};

use crate::support::glove::pseudo_terminal;
use crate::support::process::Process;
use crate::support::run::{ARMED, TIMEOUT, next_event, start_with_lines};
use crate::support::x11::wait_for;
use crate::{ademan, file};

/// The time between two lines.
const PERIOD: Duration = Duration::from_millis(10);

/// The count of a stick at rest, which jitters by a few counts.
const REST: i64 = 2047;

/// The inputs of a glove. The hand is straight.
#[derive(Clone)]
struct Inputs {
    /// The stick, to the right and away from the wearer: −1 to 1.
    stick: (f64, f64),
    /// The analogue trigger, 0 to 1.
    trigger: f64,
    /// The letters of the buttons that are down: H stick, I trigger, J A, K B, N menu.
    buttons: &'static str,
    /// The glove sends nothing.
    is_mute: bool,
}

const REST_INPUTS: Inputs = Inputs {
    stick: (0.0, 0.0),
    trigger: 0.0,
    buttons: "",
    is_mute: false,
};

impl Inputs {
    /// Returns the line with the number `index`.
    fn line(&self, index: u64) -> String {
        let jitter = (index % 7) as i64 * 4 - 12;
        let stick = |value: f64| (REST + (value * 2048.0) as i64 + jitter).clamp(0, 4095);
        let (x, y) = (stick(self.stick.0), stick(self.stick.1));
        // The firmware doubles the upper half of the curl, which is one count too much at its end.
        let trigger = (self.trigger * 4096.0) as i64;
        let buttons = self.buttons;
        format!("A12B0C31D4E9F{x}G{y}P{trigger}{buttons}\n")
    }
}

/// The program with a glove on a serial line.
struct Run {
    inputs: Arc<Mutex<Inputs>>,
    /// Number of lines sent.
    lines: Arc<AtomicU64>,
    events: Receiver<String>,
    messages: Receiver<String>,
    _program: Process,
    _port: TTYPort,
    _folder: tempfile::TempDir,
}

impl Run {
    /// Starts with these inputs, and waits until the output is armed.
    fn start(first: Inputs) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        // A busy machine that delays lines must not end a press.
        let setup = "Setup(layout: \"lucidgloves-controller\", stall_timeout_ms: 2000)";
        let setup = file(&folder, "setup.ron", setup);
        let (mut master, port) = pseudo_terminal();
        let inputs = Arc::new(Mutex::new(first));
        let lines = Arc::new(AtomicU64::new(0));
        let (sent, count) = (inputs.clone(), lines.clone());
        thread::spawn(move || {
            for index in 0.. {
                let present = sent.lock().expect("no panic").clone();
                let line = present.line(index);
                if !present.is_mute {
                    if master.write_all(line.as_bytes()).is_err() {
                        return;
                    }
                    count.fetch_add(1, Ordering::Relaxed);
                }
                thread::sleep(PERIOD);
            }
        });
        let name = port.name().expect("a name");
        let source = format!("serial:{name}?protocol=lucidgloves");
        let mut command = ademan(["run", &setup, "--source", &source]);
        let (program, events, messages) = start_with_lines(&mut command);
        let run = Self {
            inputs,
            lines,
            events,
            messages,
            _program: program,
            _port: port,
            _folder: folder,
        };
        run.wait_until_armed();
        run
    }

    fn set(&self, inputs: Inputs) {
        *self.inputs.lock().expect("no panic") = inputs;
    }

    /// Waits until the output is armed, at the start or after a loss.
    fn wait_until_armed(&self) {
        let next = || self.messages.recv_timeout(TIMEOUT).expect("it is armed");
        while next() != ARMED {}
    }

    /// Waits until some lines with the present inputs were sent.
    fn hold(&self) {
        let end = self.lines.load(Ordering::Relaxed) + 10;
        let is_sent = || self.lines.load(Ordering::Relaxed) >= end;
        assert!(wait_for(is_sent), "the glove sends nothing");
    }

    /// Waits for the next press, release, motion or scrolling.
    fn next(&self) -> String {
        loop {
            let event = next_event(&self.events);
            if !event.starts_with("value") {
                return event;
            }
        }
    }

    /// Returns the events up to this one.
    fn until(&self, last: &str) -> Vec<String> {
        let mut events = Vec::new();
        loop {
            let event = self.next();
            if event == last {
                return events;
            }
            events.push(event);
        }
    }

    /// Presses and releases button A, and returns the events between: what moves by itself.
    fn moves_at_rest(&self, others: Inputs) -> (Vec<String>, Vec<String>) {
        self.set(Inputs {
            buttons: "J",
            ..others.clone()
        });
        let before = self.until("down MouseRight");
        self.hold();
        self.set(others);
        (before, self.until("up MouseRight"))
    }
}

/// Returns the sum of the motions or scrolls among events, to the right and down, or to the right and up.
fn sum(events: &[String], word: &str) -> (i64, i64) {
    let numbers = |event: &String| {
        let mut words = event.strip_prefix(word)?.split_whitespace();
        let mut number = || words.next()?.parse::<i64>().ok();
        Some((number()?, number()?))
    };
    let add = |sum: (i64, i64), (x, y): (i64, i64)| (sum.0 + x, sum.1 + y);
    events.iter().filter_map(numbers).fold((0, 0), add)
}

#[test]
fn the_stick_moves_the_pointer_until_it_is_back_at_its_center() {
    let run = Run::start(REST_INPUTS);
    run.set(Inputs {
        stick: (1.0, 0.0),
        ..REST_INPUTS
    });
    let first = run.next();
    assert!(first.starts_with("move +"), "{first}");
    let (moved, at_rest) = run.moves_at_rest(REST_INPUTS);
    assert_eq!(at_rest, [""; 0]);
    let (right, down) = sum(&moved, "move");
    assert!(right >= 0 && down == 0, "{moved:?}");
    run.set(Inputs {
        stick: (0.0, 1.0),
        ..REST_INPUTS
    });
    let up = run.next();
    // The part of a pixel that is left of the way to the right may become whole.
    let is_up = ["+0", "+1"].map(|across| format!("move {across} -"));
    assert!(is_up.iter().any(|way| up.starts_with(way)), "{up}");
}

#[test]
fn the_trigger_and_the_buttons_press_until_they_are_released_or_the_glove_is_lost() {
    let run = Run::start(REST_INPUTS);
    let pulled = Inputs {
        trigger: 1.0,
        ..REST_INPUTS
    };
    run.set(pulled.clone());
    assert_eq!(run.next(), "down MouseLeft");
    run.set(REST_INPUTS);
    assert_eq!(run.next(), "up MouseLeft");
    run.set(Inputs {
        buttons: "H",
        ..REST_INPUTS
    });
    assert_eq!(run.next(), "down Enter");
    run.set(REST_INPUTS);
    assert_eq!(run.next(), "up Enter");
    run.set(pulled.clone());
    assert_eq!(run.next(), "down MouseLeft");
    run.set(Inputs {
        is_mute: true,
        ..pulled.clone()
    });
    assert_eq!(run.next(), "up MouseLeft");
    // A trigger that is still pulled presses nothing again.
    run.set(pulled.clone());
    run.wait_until_armed();
    let (before, _) = run.moves_at_rest(pulled.clone());
    assert_eq!(before, [""; 0]);
    run.set(REST_INPUTS);
    run.moves_at_rest(REST_INPUTS);
    run.set(pulled);
    assert_eq!(run.next(), "down MouseLeft");
}

#[test]
fn the_stick_scrolls_and_presses_arrow_keys_while_a_button_is_held() {
    let run = Run::start(REST_INPUTS);
    run.set(Inputs {
        buttons: "K",
        stick: (0.0, -1.0),
        ..REST_INPUTS
    });
    let scrolled = run.next();
    assert!(scrolled.starts_with("scroll +0 -"), "{scrolled}");
    let (at_rest, _) = run.moves_at_rest(REST_INPUTS);
    assert_eq!(sum(&at_rest, "move"), (0, 0));
    let menu = Inputs {
        buttons: "N",
        ..REST_INPUTS
    };
    let stick = |x: f64, y: f64| Inputs {
        stick: (x, y),
        ..menu.clone()
    };
    run.set(menu.clone());
    let arrows = [
        ((1.0, 0.0), "ArrowRight"),
        ((-1.0, 0.0), "ArrowLeft"),
        ((0.0, 1.0), "ArrowUp"),
        ((0.0, -1.0), "ArrowDown"),
    ];
    for ((x, y), key) in arrows {
        // Wait until the stick was seen at rest while the button is held.
        run.hold();
        run.set(stick(x, y));
        assert_eq!(run.next(), format!("down {key}"));
        run.set(menu.clone());
        assert_eq!(run.next(), format!("up {key}"));
    }
    run.hold();
    run.set(stick(1.0, 0.0));
    assert_eq!(run.next(), "down ArrowRight");
    run.set(Inputs {
        buttons: "",
        ..stick(1.0, 0.0)
    });
    assert_eq!(run.next(), "up ArrowRight", "the button is released");
}

#[test]
fn a_stick_that_is_off_its_center_at_the_start_moves_nothing() {
    let stuck = Inputs {
        stick: (1.0, 0.0),
        ..REST_INPUTS
    };
    let run = Run::start(stuck.clone());
    let (before, at_rest) = run.moves_at_rest(stuck.clone());
    assert_eq!((before, at_rest), (Vec::new(), Vec::new()));
    let (recovered, _) = run.moves_at_rest(REST_INPUTS);
    assert_eq!(recovered, [""; 0]);
    run.set(stuck);
    let moved = run.next();
    assert!(moved.starts_with("move +"), "{moved}");
}
