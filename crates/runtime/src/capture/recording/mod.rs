//! Recordings: MCAP files with readings, the results of the pipeline and the setup.
//!
//! A recording is an [MCAP](https://mcap.dev/spec) file. Its records, in order: a metadata record [`FORMAT_RECORD`], a
//! metadata record [`SETUP_RECORD`] per setup text, the channels, and chunks of [messages](message). Of several setup texts of
//! a kind the first one counts. Readings are on the
//! channel [`READINGS_TOPIC`]. A chunk has the messages of less than a second, so a truncated file keeps all but those of
//! its last second.
//!
//! Recordings of format 1 have messages in JSON outside chunks. They are read and no longer written.

mod chunk;
mod json;
mod lengths;
pub mod message;
mod records;
mod setup;

use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::sync::{Arc, OnceLock};
use std::time::Duration;

use mcap::records::{Channel, Metadata};

use super::{CaptureError, Reading, Sample, Source, SourceEvent, SourceStats};
use crate::files;
use ademan_core::time::Timestamp;
use records::{Content, Records, Stop};

pub use setup::{RecordedSetup, SetupText};

/// Topic of the channel of readings.
pub const READINGS_TOPIC: &str = "/readings";

/// Topic of the channel of commands.
pub const COMMANDS_TOPIC: &str = "/commands";

/// The `origin` in JSON of a command from outside the layout, which no reading repeats.
pub const EXTERNAL_ORIGIN: &str = "external";

/// Encoding of the messages of all channels, and of the schemas.
pub const MESSAGE_ENCODING: &str = "protobuf";

/// Encoding of the messages of format 1.
pub const JSON_ENCODING: &str = "json";

/// Metadata record with the version of the format, under the key `format`.
pub const FORMAT_RECORD: &str = "ademan";

/// Version of the format that this program writes.
pub const FORMAT_VERSION: &str = "2";

/// Version of the format with messages in JSON, which this program reads, too.
pub const JSON_FORMAT_VERSION: &str = "1";

/// Metadata record with a setup text: the keys `kind`, `name` and `text`.
pub const SETUP_RECORD: &str = "ademan.setup";

/// Largest size of a record and of a chunk in bytes: enough for the largest setup text.
pub const MAX_RECORD_BYTES: usize = 4 << 20;

/// Premature end of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Truncation {
    /// Offset of the end of the last complete record, in bytes.
    pub offset: u64,
    /// Description of the end of the file.
    pub reason: String,
}

/// A recording as a source, which returns readings without delay.
///
/// Their times never decrease, as in every recording of this program: a time that goes back would stop the clock by which a
/// gap is noticed.
///
/// Reads the file piece by piece, so its size does not matter. After all complete readings of a truncated file,
/// [`Source::next`] returns [`SourceEvent::End`] and [`truncation`](Self::truncation) states the position.
///
/// The checksum is at the end of the file: damage that leaves a reading readable is an error after the last reading,
/// not before the damaged one.
pub struct Replay<R = File> {
    name: String,
    records: Records<R>,
    setup: RecordedSetup,
    /// The channel of readings.
    channel: Option<MessageChannel>,
    /// The channel of commands.
    commands: Option<MessageChannel>,
    pending: Option<SourceEvent>,
    /// The first reading or command was read, so that the setup is complete.
    has_started: bool,
    readings: u64,
    /// Time of the latest reading.
    time: Timestamp,
    truncation: SharedTruncation,
    has_ended: bool,
}

/// Id and encoding of a channel.
#[derive(Clone, Copy)]
struct MessageChannel {
    id: u16,
    is_json: bool,
}

/// Truncation of a recording, shared with its [`Replay`]. It is set when the replay reaches it.
pub type SharedTruncation = Arc<OnceLock<Truncation>>;

