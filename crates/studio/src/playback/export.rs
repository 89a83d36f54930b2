//! A part of a recording as a recording of its own.

use std::fs;
use std::io;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use super::loader::Recording;
use ademan_core::message::escape_path;
use ademan_core::pipeline::Pipeline;
use ademan_core::snapshot::StepView;
use ademan_core::time::Timestamp;
use ademan_runtime::capture::CaptureError;
use ademan_runtime::capture::recording::Replay;
use ademan_runtime::files;
use ademan_runtime::recorder::{RecordError, Recorder};
use ademan_runtime::session::{self, SessionError, command_channel};

/// Reason why a part of a recording was not written.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The file exists.
    #[error("{path} exists", path = escape_path(.0))]
    Exists(PathBuf),
    /// The file is the recording itself.
    #[error("{path} is the recording that is shown; choose another name", path = escape_path(.0))]
    SameFile(PathBuf),
    /// The recording cannot be read.
    #[error(transparent)]
    Capture(#[from] CaptureError),
    /// The recording cannot be played.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// The file cannot be written.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// The new file cannot replace the old one.
    #[error("cannot replace {path}: {error}; the old file is unchanged", path = escape_path(.path))]
    Replace {
        /// Path of the old file.
        path: PathBuf,
        /// Cause.
        error: io::Error,
    },
}

/// Returns a free name for a part of a recording, beside it: `session-part.mcap`, `session-part-2.mcap`, ….
pub fn default_name(recording: &Path) -> PathBuf {
    let stem = recording.file_stem().unwrap_or_default().to_string_lossy();
    let name = |number: usize| match number {
        1 => recording.with_file_name(format!("{stem}-part.mcap")),
        _ => recording.with_file_name(format!("{stem}-part-{number}.mcap")),
    };
    let mut names = (1..1000).map(name);
    names.find(|free| !free.exists()).unwrap_or_else(|| name(1))
}

/// Writes the steps of a recording within a range of time to a recording of their own, with the same setup. Returns the number
/// of readings.
///
/// An existing file is replaced only if `may_replace`, and only by a complete one.
pub fn export(
    recording: &Recording,
    range: RangeInclusive<Timestamp>,
    path: &Path,
    may_replace: bool,
) -> Result<u64, ExportError> {
    if !path.exists() {
        return write(recording, range, path);
    }
    let canonical = |named: &Path| fs::canonicalize(named).ok();
    if canonical(path) == canonical(&recording.path) {
        return Err(ExportError::SameFile(path.to_owned()));
    }
    if !may_replace {
        return Err(ExportError::Exists(path.to_owned()));
    }
    let refused = |error: io::Error| ExportError::Replace {
        path: path.to_owned(),
        error,
    };
    // A rename would replace a device or a pipe by a file.
    files::check_destination(path).map_err(|error| refused(io::Error::other(error)))?;
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{}.new", std::process::id()));
    let new = path.with_file_name(name);
    let readings = write(recording, range, &new)?;
    fs::rename(&new, path).map_err(|error| {
        // The old file stays; the new one has no name that a person knows.
        let _ = fs::remove_file(&new);
        refused(error)
    })?;
    Ok(readings)
}

/// Writes a new file, or none.
fn write(
    recording: &Recording,
    range: RangeInclusive<Timestamp>,
    path: &Path,
) -> Result<u64, ExportError> {
    let source = Replay::open(&recording.path)?;
    let recorder = Recorder::create(path, source.setup())?;
    let written = copy(recording, source, range, recorder);
    if written.is_err() {
        // Half a part would look like a whole one.
        let _ = fs::remove_file(path);
    }
    written
}

fn copy(
    recording: &Recording,
    source: Replay,
    range: RangeInclusive<Timestamp>,
    mut recorder: Recorder,
) -> Result<u64, ExportError> {
    let (_, commands) = command_channel();
    let mut readings = 0;
    let mut failed = None;
    let mut observe = |step: &StepView, pipeline: &Pipeline, _: Option<_>| {
        let time = step.reading.map_or(pipeline.time(), |reading| reading.time);
        if range.contains(&time) && failed.is_none() {
            readings += u64::from(step.reading.is_some());
            failed = recorder.write(&step.to_snapshot()).err();
        }
    };
    session::replay(&recording.setup, source, &commands, &mut observe)?;
    if let Some(error) = failed {
        return Err(error.into());
    }
    recorder.finish()?;
    Ok(readings)
}
