//! Recordings that are cut off: what every command makes of them.

use super::files::recorded;
use super::{file, run};

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