impl Replay {
    /// Opens the recording at `path` and reads its setup. The source is called `recording:PATH`.
    pub fn open(path: &Path) -> Result<Self, CaptureError> {
        let name = format!("recording:{}", path.to_string_lossy());
        let open_error = |reason: String| CaptureError::Open {
            source_name: name.clone(),
            reason,
        };
        let file = files::open_regular(path).map_err(|error| open_error(error.to_string()))?;
        Self::from_reader(name, file)
    }
}

impl<R: Read + Send> Replay<R> {
    /// Reads a recording and its setup from `bytes`. `name` is the name of the source.
    pub fn from_reader(name: impl Into<String>, bytes: R) -> Result<Self, CaptureError> {
        let mut replay = Self {
            name: name.into(),
            records: Records::new(bytes),
            setup: RecordedSetup::default(),
            channel: None,
            commands: None,
            pending: None,
            has_started: false,
            readings: 0,
            time: Timestamp::default(),
            truncation: SharedTruncation::default(),
            has_ended: false,
        };
        match replay.records.read_magic() {
            Ok(()) => replay.pending = replay.next_event()?,
            Err(stop) => replay.end(stop)?,
        }
        Ok(replay)
    }

    /// Returns the setup with which the recording was made.
    pub fn setup(&self) -> &RecordedSetup {
        &self.setup
    }

    /// Removes the recorded packet period, which raises the stall timeout: for sessions in which a recording must not hold a
    /// key for longer than the setup of the person permits.
    #[must_use]
    pub fn without_packet_period(mut self) -> Self {
        self.setup.remove_packet_period();
        self
    }

    /// Returns the truncation of the recording, once the replay has reached it.
    pub fn truncation(&self) -> Option<&Truncation> {
        self.truncation.get()
    }

    /// Returns the truncation for observers that outlive the replay.
    pub fn shared_truncation(&self) -> SharedTruncation {
        self.truncation.clone()
    }

    /// Reads records up to the next reading or command. Returns `None` at the end.
    fn next_event(&mut self) -> Result<Option<SourceEvent>, CaptureError> {
        while !self.has_ended {
            let content = match self.records.next() {
                Ok(content) => content,
                Err(stop) => {
                    self.end(stop)?;
                    continue;
                }
            };
            let decoded = match content {
                Content::Message(id, data) => match (self.channel, self.commands) {
                    (Some(channel), _) if channel.id == id => channel.decode_reading(data),
                    (_, Some(channel)) if channel.id == id => channel.decode_command(data),
                    _ => Ok(None),
                },
                Content::Channel(channel) => self.add_channel(channel).map(|()| None),
                Content::Metadata(metadata) => self.add_metadata(metadata).map(|()| None),
                Content::Other => Ok(None),
            };
            match decoded {
                Ok(None) => {}
                Ok(event) => {
                    self.has_started = true;
                    return Ok(event);
                }
                Err(reason) => return Err(self.malformed(reason)),
            }
        }
        Ok(None)
    }

