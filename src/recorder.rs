//! The writer of recordings.
//!
//! A recording is an MCAP file as described in [`capture::recording`](crate::capture::recording), with one channel per
//! [`Stage`]. Messages are JSON with a JSON Schema, so that Foxglove and rerun can open the file. Their time is that of the
//! source, in nanoseconds.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use mcap::records::{MessageHeader, Metadata};
use mcap::{McapError, WriteOptions, Writer};

use crate::capture::Reading;
use crate::capture::recording::{
    FORMAT_RECORD, FORMAT_VERSION, MAX_RECORD_BYTES, MESSAGE_ENCODING, RecordedSetup, SETUP_RECORD,
};
use crate::files::{self, FileError};
use crate::snapshot::Snapshot;
use crate::time::Timestamp;
use crate::trace::{Stage, reading_json};

/// Library name in the header of the file.
const LIBRARY: &str = concat!("ademan ", env!("CARGO_PKG_VERSION"));

/// Reason why a recording cannot be written.
#[derive(Clone, Debug, thiserror::Error)]
pub enum RecordError {
    /// The file cannot be created.
    #[error("cannot create the recording {path}: {reason}", path = .path.display())]
    Create {
        /// Path of the file.
        path: PathBuf,
        /// Cause and remedy.
        reason: String,
    },
    /// A write failed. Everything written before stays readable.
    #[error("the recording {path} is incomplete: {reason}", path = .path.display())]
    Write {
        /// Path of the file.
        path: PathBuf,
        /// Cause.
        reason: String,
    },
}

/// Returns the error of a file of a recording that cannot be created.
pub fn cannot_create(path: &Path, error: FileError) -> RecordError {
    let reason = match error {
        FileError::Io(error) if error.kind() == io::ErrorKind::AlreadyExists => {
            "the file exists; choose another name or remove it".to_owned()
        }
        error => error.to_string(),
    };
    RecordError::Create {
        path: path.to_owned(),
        reason,
    }
}

/// A recording in progress.
///
/// Each snapshot is handed to the operating system at once, so that a crash of the program loses none. Dropping the
/// recorder completes the file; [`finish`](Self::finish) also returns errors.
pub struct Recorder {
    path: PathBuf,
    writer: Option<Writer<BufWriter<File>>>,
    channels: [Channel; Stage::COUNT],
    buffer: Vec<u8>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Channel {
    id: u16,
    sequence: u32,
}

impl Recorder {
    /// Creates a recording that only its owner can read. Fails if the file exists. `setup` is written at its start.
    pub fn create(path: &Path, setup: &RecordedSetup) -> Result<Self, RecordError> {
        let invalid = |reason: String| RecordError::Create {
            path: path.to_owned(),
            reason,
        };
        check(setup).map_err(invalid)?;
        let file = files::create_private(path).map_err(|error| cannot_create(path, error))?;
        let (writer, channels) = start(file, setup).map_err(|error| invalid(describe(error)))?;
        Ok(Self {
            path: path.to_owned(),
            writer: Some(writer),
            channels,
            buffer: Vec::new(),
        })
    }

    /// Writes the results of all stages for one step. After an error every call fails and writes nothing.
    pub fn write(&mut self, snapshot: &Snapshot) -> Result<(), RecordError> {
        let outcome = self.write_stages(snapshot);
        if outcome.is_err() {
            self.abandon();
        }
        outcome.map_err(|error| self.write_error(error))
    }

    /// Writes a reading without results of the other stages.
    pub fn write_reading(&mut self, reading: &Reading) -> Result<(), RecordError> {
        let outcome = self.write_readings_message(reading);
        if outcome.is_err() {
            self.abandon();
        }
        outcome.map_err(|error| self.write_error(error))
    }

    /// Completes the file.
    pub fn finish(mut self) -> Result<(), RecordError> {
        let Some(mut writer) = self.writer.take() else {
            return Err(self.write_error(McapError::AttemptedWriteAfterFailure));
        };
        let outcome = writer.finish();
        let flushed = writer.into_inner().flush();
        outcome
            .and(flushed.map_err(McapError::Io))
            .map_err(|error| self.write_error(error))
    }

