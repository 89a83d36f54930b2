//! A loop that hangs while the thread of the output runs on.

use std::sync::atomic::AtomicUsize;
use std::time::Instant;

use super::*;
use crate::output::watchdog::WatchdogSettings;

/// Longest wait for something that a busy machine does late.
pub const TIMEOUT: Duration = Duration::from_secs(60);

/// Returns a watchdog that replies to every heartbeat and releases nothing, and the number of its losses.
fn watchdog() -> (WatchdogSettings, Arc<AtomicUsize>) {
    let losses = Arc::new(AtomicUsize::new(0));
    let counted = Arc::clone(&losses);
    // Skips the target, sends READY, and returns every message.
    let script = "head -c 6 >/dev/null; printf . >&0; exec tee >&0";
    let settings = WatchdogSettings {
        program: "sh".into(),
        arguments: vec!["-c".into(), script.into()],
        on_lost: Arc::new(move || _ = counted.fetch_add(1, Ordering::Relaxed)),
    };
    (settings, losses)
}

/// Waits until the display has received `expected`.
fn wait_for(display: &TestDisplay, expected: &[&str]) {
    let start = Instant::now();
    while display.lines() != expected {
        let lines = display.lines();
        assert!(start.elapsed() < TIMEOUT, "{lines:?}, not {expected:?}");
        thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn the_thread_releases_the_keys_of_a_loop_that_hangs_although_the_watchdog_has_its_heartbeats() {
    let display = TestDisplay::default();
    let (settings, losses) = watchdog();
    let (mut sink, gate) = display.open_with(Some(&settings), Duration::MAX);
    drop(gate);
    sink.send(&[down(1, "ShiftLeft"), down(1, "A")]).unwrap();
    wait_for(&display, &["+ShiftLeft", "+A", "-A", "-ShiftLeft"]);
    assert!(sink.has_stalled(), "the loop arms again when it continues");
    sink.send(&[down(2, "B")]).unwrap();
    direct::wait_until_idle(&sink);
    assert_eq!(sink.dropped_presses(), 1, "without its modifier");
    sink.void_presses();
    assert!(!sink.has_stalled());
    assert_eq!(losses.load(Ordering::Relaxed), 0);
}