    fn add_channel(&mut self, channel: Channel) -> Result<(), String> {
        let is_json = match channel.message_encoding.as_str() {
            MESSAGE_ENCODING => Some(false),
            JSON_ENCODING => Some(true),
            _ => None,
        };
        let known = is_json.map(|is_json| MessageChannel {
            id: channel.id,
            is_json,
        });
        match channel.topic.as_str() {
            READINGS_TOPIC if known.is_none() => Err(format!(
                "its readings are encoded as `{}`, not as `{MESSAGE_ENCODING}` or `{JSON_ENCODING}`",
                channel.message_encoding
            )),
            READINGS_TOPIC => {
                self.channel = known;
                Ok(())
            }
            COMMANDS_TOPIC => {
                self.commands = known;
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn add_metadata(&mut self, record: Metadata) -> Result<(), String> {
        let mut fields = record.metadata;
        let mut field = |key: &str| fields.remove(key).unwrap_or_default();
        match record.name.as_str() {
            FORMAT_RECORD => {
                let format = field("format");
                if [FORMAT_VERSION, JSON_FORMAT_VERSION].contains(&format.as_str()) {
                    return Ok(());
                }
                Err(format!(
                    "it has format `{format}` and this program reads the formats `{JSON_FORMAT_VERSION}` and \
                     `{FORMAT_VERSION}`; use the version that wrote it"
                ))
            }
            SETUP_RECORD if !self.has_started => self.setup.add(SetupText {
                kind: field("kind"),
                name: field("name"),
                text: field("text"),
            }),
            _ => Ok(()),
        }
    }

    /// Ends the replay. A truncation is stored and is not an error.
    fn end(&mut self, stop: Stop) -> Result<(), CaptureError> {
        self.has_ended = true;
        let offset = self.records.complete_end();
        match stop {
            Stop::Finished if self.channel.is_none() => Err(self.malformed(format!(
                "it has no channel `{READINGS_TOPIC}`; only recordings of `ademan record` can be replayed"
            ))),
            Stop::Finished => Ok(()),
            Stop::Truncated => {
                let rest = self.records.bytes_read() - offset;
                let reason = match rest {
                    0 => "the file ends without an end mark".to_owned(),
                    _ => format!("the file ends {rest} bytes into a record"),
                };
                let name = &self.name;
                tracing::warn!(source = name, "{name} is truncated at byte {offset}: {reason}");
                let _ = self.truncation.set(Truncation { offset, reason });
                Ok(())
            }
            Stop::Unreadable(error) => Err(CaptureError::Open {
                source_name: self.name.clone(),
                reason: format!("byte {}: {error}", self.records.bytes_read()),
            }),
            Stop::Malformed(reason) => Err(self.malformed(reason)),
        }
    }

    /// Ends the replay with an error at the last record.
    fn malformed(&mut self, reason: String) -> CaptureError {
        self.has_ended = true;
        CaptureError::Malformed {
            source_name: self.name.clone(),
            reason: format!("at byte {}, {reason}", self.records.record_start()),
        }
    }
}

impl MessageChannel {
    fn decode_reading(self, data: &[u8]) -> Result<Option<SourceEvent>, String> {
        let reading: Result<Reading, String> = match self.is_json {
            true => json::decode_reading(data).map_err(|error| error.to_string()),
            false => message::decode_reading(data).map_err(|error| error.to_string()),
        };
        let reading = reading.map_err(|error| format!("a reading cannot be decoded: {error}"))?;
        if let Sample::Channels(channels) = &reading.sample
            && channels.has_impossible_counts()
        {
            return Err("a count is larger than its full scale".into());
        }
        Ok(Some(SourceEvent::Reading(reading)))
    }

    /// Returns a command that no reading repeats.
    fn decode_command(self, data: &[u8]) -> Result<Option<SourceEvent>, String> {
        let command = match self.is_json {
            true => json::decode_external_command(data),
            // As one of a later version, it is not known.
            false => message::decode_external_command(data).unwrap_or(None),
        };
        Ok(command.map(SourceEvent::Command))
    }
}

impl<R: Read + Send> Source for Replay<R> {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        let mut event = match self.pending.take() {
            Some(event) => Some(event),
            None => self.next_event()?,
        };
        if let Some(SourceEvent::Reading(reading)) = &mut event {
            self.readings += 1;
            reading.time = reading.time.max(self.time);
            self.time = reading.time;
        }
        Ok(event.unwrap_or(SourceEvent::End))
    }

    fn name(&self) -> &str {
        &self.name
    }

    /// Returns the period of the recorded source, if that knew it.
    fn packet_period(&self) -> Option<Duration> {
        self.setup.packet_period()
    }

    fn is_live(&self) -> bool {
        false
    }

    /// Returns `true` within a chunk, whose readings are in memory.
    fn is_ready(&self) -> bool {
        !self.has_ended && self.records.has_next()
    }

    fn stats(&self) -> SourceStats {
        let bytes = self.records.bytes_read();
        SourceStats {
            bytes,
            skipped_bytes: match self.truncation() {
                Some(truncation) => bytes - truncation.offset,
                None => 0,
            },
            readings: self.readings,
            ..SourceStats::default()
        }
    }
}
