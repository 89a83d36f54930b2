//! Markers of cameras as the source of the program, without a glove.

use crate::support::source::marker_lines;
use crate::text_line::pressed_keys;
use crate::{file, run, text};

#[test]
fn a_file_of_markers_is_typed_recorded_and_replayed() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, "markers.jsonl", marker_lines("Hola").concat());
    let source = format!("file:{path}?protocol=markers");
    let keys = ["ShiftLeft", "H", "O", "L", "A"];
    let typed = run(["run", "--source", &source, "--output", "transcript"]).done();
    assert_eq!(pressed_keys(&typed.out), keys, "{}", typed.err);

    let recording = folder.path().join("markers.mcap");
    run(["record", text(&recording), "--source", &source]).done();
    let replayed = run(["replay", text(&recording)]).done();
    assert_eq!(pressed_keys(&replayed.out), keys, "{}", replayed.err);
}
