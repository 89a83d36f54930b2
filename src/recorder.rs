//! Writes what an observer sees into a recording.
//!
//! The file is an MCAP file as [`capture::recording`](crate::capture::recording) describes it, with one
//! channel per [`Stage`] and its values in JSON with a JSON Schema, so that Foxglove and rerun open
//! it. The time of a message is the source's, in nanoseconds.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use mcap::records::{MessageHeader, Metadata};
use mcap::{McapError, WriteOptions, Writer};

use crate::capture::recording::{
    FORMAT_RECORD, FORMAT_VERSION, MAX_RECORD_BYTES, MESSAGE_ENCODING, RecordedSetup, SETUP_RECORD,
};
use crate::output;
use crate::snapshot::Snapshot;
use crate::time::Timestamp;
use crate::trace::Stage;

/// The program that a recording says it comes from.
const LIBRARY: &str = concat!("ademan ", env!("CARGO_PKG_VERSION"));

/// Why a recording cannot be written. Each text says what was tried and what happened.
#[derive(Clone, Debug, thiserror::Error)]
pub enum RecordError {
    /// The file cannot be made.
    #[error("cannot start a recording at {path}: {reason}", path = .path.display())]
    Create {
        /// Where.
        path: PathBuf,
        /// What happened and what to do.
        reason: String,
    },
    /// The file does not take more; what was written before stays readable.
    #[error("the recording stopped at {path}: {reason}", path = .path.display())]
    Write {
        /// Where.
        path: PathBuf,
        /// What happened.
        reason: String,
    },
}

/// A recording that is being written.
///
/// After each snapshot everything is with the operating system, so that a crash of the program loses
/// nothing of it. Dropping it ends the file properly; [`finish`](Self::finish) also says whether that worked.
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
    /// Starts a recording at `path`, readable for its owner only, where there must be no file yet.
    /// `setup` is written at its start.
    pub fn create(path: &Path, setup: &RecordedSetup) -> Result<Self, RecordError> {
        let refuse = |reason: String| RecordError::Create {
            path: path.to_owned(),
            reason,
        };
        check(setup).map_err(refuse)?;
        let file = output::owner_only(OpenOptions::new().write(true).create_new(true)).open(path);
        let file = file.map_err(|error| {
            refuse(match error.kind() {
                io::ErrorKind::AlreadyExists => {
                    "there is a file already; choose another name or remove it".into()
                }
                _ => error.to_string(),
            })
        })?;
        let (writer, channels) = start(file, setup).map_err(|error| refuse(told(error)))?;
        Ok(Self {
            path: path.to_owned(),
            writer: Some(writer),
            channels,
            buffer: Vec::new(),
        })
    }

    /// Writes what every stage made of a frame. After an error nothing more is written, and every
    /// call is an error.
    pub fn write(&mut self, snapshot: &Snapshot) -> Result<(), RecordError> {
        let outcome = self.write_stages(snapshot);
        if outcome.is_err() {
            self.abandon();
        }
        outcome.map_err(|error| self.stopped(error))
    }

    /// Writes the end of the file.
    pub fn finish(mut self) -> Result<(), RecordError> {
        let Some(mut writer) = self.writer.take() else {
            return Err(self.stopped(McapError::AttemptedWriteAfterFailure));
        };
        let outcome = writer.finish();
        let flushed = writer.into_inner().flush();
        outcome
            .and(flushed.map_err(McapError::Io))
            .map_err(|error| self.stopped(error))
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

    /// Leaves the file as it is: an end written after half a record would not be found.
    fn abandon(&mut self) {
        if let Some(writer) = self.writer.take() {
            let (_, _unwritten) = writer.into_inner().into_parts();
        }
    }

    fn stopped(&self, error: McapError) -> RecordError {
        RecordError::Write {
            path: self.path.clone(),
            reason: told(error),
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

/// Refuses what the reader would not take back.
fn check(setup: &RecordedSetup) -> Result<(), String> {
    // The record's own lengths and keys take less than 1 KiB.
    let room = MAX_RECORD_BYTES - 1024;
    for entry in &setup.entries {
        let size = entry.kind.len() + entry.name.len() + entry.text.len();
        if size > room {
            let (kind, name) = (&entry.kind, &entry.name);
            return Err(format!(
                "the {kind} {name} has {size} bytes and the limit is {room}"
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

fn told(error: McapError) -> String {
    match error {
        McapError::Io(error) => error.to_string(),
        McapError::AttemptedWriteAfterFailure => "it failed before".into(),
        other => other.to_string(),
    }
}
