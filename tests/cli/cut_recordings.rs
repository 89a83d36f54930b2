//! Recordings that are cut off: what every command makes of them.

use super::files::recorded;
use super::{file, run, text};

#[test]
fn a_recording_that_is_cut_before_its_first_reading_names_the_cut() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = std::fs::read(recorded(&folder)).unwrap();
    for length in [1, 100, 3000, 50_000] {
        let cut = file(&folder, "cut.mcap", &bytes[..length]);
        let ended = run(["replay", &cut]);
        assert_eq!(ended.code, Some(3), "{length}: {}", ended.err);
        let place = "the recording is cut off at byte ";
        assert!(ended.err.contains(place), "{length}: {}", ended.err);
        assert!(!ended.err.contains("protocol"), "{length}: {}", ended.err);
    }
}

#[test]
fn every_command_uses_a_recording_up_to_its_cut_and_fails() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = std::fs::read(recorded(&folder)).unwrap();
    let path = |name: &str| text(&folder.path().join(name)).to_owned();
    let (poses, copy) = (path("hand.bvh"), path("copy.mcap"));
    let early = file(&folder, "early.mcap", &bytes[..3000]);
    let half = file(&folder, "half.mcap", &bytes[..bytes.len() / 2]);
    for (cut, arguments) in [
        (&early, &["trace", "angles"][..]),
        (&early, &["run", "--control", "off"]),
        (&half, &["trace", "angles"]),
        (&half, &["trace", "--stats"]),
        (&half, &["export", &poses]),
        (&half, &["record", &copy]),
        (&half, &["run", "--control", "off"]),
    ] {
        let source = format!("recording:{cut}");
        let ended = run([arguments, &["--source", &source]].concat());
        assert_eq!(ended.code, Some(3), "{arguments:?}: {}", ended.err);
        let place = "the recording is cut off at byte ";
        assert!(ended.err.contains(place), "{arguments:?}: {}", ended.err);
        let is_silent = cut == &early || matches!(arguments[0], "export" | "record");
        assert_eq!(ended.out.is_empty(), is_silent, "{arguments:?}");
    }
    assert!(std::fs::read_to_string(poses).unwrap().contains("MOTION"));
    assert!(!run(["replay", &copy]).done().out.is_empty());
}
