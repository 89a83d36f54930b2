//! A watchdog that records what it is told.

use std::fs;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::*;
use crate::output::tests::wait_until;
use crate::output::watchdog::{HEARTBEAT_INTERVAL, MAX_REPLY_AGE, WatchdogMessage};

/// Longest wait on a busy machine.
const TIMEOUT: Duration = Duration::from_secs(60);

/// A watchdog process that writes the messages to a file and releases nothing.
struct RecordedWatchdog {
    folder: tempfile::TempDir,
    losses: Arc<AtomicUsize>,
    replies: bool,
}

impl RecordedWatchdog {
    fn new() -> Self {
        Self {
            folder: tempfile::tempdir().unwrap(),
            losses: Arc::default(),
            replies: true,
        }
    }

    /// Creates one that replies to nothing.
    fn mute() -> Self {
        Self {
            replies: false,
            ..Self::new()
        }
    }

    fn settings(&self) -> WatchdogSettings {
        let losses = self.losses.clone();
        let path = self.path().display().to_string();
        // Skips the target, sends READY, and copies every message.
        let copy = if self.replies {
            format!("tee -a {path} >&0")
        } else {
            format!("cat >>{path}")
        };
        let script =
            format!("head -c 6 >/dev/null; echo $$ >{path}.process; printf . >&0; exec {copy}");
        WatchdogSettings {
            program: "sh".into(),
            arguments: vec!["-c".into(), script.into()],
            on_lost: Arc::new(move || _ = losses.fetch_add(1, Ordering::Relaxed)),
        }
    }

    /// Creates a keyboard that reports to this watchdog.
    fn keyboard(&self, keys: &[&str]) -> (Recorder, Uinput<RecordedNode>) {
        let (recorder, mut uinput) = keyboard(keys);
        uinput.start_watchdog(&self.settings()).unwrap();
        (recorder, uinput)
    }

    fn path(&self) -> PathBuf {
        self.folder.path().join("messages")
    }

    /// Returns the path of the file with its process id, which has a line once it is ready.
    fn process_path(&self) -> PathBuf {
        format!("{}.process", self.path().display()).into()
    }

    /// Returns the first letters of all messages so far without probes, whose number depends on time.
    fn messages(&self) -> String {
        let bytes = fs::read(self.path()).unwrap_or_default();
        bytes
            .chunks(WatchdogMessage::BYTES)
            .map(|message| char::from(message[0]))
            .filter(|letter| *letter != 'p')
            .collect()
    }

    /// Waits until the messages without heartbeats, whose number depends on time, are `expected`.
    fn wait_for_messages(&self, expected: &str) {
        wait_until(expected, || self.messages().replace('a', "") == expected);
    }

    fn kill(&self) {
        let path = self.process_path();
        let process = fs::read_to_string(&path).unwrap();
        fs::remove_file(path).unwrap();
        let process = rustix::process::Pid::from_raw(process.trim().parse().unwrap()).unwrap();
        rustix::process::kill_process(process, rustix::process::Signal::KILL).unwrap();
    }

    fn is_ready(&self) -> bool {
        // The shell creates the file before it writes.
        fs::read_to_string(self.process_path()).is_ok_and(|text| text.ends_with('\n'))
    }
}

#[test]
fn presses_are_reported_to_the_watchdog_before_and_releases_after_they_are_sent() {
    let watchdog = RecordedWatchdog::new();
    let (recorder, mut devices) = devices(&[code("A"), Capability::Axis(Axis::LeftX)]);
    devices.start_watchdog(&watchdog.settings()).unwrap();
    let stick = |value| event(1, EventKind::Axis(Axis::LeftX, value));
    devices.send(&[down(1, "A"), down(1, "Z")]).unwrap();
    // A key that is not required is not pressed, so it is reported as released.
    watchdog.wait_for_messages("ddu");
    recorder.fail(4);
    devices.send(&[up(2, "A"), stick(1.0)]).unwrap_err();
    devices.send(&[stick(0.5)]).unwrap();
    watchdog.wait_for_messages("ddux");
    sleep(HEARTBEAT_INTERVAL);
    devices.send(&[]).unwrap();
    wait_until("heartbeat", || watchdog.messages().ends_with('a'));
    devices.close().unwrap();
    watchdog.wait_for_messages("dduxcu");
    let messages = watchdog.messages();
    sleep(HEARTBEAT_INTERVAL);
    devices.send(&[]).unwrap();
    drop(devices);
    assert_eq!(watchdog.messages(), messages, "no heartbeat without a key");
}

