//! The size that a recording grows to.

use std::path::Path;

use ademan::files;
use ademan::message::escape_path;
use ademan::session::SessionHandle;

/// Bytes of a reading with the results of all stages, for one hand with a noise of one count in each channel. A steady one takes
/// less than half.
const BYTES_PER_READING: f64 = 280.0;

/// Readings per second of a glove on the fastest line.
const READINGS_PER_SECOND: f64 = 175.0;

/// Waits until a session has created its recording, and prints that it begins, how fast it grows, and for how long the disk has room.
/// Prints nothing if the session ends before.
pub fn announce(session: &SessionHandle, path: &Path) {
    if !session.wait_until_started() {
        return;
    }
    let per_hour = BYTES_PER_READING * READINGS_PER_SECOND * 3600.0;
    let left = files::free_bytes(path).map_or(String::new(), |free| {
        let (free, hours) = (free as f64 / 1e9, free as f64 / per_hour);
        format!("; {free:.1} GB are free on its disk, enough for {hours:.0} hours")
    });
    say!(
        "recording to {}: up to {:.0} MB an hour at {READINGS_PER_SECOND} readings per second{left}",
        escape_path(path),
        per_hour / 1e6,
    );
}
