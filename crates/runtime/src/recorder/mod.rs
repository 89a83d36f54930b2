//! The writer of recordings.
//!
//! A recording is an MCAP file as described in [`capture::recording`](crate::capture::recording). Its messages are protocol
//! buffers with their schema, which Foxglove and the packages of MCAP read. There is a channel for each stage but
//! [`Stage::Pose`](crate::trace::Stage::Pose): poses follow from the readings and the setup. Messages have the time
//! of the source, in nanoseconds.

mod container;
mod messages;

use std::fs::{self, File};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use crate::capture::Reading;
use crate::capture::recording::message::{self, encode_command, encode_reading};
use crate::capture::recording::{
    COMMANDS_TOPIC, FORMAT_RECORD, FORMAT_VERSION, MESSAGE_ENCODING, READINGS_TOPIC, RecordedSetup,
    SETUP_RECORD,
};
use crate::files::{self, FileError};
use ademan_core::message::{escape_line, escape_path};
use ademan_core::snapshot::Snapshot;
use container::Container;
use messages::{encode_angles, encode_event, encode_press, encode_touch};

/// Library name in the header of the file.
const LIBRARY: &str = concat!("ademan ", env!("CARGO_PKG_VERSION"));

/// Reason why a recording cannot be written.
#[derive(Clone, Debug, thiserror::Error)]
pub enum RecordError {
    /// The file cannot be created.
    #[error("cannot create the recording {}: {}", escape_path(.path), escape_line(.reason))]
    Create {
        /// Path of the file.
        path: PathBuf,
        /// Cause and remedy.
        reason: String,
    },
    /// A write failed. Everything written before stays readable.
    #[error("the recording {} is incomplete: {}", escape_path(.path), escape_line(.reason))]
    Write {
        /// Path of the file.
        path: PathBuf,
        /// Cause.
        reason: String,
    },
}

/// Returns the error of a file of a recording that cannot be created.
pub fn cannot_create(path: &Path, error: FileError) -> RecordError {
    RecordError::Create {
        path: path.to_owned(),
        reason: error.to_string(),
    }
}

/// Returns the error of a recording that cannot be written.
pub(crate) fn write_error(path: &Path, reason: impl ToString) -> RecordError {
    RecordError::Write {
        path: path.to_owned(),
        reason: reason.to_string(),
    }
}

/// The reason why a recorder writes nothing more.
const EARLIER_FAILURE: &str = "an earlier write failed";

/// A recording whose last byte was handed to the operating system.
pub(crate) struct CompleteFile {
    path: PathBuf,
    file: File,
}

impl CompleteFile {
    pub fn new(path: PathBuf, file: File) -> Self {
        Self { path, file }
    }

    /// Waits until the disk has the whole file. Returns the error of a write that was accepted and failed later: a quota, a disk on the
    /// network and a failing disk show theirs only here.
    pub fn sync(self) -> Result<(), RecordError> {
        match self.file.sync_all() {
            Err(error) => match error.kind() {
                // A file system that cannot wait, which is no failure.
                ErrorKind::Unsupported | ErrorKind::InvalidInput => Ok(()),
                _ => Err(write_error(&self.path, error)),
            },
            Ok(()) => Ok(()),
        }
    }
}

/// A recording in progress.
///
/// Steps are written in chunks of up to half a second. Dropping the recorder completes the file; [`finish`](Self::finish) also
/// waits for the disk and returns errors.
pub struct Recorder {
    path: PathBuf,
    /// `None` after an error and at the end.
    container: Option<Container<File>>,
    channels: Channels,
}

/// Ids of the channels.
#[derive(Clone, Copy)]
struct Channels {
    readings: u16,
    angles: u16,
    touches: u16,
    presses: u16,
    events: u16,
    commands: u16,
}

impl Recorder {
    /// Creates a recording that only its owner can read. Fails if the file exists. `setup` is written at its start; if that fails, there is
    /// no file.
    pub fn create(path: &Path, setup: &RecordedSetup) -> Result<Self, RecordError> {
        let invalid = |reason: String| RecordError::Create {
            path: path.to_owned(),
            reason,
        };
        setup.check_size().map_err(invalid)?;
        let file = files::create_private(path).map_err(|error| cannot_create(path, error))?;
        let started = start(file, setup).map_err(|error| {
            // A further attempt must not fail because of the file of this one.
            let _ = fs::remove_file(path);
            invalid(error.to_string())
        });
        let (container, channels) = started?;
        Ok(Self {
            path: path.to_owned(),
            container: Some(container),
            channels,
        })
    }

    /// Writes the results of all stages for one step. After an error every call fails and writes nothing.
    pub fn write(&mut self, snapshot: &Snapshot) -> Result<(), RecordError> {
        let channels = self.channels;
        self.add(|container| add_step(container, &channels, snapshot))
    }

    /// Writes a reading without results of the other stages.
    pub fn write_reading(&mut self, reading: &Reading) -> Result<(), RecordError> {
        let channels = self.channels;
        self.add(|container| add_reading(container, &channels, reading))
    }