#[test]
fn when_the_watchdog_is_lost_keys_are_released_and_none_is_pressed_until_it_has_restarted() {
    let watchdog = RecordedWatchdog::new();
    let (recorder, mut keyboard) = watchdog.keyboard(&["A", "B"]);
    wait_until("watchdog", || watchdog.is_ready());
    keyboard.send(&[down(1, "A")]).unwrap();
    watchdog.kill();
    let start = Instant::now();
    while recorder.report_count() < 2 {
        assert!(start.elapsed() < TIMEOUT);
        keyboard.send(&[]).unwrap();
    }
    assert!(keyboard.has_stalled());
    keyboard.void_presses();
    keyboard.send(&[down(2, "B")]).unwrap();
    assert!(keyboard.has_stalled());
    assert_eq!(
        recorder.reports(),
        ["keyboard: key 30=1", "keyboard: key 30=0"]
    );
    assert_eq!(keyboard.dropped_presses(), 1);
    wait_until("second watchdog", || watchdog.is_ready());
    assert_eq!(watchdog.losses.load(Ordering::Relaxed), 1);
    while recorder.report_count() == 0 {
        assert!(start.elapsed() < TIMEOUT);
        keyboard.void_presses();
        keyboard.send(&[down(3, "B")]).unwrap();
    }
    watchdog.kill();
    let error = loop {
        assert!(start.elapsed() < TIMEOUT);
        if let Err(error) = keyboard.send(&[]) {
            break error.to_string();
        }
    };
    assert!(error.contains("a second time"), "{error}");
    assert_eq!(
        recorder.reports(),
        ["keyboard: key 48=1", "keyboard: key 48=0"]
    );
}

#[test]
fn a_watchdog_that_does_not_reply_is_replaced_after_keys_are_released() {
    let watchdog = RecordedWatchdog::mute();
    let (recorder, mut keyboard) = watchdog.keyboard(&["A"]);
    wait_until("watchdog", || watchdog.is_ready());
    keyboard.send(&[down(1, "A")]).unwrap();
    fs::remove_file(watchdog.process_path()).unwrap();
    let start = Instant::now();
    while recorder.report_count() < 2 {
        assert!(start.elapsed() < TIMEOUT);
        keyboard.send(&[]).unwrap();
    }
    assert_eq!(
        recorder.reports(),
        ["keyboard: key 30=1", "keyboard: key 30=0"]
    );
    wait_until("replacement", || watchdog.is_ready());
    assert_eq!(watchdog.losses.load(Ordering::Relaxed), 1);
}

#[test]
fn a_watchdog_that_is_lost_while_nothing_is_pressed_is_replaced() {
    let watchdog = RecordedWatchdog::mute();
    let (_, mut keyboard) = watchdog.keyboard(&["A"]);
    wait_until("loss", || {
        keyboard.send(&[]).unwrap();
        watchdog.losses.load(Ordering::Relaxed) == 1
    });
    assert!(keyboard.has_stalled());
}

#[test]
fn a_restart_that_panics_is_an_error_of_the_output() {
    fn panic_when_lost() {
        panic!("a panic of the test, in the thread that restarts the watchdog");
    }

    let watchdog = RecordedWatchdog::new();
    let (_, mut keyboard) = keyboard(&["A"]);
    let settings = WatchdogSettings {
        on_lost: Arc::new(panic_when_lost),
        ..watchdog.settings()
    };
    keyboard.start_watchdog(&settings).unwrap();
    wait_until("watchdog", || watchdog.is_ready());
    watchdog.kill();
    let mut message = String::new();
    wait_until("error", || match keyboard.send(&[]) {
        Ok(()) => false,
        Err(error) => {
            message = error.to_string();
            true
        }
    });
    assert!(message.contains("panicked"), "{message}");
    assert!(keyboard.send(&[]).is_err(), "the error stays");
}

#[test]
fn no_key_is_pressed_beside_one_that_the_watchdog_may_have_released() {
    let watchdog = RecordedWatchdog::new();
    let (recorder, mut keyboard) = watchdog.keyboard(&["ControlLeft", "W"]);
    keyboard.send(&[down(1, "ControlLeft")]).unwrap();
    // As while the process is stopped.
    sleep(MAX_REPLY_AGE);
    keyboard.send(&[down(2, "W")]).unwrap();
    assert_eq!(recorder.reports(), ["keyboard: key 29=1"]);
    assert!(keyboard.has_stalled());
    assert_eq!(keyboard.dropped_presses(), 1);
    keyboard
        .send(&[up(3, "ControlLeft"), down(3, "W")])
        .unwrap();
    assert_eq!(recorder.reports(), ["keyboard: key 29=0"]);
    // Nothing is pressed any more, but the loop has not noticed yet.
    keyboard.send(&[down(4, "W")]).unwrap();
    assert_eq!(recorder.reports(), [""; 0]);
    keyboard.void_presses();
    keyboard.send(&[up(5, "W"), down(5, "W")]).unwrap();
    assert_eq!(recorder.reports(), ["keyboard: key 17=1"]);
    assert!(!keyboard.has_stalled());
}
