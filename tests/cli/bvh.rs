//! Motion capture files: the poses of a hand are exported, typed, recorded and replayed.

use crate::text_line::pressed_keys;
use crate::{file, run, text};

const KEYS: [&str; 4] = ["H", "O", "L", "A"];

#[test]
fn an_exported_hand_is_typed_recorded_and_replayed() {
    let folder = tempfile::tempdir().unwrap();
    let exported = folder.path().join("hand.bvh");
    let exported = text(&exported);
    let export = ["export", exported, "--source", "typist:hola", "--rate-hz"];
    let export = run(export.into_iter().chain(["174.5454545"])).done();
    assert!(export.err.contains("frames written to"), "{}", export.err);

    let source = format!("file:{exported}?protocol=bvh");
    let typed = run(["run", "--source", &source, "--output", "transcript"]).done();
    assert_eq!(pressed_keys(&typed.out), KEYS, "{}", typed.err);

    let recording = folder.path().join("hand.mcap");
    run(["record", text(&recording), "--source", &source]).done();
    let replayed = run(["replay", text(&recording)]).done();
    assert_eq!(pressed_keys(&replayed.out), KEYS, "{}", replayed.err);
}

#[test]
fn an_existing_file_is_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, "hand.bvh", "mine");
    let ended = run(["export", &path, "--source", "typist:hi"]);
    assert_eq!(ended.code, Some(2), "{}", ended.err);
    assert!(ended.err.contains("it exists"), "{}", ended.err);
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "mine");
}

#[test]
fn a_damaged_file_is_refused_with_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(
        &folder,
        "bad.bvh",
        "HIERARCHY\nROOT Hips\n{\n  OFFSET 0 0\n}\n",
    );
    let source = format!("file:{path}?protocol=bvh");
    let ended = run(["run", "--source", &source, "--output", "transcript"]);
    assert_ne!(ended.code, Some(0), "{}", ended.err);
    assert!(
        ended
            .err
            .contains("line 5: an offset is three finite numbers"),
        "{}",
        ended.err
    );
}
