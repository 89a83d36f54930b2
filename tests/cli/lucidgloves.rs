//! A LucidGloves build as the source of the program.

use ademan::capture::protocol::lucidgloves::Fields;

use crate::support::lucidgloves::{RATE_HZ, chords};
use crate::text_line::pressed_keys;
use crate::{file, run, text};

const KEYS: [&str; 4] = ["H", "O", "D", "A"];

#[test]
fn lines_of_a_glove_are_typed_traced_recorded_and_replayed() {
    let folder = tempfile::tempdir().unwrap();
    let lines: String = chords().iter().map(Fields::encode).collect();
    let path = file(&folder, "glove.txt", lines);
    let source = format!("file:{path}?protocol=lucidgloves&rate_hz={RATE_HZ}");
    let source = ["--source", &source, "--layout", "chords-five"];
    let command = |name: &'static str| [&[name], &source[..]].concat();
    let typed = run(command("run")).done();
    assert_eq!(pressed_keys(&typed.out), KEYS, "{}", typed.err);

    for (stage, part) in [
        ("readings", r#""full_scale":4095,"channels":[0,0,0"#),
        ("angles", r#""elbow-flexion":0.6"#),
        ("pose", r#""index-finger-tip":"#),
    ] {
        let traced = run([&["trace", stage], &source[..]].concat()).done();
        let first = traced.out.lines().next().unwrap_or_default();
        assert!(first.contains(part), "{first}");
    }

    let recording = folder.path().join("glove.mcap");
    run([&["record", text(&recording)], &source[..]].concat()).done();
    let replayed = run(["replay", text(&recording)]).done();
    assert_eq!(pressed_keys(&replayed.out), KEYS, "{}", replayed.err);
}
