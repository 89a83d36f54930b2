//! Recordings as sources. [`ademan_recording`] has their format.

use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::sync::{Arc, OnceLock};
use std::time::Duration;

pub use ademan_recording::*;

use super::{CaptureError, Source, SourceEvent, SourceStats};
use crate::files;

/// A recording as a source, which returns readings without delay.
pub struct Replay<R = File> {
    name: String,
    recording: Recording<R>,
    readings: u64,
    /// `true` if commands that let sources press keys, or only point, are left out.
    omits_permissions: bool,
    truncation: SharedTruncation,
}

/// Truncation of a recording, shared with its [`Replay`]. It is set when the replay reaches it.
pub type SharedTruncation = Arc<OnceLock<Truncation>>;

impl Replay {
    /// Opens the recording at `path` and reads its setup. The source is called `recording:PATH`.
    pub fn open(path: &Path) -> Result<Self, CaptureError> {
        let name = format!("recording:{}", path.to_string_lossy());
        match files::open_regular(path) {
            Ok(file) => Self::from_reader(name, file),
            Err(error) => Err(CaptureError::Open {
                source_name: name,
                reason: error.to_string(),
            }),
        }
    }
}

impl<R: Read + Send> Replay<R> {
    /// Reads a recording and its setup from `bytes`. `name` is the name of the source.
    pub fn from_reader(name: impl Into<String>, bytes: R) -> Result<Self, CaptureError> {
        let name = name.into();
        let recording = Recording::new(bytes).map_err(|error| capture_error(&name, error))?;
        let replay = Self {
            name,
            recording,
            readings: 0,
            omits_permissions: false,
            truncation: SharedTruncation::default(),
        };
        replay.report_truncation();
        Ok(replay)
    }

    /// Returns the setup with which the recording was made.
    pub fn setup(&self) -> &RecordedSetup {
        self.recording.setup()
    }

    /// Removes the recorded packet period, which raises the stall timeout: for sessions in which a recording must not hold a
    /// key for longer than the setup of the person permits.
    #[must_use]
    pub fn without_packet_period(mut self) -> Self {
        self.recording.remove_packet_period();
        self
    }

    /// Leaves out the commands that let sources press keys, or only point: for sessions with the permissions of the person.
    #[must_use]
    pub fn without_permissions(mut self) -> Self {
        self.omits_permissions = true;
        self
    }

    /// Returns the truncation of the recording, once the replay has reached it.
    pub fn truncation(&self) -> Option<&Truncation> {
        self.recording.truncation()
    }

    /// Returns the truncation for observers that outlive the replay.
    pub fn shared_truncation(&self) -> SharedTruncation {
        self.truncation.clone()
    }

    fn report_truncation(&self) {
        let Some(truncation) = self.recording.truncation() else {
            return;
        };
        if self.truncation.set(truncation.clone()).is_ok() {
            let (name, Truncation { offset, reason }) = (&self.name, truncation);
            tracing::warn!(
                source = name,
                "{name} is truncated at byte {offset}: {reason}"
            );
        }
    }
}

fn capture_error(name: &str, error: RecordingError) -> CaptureError {
    let (source_name, reason) = (name.to_owned(), error.to_string());
    match error {
        RecordingError::Unreadable { .. } => CaptureError::Open {
            source_name,
            reason,
        },
        RecordingError::Malformed { .. } => CaptureError::Malformed {
            source_name,
            reason,
        },
    }
}

impl<R: Read + Send> Source for Replay<R> {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        let event = self.recording.next_event();
        let event = event.map_err(|error| capture_error(&self.name, error))?;
        Ok(match event {
            Some(RecordedEvent::Reading(reading)) => {
                self.readings += 1;
                SourceEvent::Reading(reading)
            }
            Some(RecordedEvent::Command(command))
                if self.omits_permissions && command.is_permission() =>
            {
                SourceEvent::Idle
            }
            Some(RecordedEvent::Command(command)) => SourceEvent::Command(command),
            None => {
                self.report_truncation();
                SourceEvent::End
            }
        })
    }

    fn name(&self) -> &str {
        &self.name
    }

    /// Returns the period of the recorded source, if the recording states it.
    fn packet_period(&self) -> Option<Duration> {
        self.setup().packet_period()
    }

    fn is_live(&self) -> bool {
        false
    }

    /// Returns `true` within a chunk, whose readings are in memory.
    fn is_ready(&self) -> bool {
        self.recording.is_ready()
    }

    fn stats(&self) -> SourceStats {
        let bytes = self.recording.bytes_read();
        let cut_at = self.truncation().map(|truncation| truncation.offset);
        SourceStats {
            bytes,
            skipped_bytes: cut_at.map_or(0, |offset| bytes - offset),
            readings: self.readings,
            cut_at,
            ..SourceStats::default()
        }
    }
}
