//! Lines of LucidGloves, from their decoder to keys, axes and commands.

use ademan::capture::Reading;
use ademan::capture::protocol::Decoder;
use ademan::capture::protocol::lucidgloves::{Button, FULL_SCALE, Fields, decoder};
use ademan::device::{EventKind, Events};
use ademan::hand::Finger;
use ademan::pipeline::{Pipeline, PipelineState};
use ademan::setup::Setup;
use ademan::sim::UsTextField;
use ademan::time::Timestamp;

use crate::support::lucidgloves::{RATE_HZ, TEXT, chords, curls, taps};

/// A layout of the stick, the trigger and the buttons of a glove, without a board.
const INPUTS: &str = r#"Layout(name: "inputs", triggers: [
    (name: "X", when: Input(name: "stick-x", zero: 0, full: 1), output: Axis("LeftX")),
    (name: "Left", when: Input(name: "stick-x", on: -0.5, off: -0.3), action: Key("A")),
    (name: "Right", when: Input(name: "stick-x", on: 0.5, off: 0.3), action: Key("D")),
    (name: "Pull", when: Input(name: "trigger", zero: 0, full: 1), output: Axis("RightTrigger")),
    (name: "Enter", when: Input(name: "button-a"), action: Key("Enter")),
    (name: "Pause", when: Input(name: "menu"), action: Command("toggle-pause")),
])"#;

/// A pipeline fed with lines at [`RATE_HZ`].
struct Glove {
    pipeline: Pipeline,
    decoder: Box<dyn Decoder>,
    lines: u64,
    events: Events,
}

impl Glove {
    fn with_layout(layout: &str) -> Self {
        let setup = Setup {
            source: Some("file:glove?protocol=lucidgloves".parse().expect("a source")),
            layout: layout.to_owned(),
            ..Setup::default()
        };
        Self {
            pipeline: setup.load_files().expect("a valid setup").pipeline(),
            decoder: Box::new(decoder(FULL_SCALE)),
            lines: 0,
            events: Events::new(),
        }
    }

    /// The layout of the inputs, armed.
    fn with_inputs() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("inputs.ron");
        std::fs::write(&path, INPUTS).expect("a layout");
        let mut glove = Self::with_layout(&path.display().to_string());
        for _ in 0..50 {
            assert_eq!(glove.send(&still()), "");
        }
        assert_eq!(glove.pipeline.state(), PipelineState::Running);
        glove
    }

    /// Sends a line; returns its events without values and depths.
    fn send(&mut self, fields: &Fields) -> String {
        self.events.clear();
        self.lines += 1;
        let time = Timestamp::from_seconds(self.lines as f64 / RATE_HZ);
        let (pipeline, events) = (&mut self.pipeline, &mut self.events);
        self.decoder
            .push(fields.encode().as_bytes(), &mut |packet| {
                let reading = Reading::new(time, packet.side, packet.sample);
                let _ = pipeline.step(&reading, events);
            });
        self.transcript()
    }

    fn transcript(&self) -> String {
        let event = |kind: &EventKind| match kind {
            EventKind::KeyDown(key) => Some(format!("down {key}")),
            EventKind::KeyUp(key) => Some(format!("up {key}")),
            EventKind::Axis(axis, value) => Some(format!("{axis} {value:.2}")),
            _ => None,
        };
        let events = self.events.iter().filter_map(|sent| event(&sent.kind));
        events.collect::<Vec<_>>().join(", ")
    }
}

fn still() -> Fields {
    curls([0.0; Finger::COUNT])
}

fn with_stick(position: i64) -> Fields {
    Fields {
        stick: [Some(position), Some(2047)],
        ..still()
    }
}

fn with_button(button: Button) -> Fields {
    let mut fields = still();
    fields.buttons[button as usize] = true;
    fields
}

/// Types the lines with `chords-bend`; returns the text and the number of keys that are still down.
fn typed(lines: &[Fields]) -> (String, usize) {
    let mut glove = Glove::with_layout("chords-bend");
    let mut field = UsTextField::new();
    for line in lines {
        glove.send(line);
        glove.events.iter().for_each(|event| field.handle(event));
    }
    (field.text().to_owned(), field.pressed().count())
}

#[test]
fn a_glove_that_measures_curls_types_chords() {
    assert_eq!(typed(&chords()), (TEXT.to_owned(), 0));
}

