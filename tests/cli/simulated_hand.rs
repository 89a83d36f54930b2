//! The simulated hand of the real binary while its layout file is edited, and its tasks for layouts without letters.

use std::process::Stdio;
use std::thread;
use std::time::Duration;

use ademan::device::{EventKind, KeyCode, OutputEvent};
use ademan::sim::UsTextField;
use ademan::time::Timestamp;

use super::{ademan, file, run, text};
use crate::support::process::Process;
use crate::support::run::{ARMED, TIMEOUT, line_receiver, shipped, start_with_lines};

const MIXER: &str = r#"Layout(name: "My mixer", boards: [(
    pose: (anchor: elbow, bearing_deg: 35, forward_mm: 300, height_mm: -45),
    sliders: [(name: "Fader 1", at_mm: (0, 0), length_mm: 60, output: Axis("LeftX"))],
    knobs: [(name: "Pan", at_mm: (60, 0), diameter_mm: 40, output: ScrollY(24))],
    toggles: [(name: "Mute", at_mm: (-60, 0), size_mm: Box(20, 20), tap: Key("AudioVolumeMute"))],
)])"#;

/// Returns what a text field with a US keymap receives from the events of a transcript.
fn typed<'a>(lines: impl IntoIterator<Item = &'a str>) -> String {
    let mut field = UsTextField::new();
    for line in lines {
        let words: Vec<&str> = line.split_whitespace().collect();
        let kind = match words[..] {
            [_, "down", key] => EventKind::KeyDown(key.parse::<KeyCode>().expect("a key")),
            [_, "up", key] => EventKind::KeyUp(key.parse::<KeyCode>().expect("a key")),
            _ => continue,
        };
        field.handle(&OutputEvent {
            time: Timestamp(0),
            kind,
        });
    }
    field.text().to_owned()
}

#[test]
fn a_text_is_right_although_the_board_moves_by_40_mm_while_it_is_typed() {
    let folder = tempfile::tempdir().unwrap();
    let board = shipped("qwerty-flat");
    let path = file(&folder, "my.ron", &board);
    let words = "The hand follows.";
    let source = format!("typist:{words}");
    let mut command = ademan(["run", "--layout", &path, "--source", &source]);
    let (mut program, events, messages) = start_with_lines(&mut command);
    while messages.recv_timeout(TIMEOUT).expect("it is armed") != ARMED {}
    let mut lines = Vec::new();
    // 300 mm × 8° are 42 mm.
    for bearing in ["43", "27", "35"] {
        thread::sleep(Duration::from_millis(1300));
        lines.push(events.recv_timeout(TIMEOUT).expect("it types"));
        let moved = board.replace("bearing_deg: 35", &format!("bearing_deg: {bearing}"));
        std::fs::write(&path, format!("// {bearing}\n{moved}")).unwrap();
        while !messages
            .recv_timeout(TIMEOUT)
            .expect("the layout is activated")
            .ends_with("active from now on")
        {}
    }
    lines.extend(events.iter());
    assert_eq!(typed(lines.iter().map(String::as_str)), words, "{lines:?}");
    assert!(program.0.wait().expect("it ends").success());
}

#[test]
fn a_layout_without_characters_gets_a_tour() {
    let folder = tempfile::tempdir().unwrap();
    let mixer = file(&folder, "my-mixer.ron", MIXER);
    let demo = run(["demo", "--layout", &mixer, "--fast"]).done();
    for name in ["Fader 1", "Pan", "AudioVolumeMute"] {
        assert!(demo.out.contains("played"), "{name}: {}", demo.out);
    }
    demo.printed("AudioVolumeMute");
    assert!(!demo.out.contains("played     0 events"), "{}", demo.out);
    let script = folder.path().join("tour.txt");
    let script = text(&script);
    let written = run(["script", "new", script, "--from", &mixer]).done();
    written.printed("a tour of");
    let content = std::fs::read_to_string(script).unwrap();
    for name in ["\"Fader 1\"", "Pan", "Mute"] {
        assert!(content.contains(name), "{content}");
    }
    run(["demo", "--layout", &mixer, "--script", script, "--fast"]).done();
}

#[test]
fn the_demo_types_fast_with_either_hand() {
    for hand in ["right", "left"] {
        let layout = "qwerty-two-flat";
        let arguments = ["demo", "--layout", layout, "--text", "Hi you", "--fast"];
        let demo = run(arguments.into_iter().chain(["--hand", hand])).done();
        demo.printed("0.00 % character error rate");
    }
}

#[test]
fn a_repeated_demo_starts_again() {
    let mut command = ademan(["demo", "--layout", "numpad", "--text", "1", "--repeat"]);
    command.args(["--output", "transcript"]);
    command.stdout(Stdio::piped()).stderr(Stdio::null());
    let mut program = Process::start(&mut command).expect("it starts");
    let lines = line_receiver(program.0.stdout.take().expect("it is piped"));
    let mut presses = 0;
    while presses < 3 {
        let line = lines.recv_timeout(TIMEOUT).expect("it types again");
        presses += usize::from(line.contains(" down "));
    }
}

#[test]
fn a_hand_without_keys_to_press_does_not_prevent_typing() {
    let demo = ["demo", "--layout", "qwerty-two-flat", "--fast"];
    let ended = run(demo.into_iter().chain(["--text", "was"])).done();
    ended.printed("typed      \"was\"");
    let played = run(demo.into_iter().chain(["--script", "tap A"])).done();
    played.printed("played     2 events");
}

#[test]
fn a_run_is_armed_although_one_of_its_hands_presses_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let fields = r#"source: "typist:as", other_hand: (), layout: "qwerty-two-flat""#;
    let setup = file(&folder, "setup.ron", format!("Setup({fields})"));
    let mut command = ademan(["run", &setup, "--control", "off"]);
    command.stdout(Stdio::piped()).stderr(Stdio::null());
    let mut program = Process::start(&mut command).expect("it starts");
    let events = line_receiver(program.0.stdout.take().expect("it is piped"));
    events.recv_timeout(TIMEOUT).expect("it types");
    assert!(program.0.wait().expect("it ends").success());
}
