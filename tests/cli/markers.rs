//! Markers of cameras as the source of the program, without a glove.

use crate::file;
use crate::support::source::marker_lines;
use crate::text_line::assert_typed_and_replayed;

#[test]
fn a_file_of_markers_is_typed_recorded_and_replayed() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, "markers.jsonl", marker_lines("Hola").concat());
    let source = format!("file:{path}?protocol=markers");
    let keys = ["ShiftLeft", "H", "O", "L", "A"];
    assert_typed_and_replayed(&["--source", &source], &keys);
}
