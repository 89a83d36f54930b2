//! A source, asked as long as it is quiet.

use std::time::{Duration, Instant};

use ademan::capture::{Capture, CaptureError, Source};

/// Asks until something else than quiet comes; panics when nothing does within `limit`.
pub fn next_within(source: &mut dyn Source, limit: Duration) -> Result<Capture, CaptureError> {
    let start = Instant::now();
    while start.elapsed() < limit {
        match source.next() {
            Ok(Capture::Quiet) => {}
            news => return news,
        }
    }
    panic!("nothing came");
}
