//! A layout file that an editor may save at any time.

use std::fs;
use std::time::{Duration, Instant, SystemTime};

use crate::files::OpenDocument;
use ademan_core::document::{Document, DocumentError};
use ademan_core::layout::{Fit, Layout};

/// Time without changes before the file is read, since saving may take several writes.
const SETTLE_TIME: Duration = Duration::from_millis(50);

/// Time without changes before the file is reported as invalid: some editors empty or remove the file before they write
/// it.
const ERROR_SETTLE_TIME: Duration = Duration::from_millis(150);

/// Time after which a file that keeps changing is read anyway.
const MAX_PENDING_TIME: Duration = Duration::from_secs(2);

/// A file and its detected changes.
pub(super) struct WatchedFile {
    path: String,
    /// Content of the active layout.
    text: String,
    /// The hands of the setup.
    fit: Fit,
    stamp: Option<Stamp>,
    pending: Option<PendingChange>,
    /// `true` if the content that was read last could not be used. Its error was reported.
    is_refused: bool,
}

/// The metadata that a save changes: length in bytes, modification time, and whether it is a file.
type Stamp = (u64, Option<SystemTime>, bool);

/// A series of changes that have not been handled yet: the times of the first and the last one.
#[derive(Clone, Copy)]
struct PendingChange {
    first: Instant,
    last: Instant,
}

impl WatchedFile {
    /// Creates the entry of a file from which `text` was read for the hands of `fit`. The file may have changed since.
    pub fn new(path: &str, text: &str, fit: Fit, now: Instant) -> Self {
        Self {
            path: path.into(),
            text: text.into(),
            fit,
            stamp: stamp(path),
            pending: Some(PendingChange {
                first: now,
                last: now,
            }),
            is_refused: false,
        }
    }

    /// Returns the path.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// Returns the content of the active layout.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Sets the content of the active layout, which [`poll`](Self::poll) does not return.
    pub fn set_active_text(&mut self, text: &str) {
        self.text = text.into();
        self.is_refused = false;
    }

    /// Notes that the content could not be used. After that, [`poll`](Self::poll) returns the content of the active layout too.
    pub fn set_refused(&mut self) {
        self.is_refused = true;
    }

    /// Notes that the file may have changed.
    pub fn mark_changed(&mut self, now: Instant) {
        let first = self.pending.map_or(now, |pending| pending.first);
        self.pending = Some(PendingChange { first, last: now });
    }

    /// Returns `true` if every change was handled.
    pub fn is_settled(&self) -> bool {
        self.pending.is_none()
    }

    /// Checks the file. Returns its content once it has settled, if it differs from the active layout or from one that was
    /// refused.
    pub fn poll(&mut self, now: Instant) -> Option<Result<Layout, DocumentError>> {
        let stamp = stamp(&self.path);
        if stamp != self.stamp {
            self.stamp = stamp;
            self.mark_changed(now);
        }
        let pending = self.pending?;
        let settled_for = now - pending.last;
        let is_overdue = now - pending.first >= MAX_PENDING_TIME;
        if settled_for < SETTLE_TIME && !is_overdue {
            return None;
        }
        let found = self.read();
        if matches!(found, Some(Err(_))) && settled_for < ERROR_SETTLE_TIME && !is_overdue {
            return None;
        }
        self.pending = None;
        found
    }

    /// Reads the file, settled or not.
    pub fn read_now(&self) -> Result<Layout, DocumentError> {
        self.layout(Document::from_path(&self.path))
    }

    fn read(&self) -> Option<Result<Layout, DocumentError>> {
        match Document::from_path(&self.path) {
            Ok(document) if document.text == self.text && !self.is_refused => None,
            found => Some(self.layout(found)),
        }
    }

