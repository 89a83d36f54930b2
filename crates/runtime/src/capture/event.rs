//! Events of a source, and their conversion from the results of [`Source::next`].

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

use super::suspend::SuspendDetector;
use super::{CaptureError, Reading, Source, SourceEvent, SourceStats};
use ademan_core::command::Command;
use ademan_core::time::Timestamp;

/// Event of a source.
///
/// No event follows [`Failed`](Self::Failed) or [`End`](Self::End).
#[expect(
    clippy::large_enum_variant,
    reason = "a reading is passed on without an allocation"
)]
#[derive(Clone, Debug)]
pub enum CaptureEvent {
    /// A reading.
    Reading {
        /// The sensor values.
        reading: Reading,
        /// Time at which it was received.
        received_at: Instant,
        /// Statistics up to and including this reading.
        stats: SourceStats,
    },
    /// Readings of a source that had them [ready](Source::is_ready), the oldest first. Only from
    /// [`spawn_batched`](super::spawn_batched).
    Readings {
        /// The sensor values.
        readings: Vec<Reading>,
        /// Time at which the first one was received.
        received_at: Instant,
        /// Statistics up to and including the last one.
        stats: SourceStats,
    },
    /// A command that a recorded session executed between two readings.
    Command(Command),
    /// The [clock](Source::clock) of a source that waits: no reading precedes this time.
    Elapsed(Timestamp),
    /// Bytes or packets arrive, but none of them belongs to a reading. Sent at most twice a second, and if packets
    /// were refused since then, when a live source is stopped.
    Noise(SourceStats),
    /// The device was lost and the source reconnects, or the readings were interrupted. Never dropped, and always
    /// before the readings that follow it.
    Lost(CaptureError),
    /// The source failed permanently or panicked.
    Failed(CaptureError),
    /// End of the readings.
    End(SourceStats),
}

/// Shortest time between two [`CaptureEvent::Noise`].
pub(super) const NOISE_INTERVAL: Duration = Duration::from_millis(500);

/// Readings in a [`CaptureEvent::Readings`]: few enough that a command waits for less than a millisecond, and enough that
/// waking the other thread costs little for each.
const BATCH_LENGTH: usize = 64;

/// A source whose results are passed on as events.
pub(super) struct EventSource<S> {
    pub(super) source: S,
    is_live: bool,
    is_batched: bool,
    suspend: SuspendDetector,
    suspends: u64,
    /// Time of the latest event with statistics, and the statistics.
    reported: (Instant, SourceStats),
}

impl<S: Source> EventSource<S> {
    /// Creates the events of `source`.
    pub fn new(source: S) -> Self {
        Self {
            is_live: source.is_live(),
            is_batched: false,
            source,
            suspend: SuspendDetector::default(),
            suspends: 0,
            reported: (Instant::now(), SourceStats::default()),
        }
    }

    /// Passes readings that are ready at the same time on in one event.
    pub fn with_batches(self) -> Self {
        Self {
            is_batched: true,
            ..self
        }
    }

    /// Replaces the detector, because a test cannot suspend the system.
    #[cfg(all(test, target_os = "linux"))]
    pub fn with_suspend_detector(self, suspend: SuspendDetector) -> Self {
        Self { suspend, ..self }
    }

    /// Passes the events of the next call of the source to `emit`: none, one, or two. Returns `false` after the last
    /// event. A panic of the source is a failure.
    pub fn next(&mut self, emit: &mut dyn FnMut(CaptureEvent)) -> bool {
        match self.call() {
            Ok(SourceEvent::Reading(first)) if self.is_batched && self.source.is_ready() => {
                match self.pass_ready(first, emit) {
                    Some(result) => self.convert(result, emit),
                    None => true,
                }
            }
            result => self.convert(result, emit),
        }
    }