    /// Hands all steps to the operating system, so that a crash of the program loses none.
    pub fn flush(&mut self) -> Result<(), RecordError> {
        self.change(Container::end_chunk)
    }

    /// Completes the file and waits until it is on the disk.
    pub fn finish(self) -> Result<(), RecordError> {
        self.complete()?.sync()
    }

    /// Completes the file, of which the disk may lack a part.
    pub(crate) fn complete(mut self) -> Result<CompleteFile, RecordError> {
        let path = self.path.clone();
        let Some(mut container) = self.container.take() else {
            return Err(write_error(&path, EARLIER_FAILURE));
        };
        match container.finish() {
            Ok(()) => Ok(CompleteFile::new(path, container.into_inner())),
            Err(error) => Err(write_error(&path, error)),
        }
    }

    fn add(&mut self, add: impl FnOnce(&mut Container<File>)) -> Result<(), RecordError> {
        self.change(|container| {
            add(container);
            if container.is_chunk_due() {
                container.end_chunk()
            } else {
                Ok(())
            }
        })
    }

    /// Changes the file. After an error it is closed without its end: after half a record a reader would not find it.
    fn change(
        &mut self,
        change: impl FnOnce(&mut Container<File>) -> io::Result<()>,
    ) -> Result<(), RecordError> {
        let Some(container) = &mut self.container else {
            return Err(write_error(&self.path, EARLIER_FAILURE));
        };
        change(container).map_err(|error| {
            self.container = None;
            write_error(&self.path, error)
        })
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        if let Some(container) = &mut self.container {
            // `finish` returns the error to those who need it.
            let _ = container.finish();
        }
    }
}

fn add_step(container: &mut Container<File>, channels: &Channels, snapshot: &Snapshot) {
    let names = &snapshot.target_names;
    if let Some(reading) = &snapshot.reading {
        add_reading(container, channels, reading);
    }
    if let (Some(angles), Some(pose)) = (&snapshot.angles, &snapshot.pose) {
        container.add_message(channels.angles, pose.time, |out| {
            encode_angles(pose.time, pose.side, angles, out);
        });
    }
    for touch in &snapshot.touches {
        container.add_message(channels.touches, touch.time, |out| {
            encode_touch(touch, names, out);
        });
    }
    for press in &snapshot.presses {
        container.add_message(channels.presses, press.time, |out| {
            encode_press(press, names, out);
        });
    }
    for event in &snapshot.events {
        container.add_message(channels.events, event.time, |out| {
            encode_event(event, names, out);
        });
    }
    let issued = snapshot.commands.iter().map(|issued| (issued, false));
    let executed = snapshot.executed.iter().map(|executed| (executed, true));
    for (timed, is_external) in issued.chain(executed) {
        container.add_message(channels.commands, timed.time, |out| {
            encode_command(timed.time, &timed.command, is_external, out);
        });
    }
}

fn add_reading(container: &mut Container<File>, channels: &Channels, reading: &Reading) {
    container.add_message(channels.readings, reading.time, |out| {
        encode_reading(reading, out);
    });
}

fn start(file: File, setup: &RecordedSetup) -> io::Result<(Container<File>, Channels)> {
    let mut container = Container::new(file, LIBRARY)?;
    container.write_metadata(FORMAT_RECORD, &[("format", FORMAT_VERSION)])?;
    for entry in &setup.entries {
        let fields = [
            ("kind", entry.kind.as_str()),
            ("name", entry.name.as_str()),
            ("text", entry.text.as_str()),
        ];
        container.write_metadata(SETUP_RECORD, &fields)?;
    }
    let mut channel = |topic: &str, schema: &str| {
        container.add_channel(topic, MESSAGE_ENCODING, schema, message::SCHEMA)
    };
    let channels = Channels {
        readings: channel(READINGS_TOPIC, "ademan.Reading")?,
        angles: channel("/angles", "ademan.Angles")?,
        touches: channel("/touches", "ademan.Touch")?,
        presses: channel("/presses", "ademan.Press")?,
        events: channel("/events", "ademan.OutputEvent")?,
        commands: channel(COMMANDS_TOPIC, "ademan.Command")?,
    };
    Ok((container, channels))
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use std::os::unix::fs::OpenOptionsExt;

    use super::*;

    #[test]
    fn a_file_that_the_disk_does_not_take_is_incomplete() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("hand.mcap");
        let recorder = Recorder::create(&path, &RecordedSetup::default()).unwrap();
        let written = recorder.complete().unwrap();
        assert!(written.sync().is_ok());
        // Opened only as a path, a file can be neither written nor awaited.
        let mut options = fs::OpenOptions::new();
        let flags = rustix::fs::OFlags::PATH.bits() as i32;
        let file = options.read(true).custom_flags(flags).open(&path).unwrap();
        let error = CompleteFile::new(path, file).sync().unwrap_err();
        assert!(error.to_string().contains("is incomplete: "), "{error}");
    }
}
