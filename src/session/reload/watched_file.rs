//! A layout file that may be saved at any time.

use std::fs;
use std::time::{Duration, Instant, SystemTime};

use crate::document::{Document, DocumentError};
use crate::layout::Layout;

/// How long the file has to be left alone before it is read, as saving may take several writes.
const SETTLE_TIME: Duration = Duration::from_millis(50);

/// How long it has to be left alone before it is said to be wrong: some editors empty the file or take
/// it away before they write it.
const ERROR_SETTLE_TIME: Duration = Duration::from_millis(150);

/// A file that is never left alone is read all the same, so often.
const MAX_PENDING_TIME: Duration = Duration::from_secs(2);

/// A file, and what was seen of it so far.
pub(super) struct WatchedFile {
    path: String,
    /// What was in it when it was put in force.
    text: String,
    stamp: Option<Stamp>,
    pending: Option<PendingChange>,
}

/// What a save changes: the length in bytes, the time of the last change, and whether it is a file.
type Stamp = (u64, Option<SystemTime>, bool);

/// A time in which the file was changed and not yet dealt with.
#[derive(Clone, Copy)]
struct PendingChange {
    first: Instant,
    last: Instant,
}

impl WatchedFile {
    /// The file may have been changed since `text` was read from it.
    pub fn new(path: &str, text: &str, now: Instant) -> Self {
        Self {
            path: path.into(),
            text: text.into(),
            stamp: stamp(path),
            pending: Some(PendingChange {
                first: now,
                last: now,
            }),
        }
    }

    /// Where it is.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// What was in it when it was put in force.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// This content is not found again until another one is in force.
    pub fn set_active_text(&mut self, text: &str) {
        self.text = text.into();
    }

    /// Something has happened to the file, so that it has to be read again.
    pub fn mark_changed(&mut self, now: Instant) {
        let first = self.pending.map_or(now, |unrest| unrest.first);
        self.pending = Some(PendingChange { first, last: now });
    }

    /// Whether all that was seen to happen to the file was dealt with.
    pub fn is_settled(&self) -> bool {
        self.pending.is_none()
    }

    /// Looks at the file; what is in it once it is left alone, if that is something else than what is in
    /// force.
    pub fn poll(&mut self, now: Instant) -> Option<Result<Layout, DocumentError>> {
        let stamp = stamp(&self.path);
        if stamp != self.stamp {
            self.stamp = stamp;
            self.mark_changed(now);
        }
        let unrest = self.pending?;
        let rest = now - unrest.last;
        let is_overdue = now - unrest.first >= MAX_PENDING_TIME;
        if rest < SETTLE_TIME && !is_overdue {
            return None;
        }
        let found = self.read();
        if matches!(found, Some(Err(_))) && rest < ERROR_SETTLE_TIME && !is_overdue {
            return None;
        }
        self.pending = None;
        found
    }

    /// What is in the file, whether it is left alone or not.
    pub fn read_now(&self) -> Result<Layout, DocumentError> {
        Document::from_path(&self.path).and_then(Layout::from_document)
    }

    fn read(&self) -> Option<Result<Layout, DocumentError>> {
        match Document::from_path(&self.path) {
            Ok(document) if document.text == self.text => None,
            found => Some(found.and_then(Layout::from_document)),
        }
    }
}