#[test]
fn a_straight_finger_is_no_broken_wire() {
    let mut lines = vec![still(); 300];
    lines.extend(chords());
    assert_eq!(typed(&lines), (TEXT.to_owned(), 0));
}

#[test]
fn a_finger_that_the_glove_does_not_send_presses_nothing_and_the_others_type() {
    let mut lines = taps(&[&[Finger::Index], &[Finger::Middle], &[Finger::Ring]]);
    for line in &mut lines {
        line.curls[Finger::Middle.index()] = None;
    }
    assert_eq!(typed(&lines), ("ea".to_owned(), 0));
}

#[test]
fn a_finger_that_vanishes_while_it_is_bent_releases_its_key() {
    let mut lines = taps(&[&[Finger::Index]]);
    let bent = |line: &Fields| line.curls[Finger::Index.index()] > Some(3000);
    let held = *lines.iter().find(|line| bent(line)).expect("a bent finger");
    let last = lines.iter().rposition(bent).expect("a bent finger");
    lines.truncate(last);
    lines.extend([held; 30]);
    assert_eq!(typed(&lines).1, 1, "the key is down");
    let mut lost = held;
    lost.curls[Finger::Index.index()] = None;
    lines.push(lost);
    assert_eq!(typed(&lines).1, 0);
    lines.extend([held; 30]);
    assert_eq!(typed(&lines).1, 0, "it has not been straight since");
}

#[test]
fn the_stick_drives_an_axis_and_keys() {
    let mut glove = Glove::with_inputs();
    assert_eq!(glove.send(&with_stick(2047 + 820)), "LeftX 0.40");
    assert_eq!(glove.send(&with_stick(4095)), "LeftX 1.00, down D");
    assert_eq!(glove.send(&with_stick(0)), "LeftX -1.00, up D, down A");
    assert_eq!(glove.send(&with_stick(2047)), "LeftX 0.00, up A");
}

#[test]
fn the_trigger_drives_an_axis_and_a_button_a_key() {
    let mut glove = Glove::with_inputs();
    let pulled = Fields {
        trigger: Some(4096),
        ..still()
    };
    assert_eq!(glove.send(&pulled), "RightTrigger 1.00");
    assert_eq!(glove.send(&still()), "RightTrigger 0.00");
    assert_eq!(glove.send(&with_button(Button::A)), "down Enter");
    assert_eq!(glove.send(&with_button(Button::A)), "");
    assert_eq!(glove.send(&still()), "up Enter");
}

#[test]
fn the_menu_button_pauses_and_resumes() {
    let mut glove = Glove::with_inputs();
    glove.send(&with_stick(4095));
    let both = Fields {
        stick: with_stick(4095).stick,
        ..with_button(Button::Menu)
    };
    assert_eq!(glove.send(&both), "up D, LeftX 0.00");
    assert_eq!(glove.pipeline.state(), PipelineState::Paused);
    assert_eq!(glove.send(&still()), "");
    assert_eq!(glove.send(&with_button(Button::A)), "");
    assert_eq!(glove.send(&still()), "");
    glove.send(&with_button(Button::Menu));
    assert!(!glove.pipeline.is_paused());
}

#[test]
fn inputs_are_released_at_a_stall_and_at_the_end() {
    type Ending = fn(&mut Pipeline, &mut Events);
    let endings: [Ending; 2] = [Pipeline::stall, Pipeline::stop];
    for ending in endings {
        let mut glove = Glove::with_inputs();
        let held = Fields {
            stick: [Some(0), Some(2047)],
            trigger: Some(4095),
            ..with_button(Button::A)
        };
        glove.send(&held);
        glove.events.clear();
        ending(&mut glove.pipeline, &mut glove.events);
        let mut released: Vec<String> = glove.transcript().split(", ").map(str::to_owned).collect();
        released.sort();
        assert_eq!(
            released,
            ["LeftX 0.00", "RightTrigger 0.00", "up A", "up Enter"]
        );
        assert_eq!(glove.send(&held), "", "a held button presses nothing again");
    }
}

#[test]
fn a_line_without_a_finger_changes_nothing() {
    let mut glove = Glove::with_inputs();
    assert_eq!(glove.send(&with_button(Button::A)), "down Enter");
    let nothing = Fields {
        curls: [None; Finger::COUNT],
        ..still()
    };
    assert_eq!(glove.send(&nothing), "");
    assert_eq!(glove.send(&still()), "up Enter");
}
