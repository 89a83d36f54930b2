//! A source, asked as long as it is quiet.

use std::time::{Duration, Instant};

use ademan::capture::{CaptureError, Source, SourceEvent};

/// Asks until something else than quiet comes; panics when nothing does within `limit`.
pub fn next_within(source: &mut dyn Source, limit: Duration) -> Result<SourceEvent, CaptureError> {
    let start = Instant::now();
    while start.elapsed() < limit {
        match source.next() {
            Ok(SourceEvent::Idle) => {}
            news => return news,
        }
    }
    panic!("nothing came");
}
