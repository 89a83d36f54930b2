//! Reports of the keys of bursts, and of keys that the loop writes to the display itself.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use tempfile::TempDir;

use super::bursts::tap;
use super::*;
use crate::output::desktop::key_reporter::KeyReporter;
use crate::output::pressed_key_file::PressedKeyFile;
use crate::output::tests::key;
use crate::output::watchdog::WatchdogMessage;

/// A display with a file of pressed keys.
struct Reported {
    display: TestDisplay,
    folder: TempDir,
    _answers: DirectAnswers,
    opened: Receiver<DirectKeys>,
}

impl Reported {
    /// Opens a connection that reports to a file in `parent`.
    fn open(parent: &Path) -> Self {
        let folder = tempfile::tempdir_in(parent).unwrap();
        let file = PressedKeyFile::create_at(path(&folder), ":7").unwrap();
        let display = TestDisplay::default();
        display.set_direct(|direct| direct.is_supported = true);
        let (mut answers, opened) = DirectAnswers::new();
        let reporter = KeyReporter::new(None, Some(file));
        answers.open(|| direct::open(&display), &reporter);
        Self {
            display,
            folder,
            _answers: answers,
            opened,
        }
    }

    /// Returns `true` if a key is pressed according to the file.
    fn is_reported(&self, key: KeyCode) -> bool {
        let bytes = fs::read(path(&self.folder)).unwrap();
        bytes[usize::from(key.event_code())] == 1
    }
}

/// Returns the path of the file.
fn path(folder: &TempDir) -> PathBuf {
    folder.path().join("ademan").join("pressed-1-0")
}

#[test]
fn a_press_is_reported_unless_it_cannot_be_written() {
    let reported = Reported::open(Path::new("/dev/shm"));
    let mut keys = reported.opened.try_recv().expect("a connection");
    assert!(keys.write(key("A"), KeyDirection::Press).is_some());
    reported.display.set_direct(|direct| direct.is_full = true);
    assert!(keys.write(key("B"), KeyDirection::Press).is_none());
    assert!(keys.write(key("A"), KeyDirection::Release).is_none());
    assert!(reported.is_reported(key("A")));
    assert!(!reported.is_reported(key("B")));
}

#[test]
fn the_loop_writes_no_key_if_its_report_may_wait_for_a_disk() {
    let program = env::current_exe().unwrap();
    let reported = Reported::open(program.parent().unwrap());
    let file = PressedKeyFile::create_at(path(&reported.folder), ":7").unwrap();
    if file.is_in_memory() {
        return println!("SKIPPED: this program is not on a disk");
    }
    assert!(reported.opened.try_recv().is_err());
}

#[test]
fn the_keys_of_a_burst_are_reported_before_and_after_it() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("messages");
    // Skips the target, sends READY, and returns every message.
    let script = "head -c 6 >/dev/null; printf . >&0; exec tee \"$0\" >&0";
    let settings = WatchdogSettings {
        program: "sh".into(),
        arguments: vec!["-c".into(), script.into(), log.clone().into()],
        on_lost: Arc::new(|| ()),
    };
    let display = TestDisplay::default();
    let (mut sink, gate) = display.open_with(Some(&settings), Duration::MAX);
    drop(gate);
    let shift = [down(1, "ShiftLeft"), up(1, "ShiftLeft")];
    let burst = [
        &tap(1, "Backspace")[..],
        &shift[..1],
        &tap(1, "A"),
        &tap(1, "A"),
        &shift[1..],
    ];
    sink.send(&burst.concat()).unwrap();
    let is_report = |message: &WatchdogMessage| {
        matches!(
            message,
            WatchdogMessage::KeyDown(_) | WatchdogMessage::KeyUp(_)
        )
    };
    let reports = || -> Vec<_> {
        // The watchdog may not have created it yet.
        let bytes = fs::read(&log).unwrap_or_default();
        bytes
            .chunks_exact(WatchdogMessage::BYTES)
            .filter_map(|bytes| WatchdogMessage::from_bytes(bytes.try_into().unwrap()))
            .filter(is_report)
            .collect()
    };
    let keys = ["Backspace", "ShiftLeft", "A"].map(key);
    let expected = [
        keys.map(WatchdogMessage::KeyDown),
        keys.map(WatchdogMessage::KeyUp),
    ]
    .concat();
    let start = Instant::now();
    while reports().len() < expected.len() && start.elapsed() < hung_loop::TIMEOUT {
        thread::yield_now();
    }
    assert_eq!(reports(), expected);
    sink.close().unwrap();
    assert_eq!(display.lines().len(), 1, "{:?}", display.lines());
}