    /// Calls the source. A panic of the source is an error.
    fn call(&mut self) -> Result<SourceEvent, CaptureError> {
        let result = catch_unwind(AssertUnwindSafe(|| self.source.next()));
        result.unwrap_or_else(|panic| Err(panic_error(self.source.name(), &*panic)))
    }

    /// Passes `first` and the readings that are ready on in one event. Returns the result after them, if it is not a reading.
    fn pass_ready(
        &mut self,
        first: Reading,
        emit: &mut dyn FnMut(CaptureEvent),
    ) -> Option<Result<SourceEvent, CaptureError>> {
        let received_at = Instant::now();
        let mut readings = Vec::with_capacity(BATCH_LENGTH);
        readings.push(first);
        let (mut stats, mut other) = (self.stats(), None);
        while other.is_none() && readings.len() < BATCH_LENGTH && self.source.is_ready() {
            match self.call() {
                Ok(SourceEvent::Reading(reading)) => {
                    readings.push(reading);
                    stats = self.stats();
                }
                result => other = Some(result),
            }
        }
        self.reported = (received_at, stats);
        emit(CaptureEvent::Readings {
            readings,
            received_at,
            stats,
        });
        other
    }

    fn convert(
        &mut self,
        result: Result<SourceEvent, CaptureError>,
        emit: &mut dyn FnMut(CaptureEvent),
    ) -> bool {
        if self.is_live && self.suspend.was_suspended() {
            // The clock of the readings stands still during a suspend, so no later stage can detect it.
            self.suspends += 1;
            emit(CaptureEvent::Lost(suspended(self.source.name())));
        }
        match result {
            Ok(SourceEvent::Idle) => self.convert_idle(emit),
            Ok(SourceEvent::Reading(reading)) => {
                let (received_at, stats) = (Instant::now(), self.stats());
                self.reported = (received_at, stats);
                emit(CaptureEvent::Reading {
                    reading,
                    received_at,
                    stats,
                });
            }
            Ok(SourceEvent::Command(command)) => emit(CaptureEvent::Command(command)),
            Ok(SourceEvent::End) => {
                emit(CaptureEvent::End(self.stats()));
                return false;
            }
            Err(error) if error.is_recoverable() => emit(CaptureEvent::Lost(error)),
            Err(error) => {
                emit(CaptureEvent::Failed(error));
                return false;
            }
        }
        true
    }

    fn convert_idle(&mut self, emit: &mut dyn FnMut(CaptureEvent)) {
        if let Some(time) = self.source.clock() {
            emit(CaptureEvent::Elapsed(time));
        }
        let (reported_at, reported) = self.reported;
        if reported_at.elapsed() < NOISE_INTERVAL {
            return;
        }
        let stats = self.stats();
        self.reported = (Instant::now(), stats);
        // The statistics do not count the bytes of a packet of an unknown sender.
        if stats.bytes > reported.bytes || stats.invalid != reported.invalid {
            emit(CaptureEvent::Noise(stats));
        }
    }

    /// Stops the source. Returns the statistics if packets were refused since the latest event with statistics.
    pub fn stop(&mut self) -> Option<SourceStats> {
        self.source.stop();
        let (stats, (_, reported)) = (self.stats(), self.reported);
        (stats.invalid != reported.invalid).then_some(stats)
    }

    fn stats(&self) -> SourceStats {
        let stats = self.source.stats();
        SourceStats {
            losses: stats.losses + self.suspends,
            ..stats
        }
    }
}

fn suspended(source_name: &str) -> CaptureError {
    CaptureError::Interrupted {
        source_name: source_name.to_owned(),
        reason: "the system was suspended".to_owned(),
    }
}

fn panic_error(source_name: &str, panic: &(dyn Any + Send)) -> CaptureError {
    let text = panic.downcast_ref::<&str>().copied();
    let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    CaptureError::Malformed {
        source_name: source_name.to_owned(),
        reason: format!(
            "it panicked: {}; please report this",
            text.unwrap_or("no text")
        ),
    }
}