    fn write_stages(&mut self, snapshot: &Snapshot) -> Result<(), McapError> {
        let Some(writer) = &mut self.writer else {
            return Err(McapError::AttemptedWriteAfterFailure);
        };
        for (stage, channel) in Stage::ALL.iter().zip(&mut self.channels) {
            stage.for_each_json(snapshot, &mut self.buffer, |time, json| {
                let header = channel.header(time);
                writer.write_to_known_channel(&header, json)
            })?;
        }
        writer.flush()
    }

    fn write_readings_message(&mut self, reading: &Reading) -> Result<(), McapError> {
        let Some(writer) = &mut self.writer else {
            return Err(McapError::AttemptedWriteAfterFailure);
        };
        let header = self.channels[Stage::Readings.index()].header(reading.time);
        writer.write_to_known_channel(&header, reading_json(reading, &mut self.buffer))?;
        writer.flush()
    }

    /// Closes the file without its footer: after half a record a reader would not find it.
    fn abandon(&mut self) {
        if let Some(writer) = self.writer.take() {
            let (_, _unwritten) = writer.into_inner().into_parts();
        }
    }

    fn write_error(&self, error: McapError) -> RecordError {
        RecordError::Write {
            path: self.path.clone(),
            reason: describe(error),
        }
    }
}

impl Channel {
    fn header(&mut self, time: Timestamp) -> MessageHeader {
        self.sequence = self.sequence.wrapping_add(1);
        let nanoseconds = time.0.saturating_mul(1_000);
        MessageHeader {
            channel_id: self.id,
            sequence: self.sequence,
            log_time: nanoseconds,
            publish_time: nanoseconds,
        }
    }
}

/// Checks that the reader will accept the records of the setup.
fn check(setup: &RecordedSetup) -> Result<(), String> {
    // Lengths and keys of a record take less than 1 KiB.
    let limit = MAX_RECORD_BYTES - 1024;
    for entry in &setup.entries {
        let size = entry.kind.len() + entry.name.len() + entry.text.len();
        if size > limit {
            let (kind, name) = (&entry.kind, &entry.name);
            return Err(format!(
                "the {kind} {name} has {size} bytes, more than the limit of {limit}"
            ));
        }
    }
    Ok(())
}

type Started = (Writer<BufWriter<File>>, [Channel; Stage::COUNT]);

fn start(file: File, setup: &RecordedSetup) -> Result<Started, McapError> {
    let mut writer = WriteOptions::new()
        .use_chunks(false)
        .compression(None)
        .library(LIBRARY)
        .create(BufWriter::new(file))?;
    writer.write_metadata(&metadata(FORMAT_RECORD, [("format", FORMAT_VERSION)]))?;
    for entry in &setup.entries {
        let fields = [
            ("kind", entry.kind.as_str()),
            ("name", entry.name.as_str()),
            ("text", entry.text.as_str()),
        ];
        writer.write_metadata(&metadata(SETUP_RECORD, fields))?;
    }
    let mut channels = [Channel::default(); Stage::COUNT];
    for (stage, channel) in Stage::ALL.iter().zip(&mut channels) {
        let schema = stage.schema().as_bytes();
        let schema = writer.add_schema(stage.schema_name(), "jsonschema", schema)?;
        channel.id =
            writer.add_channel(schema, stage.topic(), MESSAGE_ENCODING, &BTreeMap::new())?;
    }
    writer.flush()?;
    Ok((writer, channels))
}

fn metadata<const N: usize>(name: &str, fields: [(&str, &str); N]) -> Metadata {
    Metadata {
        name: name.into(),
        metadata: fields.map(|(key, value)| (key.into(), value.into())).into(),
    }
}

fn describe(error: McapError) -> String {
    match error {
        McapError::Io(error) => error.to_string(),
        McapError::AttemptedWriteAfterFailure => "an earlier write failed".into(),
        other => other.to_string(),
    }
}
