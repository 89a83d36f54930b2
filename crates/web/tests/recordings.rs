//! Recordings of `ademan record` in the session of the page: one of each kind of source, in `tests/recordings` of the project.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use ademan_core::document::Document;
use ademan_web::{HandState, PageSession};
use serde_json::Value;

const FRAME: Duration = Duration::from_micros(16_667);

fn session() -> PageSession {
    let layout = Document::shipped("numpad").expect("a shipped layout");
    PageSession::new(&layout.text).expect("a valid layout")
}

fn recordings() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/recordings");
    let files = fs::read_dir(folder).expect("the folder").flatten();
    let paths = files.map(|file| file.path());
    paths
        .filter(|path| path.extension().is_some_and(|it| it == "mcap"))
        .collect()
}

fn read(name: &str) -> Vec<u8> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/recordings");
    fs::read(folder.join(name)).expect("a recording")
}

/// Plays a recording on its layout for a time. Returns the keys that are pressed.
fn pressed(session: &mut PageSession, recording: &[u8]) -> Vec<String> {
    let played = session.play_recording(recording).expect("a recording");
    assert_eq!(played.refused, None);
    assert!(played.readings > 20, "{}", played.readings);
    session.set_layout(&played.layout.expect("its layout"));
    assert_eq!(session.hand_state(), HandState::Followed);
    let mut pressed = Vec::new();
    for _ in 0..60 * 20 {
        let lines = session.advance(FRAME);
        let objects = lines
            .lines()
            .map(|line| -> Value { serde_json::from_str(line).expect("an object") });
        let downs = objects.filter(|it| it["kind"] == "events" && it["event"] == "key-down");
        pressed.extend(downs.map(|it| it["key"].as_str().expect("a key").to_owned()));
    }
    pressed
}

#[test]
fn a_recording_presses_the_keys_that_the_program_pressed() {
    let mut session = session();
    let recordings = recordings();
    assert!(recordings.len() >= 13, "{recordings:?}");
    for path in recordings {
        let transcript = fs::read_to_string(path.with_extension("out")).expect("its transcript");
        let expected = transcript
            .lines()
            .filter_map(|line| line.split_once("down "));
        let expected: Vec<_> = expected.map(|(_, key)| key.to_owned()).collect();
        assert!(!expected.is_empty());
        let bytes = fs::read(&path).expect("a recording");
        assert_eq!(
            pressed(&mut session, &bytes),
            expected,
            "{}",
            path.display()
        );
    }
}

#[test]
fn the_hands_of_the_page_type_on_after_a_recording() {
    let mut session = session();
    pressed(&mut session, &read("hc11.mcap"));
    session.clear_text();
    let layout = Document::shipped("qwerty-flat").expect("a shipped layout");
    session.set_layout(&layout.text);
    assert!(session.type_text("hello").is_empty());
    for _ in 0..60 * 10 {
        session.advance(FRAME);
    }
    assert_eq!(session.text(), "hello");
}

#[test]
fn what_is_no_recording_changes_nothing_and_a_cut_one_plays_its_start() {
    let mut session = session();
    let whole = read("openxr.mcap");
    for (bytes, part) in [
        (&b"HIERARCHY"[..], "it is not an MCAP file"),
        (b"", "the file is empty"),
        (&whole[..8], "the file ends without an end mark"),
        (&whole[..2000], "bytes into a record"),
    ] {
        let error = session.play_recording(bytes).expect_err(part);
        assert!(error.contains(part), "{error}");
        assert_eq!(session.hand_state(), HandState::Resting);
    }
    let cut = session.play_recording(&whole[..whole.len() * 2 / 3]);
    let cut = cut.expect("its first seconds");
    assert!(cut.readings > 20, "{}", cut.readings);
    assert!(cut.refused.is_some_and(|it| it.contains("ends")));
    session.release();
    assert_eq!(session.hand_state(), HandState::Resting);
}