    fn layout(&self, document: Result<Document, DocumentError>) -> Result<Layout, DocumentError> {
        document.and_then(|document| Layout::for_hands(document, self.fit))
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

    /// A file that is checked at the times of a simulated clock.
    struct TestFile {
        directory: TempDir,
        file: WatchedFile,
        start: Instant,
        now_ms: u64,
        saves: u64,
    }

    /// Returns a layout with one key, which has the name of the key.
    pub fn text(key: &str) -> String {
        format!(
            "Layout(name: \"{key}\", boards: [(\n    pose: (anchor: elbow),\n    rows: [(at_mm: (0, 0), keys: \"{key}\")],\n)])\n"
        )
    }

    /// The contents that were returned, by time in ms: the name of the layout, or the error.
    type Found = Vec<(u64, Result<String, String>)>;

    impl TestFile {
        /// Creates a file with the layout of the key A, which is active.
        fn new() -> Self {
            let directory = tempfile::tempdir().unwrap();
            let path = directory.path().join("a.ron");
            let start = Instant::now();
            fs::write(&path, text("A")).unwrap();
            let file = WatchedFile::new(path.to_str().unwrap(), &text("A"), Fit::default(), start);
            let mut test = Self {
                directory,
                file,
                start,
                now_ms: 0,
                saves: 0,
            };
            assert_eq!(test.check_for(1_000), []);
            test
        }

        fn path(&self) -> PathBuf {
            self.directory.path().join("a.ron")
        }

        fn save(&mut self, text: &str) {
            self.write(&self.path(), text);
        }

        /// Writes a file with a modification time of its own, however fast the test is.
        fn write(&mut self, path: &std::path::Path, text: &str) {
            fs::write(path, text).unwrap();
            self.saves += 1;
            let time = SystemTime::UNIX_EPOCH + Duration::from_secs(self.saves);
            let file = File::options().write(true).open(path).unwrap();
            file.set_modified(time).unwrap();
        }

        /// Checks the file every 50 ms. Returns the contents with their times.
        fn check_for(&mut self, milliseconds: u64) -> Found {
            let from = self.now_ms;
            let mut found = Found::new();
            while self.now_ms < from + milliseconds {
                self.now_ms += 50;
                let now = self.start + Duration::from_millis(self.now_ms);
                if let Some(outcome) = self.file.poll(now) {
                    match &outcome {
                        Ok(layout) => self.file.set_active_text(&layout.text),
                        Err(_) => self.file.set_refused(),
                    }
                    let outcome = outcome.map(|layout| layout.name);
                    found.push((
                        self.now_ms - from,
                        outcome.map_err(|error| error.to_string()),
                    ));
                }
            }
            found
        }
    }

    fn active(after_ms: u64, name: &str) -> Found {
        vec![(after_ms, Ok(name.into()))]
    }

    /// Returns the only result, an error, without the directory.
    fn error(found: Found, directory: &TempDir) -> (u64, String) {
        let [(after_ms, Err(error))] = found.as_slice() else {
            panic!("{found:?}");
        };
        let directory = format!("{}/", directory.path().display());
        (*after_ms, error.replace(&directory, ""))
    }

    #[test]
    fn a_saved_file_is_returned_at_the_second_check() {
        let mut test = TestFile::new();
        test.save(&text("B"));
        assert_eq!(test.check_for(1_000), active(100, "B"));
    }

    #[test]
    fn a_replaced_file_is_returned() {
        let mut test = TestFile::new();
        let other = test.directory.path().join("a.ron.tmp");
        test.write(&other, &text("B"));
        assert_eq!(test.check_for(500), []);
        fs::rename(other, test.path()).unwrap();
        assert_eq!(test.check_for(1_000), active(100, "B"));
    }

    #[test]
    fn saving_the_same_content_has_no_effect() {
        let mut test = TestFile::new();
        test.save(&text("A"));
        assert_eq!(test.check_for(1_000), []);
    }

    #[test]
    fn a_change_before_the_first_check_is_returned() {
        let mut test = TestFile::new();
        let path = test.path();
        test.file = WatchedFile::new(
            path.to_str().unwrap(),
            &text("Z"),
            Fit::default(),
            test.start,
        );
        test.now_ms = 0;
        assert_eq!(test.check_for(1_000), active(50, "A"));
    }

    #[test]
    fn a_file_that_is_empty_or_incomplete_for_a_moment_is_not_reported() {
        let mut test = TestFile::new();
        test.save("");
        assert_eq!(test.check_for(100), []);
        test.save(&text("B")[..40]);
        assert_eq!(test.check_for(150), []);
        test.save(&text("B"));
        assert_eq!(test.check_for(1_000), active(100, "B"));
    }

    #[test]
    fn an_invalid_file_is_reported_once_with_its_position() {
        let mut test = TestFile::new();
        test.save(&text("Entre"));
        let found = test.check_for(3_000);
        let (after_ms, message) = error(found, &test.directory);
        assert_eq!(after_ms, 200);
        assert_eq!(
            message,
            "a.ron:3:35: unknown key `Entre`, did you mean `Enter`?\n 3 |     rows: [(at_mm: (0, 0), keys: \"Entre\")],\n   |                                   ^^^^^"
        );
        test.save(&text("Enter"));
        assert_eq!(test.check_for(1_000), active(100, "Enter"));
    }

    #[test]
    fn a_removed_file_is_reported_and_returned_when_it_is_back() {
        let mut test = TestFile::new();
        fs::remove_file(test.path()).unwrap();
        assert_eq!(test.check_for(100), []);
        let found = test.check_for(3_000);
        let (after_ms, message) = error(found, &test.directory);
        assert_eq!(
            (after_ms, message.as_str()),
            (100, "a.ron: there is no such file")
        );
        test.save(&text("A"));
        assert_eq!(test.check_for(1_000), active(100, "A"));
        test.save(&text("A"));
        assert_eq!(test.check_for(1_000), [], "that content is active");
        test.save(&text("B"));
        assert_eq!(test.check_for(1_000), active(100, "B"));
    }

    #[test]
    fn a_directory_instead_of_the_file_is_reported() {
        let mut test = TestFile::new();
        fs::remove_file(test.path()).unwrap();
        fs::create_dir(test.path()).unwrap();
        let found = test.check_for(3_000);
        let (_, message) = error(found, &test.directory);
        assert_eq!(message, "a.ron: this is a directory, name a file in it");
    }

    #[test]
    fn a_shipped_layout_does_not_replace_a_removed_file() {
        let message = Document::from_path("numpad").unwrap_err().to_string();
        assert_eq!(message, "numpad: there is no such file");
    }

    #[test]
    fn of_a_hundred_saves_in_a_second_the_last_is_returned() {
        let mut test = TestFile::new();
        for save in 0..20 {
            // Five saves between two checks, each with another name.
            for part in 0..5 {
                test.save(&text("B").replace("\"B\",", &format!("\"{save} {part}\",")));
            }
            assert_eq!(test.check_for(50), []);
        }
        assert_eq!(test.check_for(1_000), active(50, "19 4"));
    }

    #[test]
    fn a_file_that_keeps_changing_is_returned_every_two_seconds() {
        let mut test = TestFile::new();
        let mut found = Found::new();
        for save in 0..100 {
            test.save(&text("B").replace("\"B\",", &format!("\"{save}\",")));
            found.extend(test.check_for(50));
        }
        let found: Vec<_> = found.into_iter().map(|(_, name)| name.unwrap()).collect();
        assert_eq!(found, ["40", "81"]);
    }
}