fn stamp(path: &str) -> Option<Stamp> {
    let metadata = fs::metadata(path).ok()?;
    Some((metadata.len(), metadata.modified().ok(), metadata.is_file()))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use std::fs::File;
    use std::path::PathBuf;
    use tempfile::TempDir;

    /// A file that is watched by a clock of the test's own.
    struct Bench {
        folder: TempDir,
        file: WatchedFile,
        start: Instant,
        now_ms: u64,
        saves: u64,
    }

    /// A layout of one key.
    pub fn text(key: &str) -> String {
        format!(
            "Layout(name: \"{key}\", boards: [(\n    pose: (anchor: elbow),\n    rows: [(at_mm: (0, 0), keys: \"{key}\")],\n)])\n"
        )
    }

    /// What was found: the name of the layout, or the error.
    type Found = Vec<(u64, Result<String, String>)>;

    impl Bench {
        /// The layout of the key A is in force and in the file.
        fn new() -> Self {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("a.ron");
            let start = Instant::now();
            fs::write(&path, text("A")).unwrap();
            let file = WatchedFile::new(path.to_str().unwrap(), &text("A"), start);
            let mut bench = Self {
                folder,
                file,
                start,
                now_ms: 0,
                saves: 0,
            };
            assert_eq!(bench.look_for(1_000), []);
            bench
        }

        fn path(&self) -> PathBuf {
            self.folder.path().join("a.ron")
        }

        fn save(&mut self, text: &str) {
            self.write(&self.path(), text);
        }

        /// Each write has a time of its own, however fast the test is.
        fn write(&mut self, path: &std::path::Path, text: &str) {
            fs::write(path, text).unwrap();
            self.saves += 1;
            let time = SystemTime::UNIX_EPOCH + Duration::from_secs(self.saves);
            let file = File::options().write(true).open(path).unwrap();
            file.set_modified(time).unwrap();
        }

        /// Looks every 50 ms for so long; what was found and when, in ms from now.
        fn look_for(&mut self, milliseconds: u64) -> Found {
            let from = self.now_ms;
            let mut found = Found::new();
            while self.now_ms < from + milliseconds {
                self.now_ms += 50;
                let now = self.start + Duration::from_millis(self.now_ms);
                if let Some(outcome) = self.file.poll(now) {
                    let outcome = outcome.map(|layout| {
                        self.file.set_active_text(&layout.text);
                        layout.name
                    });
                    found.push((
                        self.now_ms - from,
                        outcome.map_err(|error| error.to_string()),
                    ));
                }
            }
            found
        }
    }

    fn in_force(after_ms: u64, name: &str) -> Found {
        vec![(after_ms, Ok(name.into()))]
    }

    /// The only thing that was found: an error, without the folder.
    fn error(found: Found, folder: &TempDir) -> (u64, String) {
        let [(after_ms, Err(error))] = found.as_slice() else {
            panic!("{found:?}");
        };
        let folder = format!("{}/", folder.path().display());
        (*after_ms, error.replace(&folder, ""))
    }

    #[test]
    fn a_file_that_is_saved_is_found_at_the_second_look() {
        let mut bench = Bench::new();
        bench.save(&text("B"));
        assert_eq!(bench.look_for(1_000), in_force(100, "B"));
    }

    #[test]
    fn a_file_that_takes_the_place_of_the_old_one_is_found() {
        let mut bench = Bench::new();
        let other = bench.folder.path().join("a.ron.tmp");
        bench.write(&other, &text("B"));
        assert_eq!(bench.look_for(500), []);
        fs::rename(other, bench.path()).unwrap();
        assert_eq!(bench.look_for(1_000), in_force(100, "B"));
    }

    #[test]
    fn the_same_content_saved_again_does_nothing() {
        let mut bench = Bench::new();
        bench.save(&text("A"));
        assert_eq!(bench.look_for(1_000), []);
    }

    #[test]
    fn a_change_between_reading_the_file_and_watching_it_is_found() {
        let mut bench = Bench::new();
        let path = bench.path();
        bench.file = WatchedFile::new(path.to_str().unwrap(), &text("Z"), bench.start);
        bench.now_ms = 0;
        assert_eq!(bench.look_for(1_000), in_force(50, "A"));
    }

    #[test]
    fn a_file_that_is_emptied_or_half_written_for_a_moment_is_not_said_to_be_wrong() {
        let mut bench = Bench::new();
        bench.save("");
        assert_eq!(bench.look_for(100), []);
        bench.save(&text("B")[..40]);
        assert_eq!(bench.look_for(150), []);
        bench.save(&text("B"));
        assert_eq!(bench.look_for(1_000), in_force(100, "B"));
    }

    #[test]
    fn a_file_that_stays_wrong_is_told_once_with_its_place() {
        let mut bench = Bench::new();
        bench.save(&text("Entre"));
        let found = bench.look_for(3_000);
        let (after_ms, message) = error(found, &bench.folder);
        assert_eq!(after_ms, 200);
        assert_eq!(
            message,
            "a.ron:3:35: unknown key `Entre`, did you mean `Enter`?\n 3 |     rows: [(at_mm: (0, 0), keys: \"Entre\")],\n   |                                   ^^^^^"
        );
        bench.save(&text("Enter"));
        assert_eq!(bench.look_for(1_000), in_force(100, "Enter"));
    }

    #[test]
    fn a_file_that_is_gone_is_told_and_found_when_it_is_back() {
        let mut bench = Bench::new();
        fs::remove_file(bench.path()).unwrap();
        assert_eq!(bench.look_for(100), []);
        let found = bench.look_for(3_000);
        let (after_ms, message) = error(found, &bench.folder);
        assert_eq!(
            (after_ms, message.as_str()),
            (100, "a.ron: there is no such file")
        );
        bench.save(&text("A"));
        assert_eq!(bench.look_for(1_000), [], "that is in force");
        bench.save(&text("B"));
        assert_eq!(bench.look_for(1_000), in_force(100, "B"));
    }

    #[test]
    fn a_directory_in_the_place_of_the_file_is_told() {
        let mut bench = Bench::new();
        fs::remove_file(bench.path()).unwrap();
        fs::create_dir(bench.path()).unwrap();
        let found = bench.look_for(3_000);
        let (_, message) = error(found, &bench.folder);
        assert_eq!(message, "a.ron: this is a directory, name a file in it");
    }

    #[test]
    fn a_shipped_layout_does_not_take_the_place_of_a_file_that_is_gone() {
        let message = Document::from_path("numpad").unwrap_err().to_string();
        assert_eq!(message, "numpad: there is no such file");
    }

    #[test]
    fn a_hundred_saves_in_a_second_are_found_as_the_last_of_them() {
        let mut bench = Bench::new();
        for save in 0..20 {
            // Five saves between two looks, each time with another name.
            for part in 0..5 {
                bench.save(&text("B").replace("\"B\",", &format!("\"{save} {part}\",")));
            }
            assert_eq!(bench.look_for(50), []);
        }
        assert_eq!(bench.look_for(1_000), in_force(50, "19 4"));
    }

    #[test]
    fn a_file_that_never_comes_to_rest_is_found_every_two_seconds() {
        let mut bench = Bench::new();
        let mut found = Found::new();
        for save in 0..100 {
            bench.save(&text("B").replace("\"B\",", &format!("\"{save}\",")));
            found.extend(bench.look_for(50));
        }
        let found: Vec<_> = found.into_iter().map(|(_, name)| name.unwrap()).collect();
        assert_eq!(found, ["40", "81"]);
    }
}
