//! The reader of recordings.

use std::io::Read;

use ademan_core::capture::{Reading, Sample};
use ademan_core::command::Command;
use ademan_core::time::Timestamp;
use mcap::records::{Channel, Metadata};

use super::records::{Content, Records, Stop};
use super::{
    COMMANDS_TOPIC, FORMAT_RECORD, FORMAT_VERSION, JSON_ENCODING, JSON_FORMAT_VERSION,
    MESSAGE_ENCODING, READINGS_TOPIC, RecordedSetup, SETUP_RECORD, SetupText, json, message,
};

/// Premature end of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Truncation {
    /// Offset of the end of the last complete record, in bytes.
    pub offset: u64,
    /// Description of the end of the file.
    pub reason: String,
}

/// A reading that a recorded session received, or a command that it executed.
#[expect(
    clippy::large_enum_variant,
    reason = "a reading is passed on without an allocation"
)]
#[derive(Clone, Debug, PartialEq)]
pub enum RecordedEvent {
    /// A reading.
    Reading(Reading),
    /// A command that the readings do not issue again.
    Command(Command),
}

/// Reason why reading a recording cannot continue.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RecordingError {
    /// The bytes cannot be read.
    #[error("byte {offset}: {reason}")]
    Unreadable {
        /// Number of bytes that were read before.
        offset: u64,
        /// Description by the system.
        reason: String,
    },
    /// The bytes are not a recording, or the recording is damaged.
    #[error("at byte {offset}, {reason}")]
    Malformed {
        /// Offset of the damaged record, in bytes.
        offset: u64,
        /// Cause and, if there is one, remedy.
        reason: String,
    },
}

/// A recording that is read record by record, so that its size does not matter.
///
/// The times of its readings never decrease, as in every recording of this program: a time that goes back would stop the clock by
/// which a gap is noticed.
///
/// After all complete readings of a truncated file, [`next_event`](Self::next_event) returns `None` and
/// [`truncation`](Self::truncation) states the position.
///
/// The checksum is at the end of the file: damage that leaves a reading readable is an error after the last reading,
/// not before the damaged one.
pub struct Recording<R> {
    records: Records<R>,
    setup: RecordedSetup,
    /// The channel of readings.
    readings: Option<MessageChannel>,
    /// The channel of commands.
    commands: Option<MessageChannel>,
    pending: Option<RecordedEvent>,
    /// `true` once the first reading or command was read: the setup is complete.
    has_started: bool,
    /// Time of the latest reading.
    time: Timestamp,
    truncation: Option<Truncation>,
    has_ended: bool,
}

/// Id and encoding of a channel.
#[derive(Clone, Copy)]
struct MessageChannel {
    id: u16,
    is_json: bool,
}

impl<R: Read> Recording<R> {
    /// Reads the setup of a recording.
    pub fn new(bytes: R) -> Result<Self, RecordingError> {
        let mut recording = Self {
            records: Records::new(bytes),
            setup: RecordedSetup::default(),
            readings: None,
            commands: None,
            pending: None,
            has_started: false,
            time: Timestamp::default(),
            truncation: None,
            has_ended: false,
        };
        match recording.records.read_magic() {
            Ok(()) => recording.pending = recording.read_event()?,
            Err(stop) => recording.end(stop)?,
        }
        Ok(recording)
    }

    /// Returns the setup with which the recording was made.
    pub fn setup(&self) -> &RecordedSetup {
        &self.setup
    }

    /// Removes the recorded packet period, which would raise the stall timeout.
    pub fn remove_packet_period(&mut self) {
        self.setup.remove_packet_period();
    }

    /// Returns the truncation of the recording once the reader has reached it.
    pub fn truncation(&self) -> Option<&Truncation> {
        self.truncation.as_ref()
    }

    /// Returns the number of bytes that were read.
    pub fn bytes_read(&self) -> u64 {
        self.records.bytes_read()
    }

    /// Returns `true` within a chunk, whose events are in memory.
    pub fn is_ready(&self) -> bool {
        !self.has_ended && self.records.has_next()
    }

    /// Returns the next reading or command; `None` at the end.
    pub fn next_event(&mut self) -> Result<Option<RecordedEvent>, RecordingError> {
        let mut event = match self.pending.take() {
            Some(event) => Some(event),
            None => self.read_event()?,
        };
        if let Some(RecordedEvent::Reading(reading)) = &mut event {
            reading.time = reading.time.max(self.time);
            self.time = reading.time;
        }
        Ok(event)
    }

    /// Reads records up to the next reading or command. Returns `None` at the end.
    fn read_event(&mut self) -> Result<Option<RecordedEvent>, RecordingError> {
        while !self.has_ended {
            let content = match self.records.next() {
                Ok(content) => content,
                Err(stop) => {
                    self.end(stop)?;
                    continue;
                }
            };
            let decoded = match content {
                Content::Message(id, data) => match (self.readings, self.commands) {
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
                self.readings = known;
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

    /// Ends the reading. A truncation is stored and is not an error.
    fn end(&mut self, stop: Stop) -> Result<(), RecordingError> {
        self.has_ended = true;
        let offset = self.records.complete_end();
        match stop {
            Stop::Finished if self.readings.is_none() => Err(self.malformed(format!(
                "it has no channel `{READINGS_TOPIC}`; only recordings of `ademan record` can be replayed"
            ))),
            Stop::Finished => Ok(()),
            Stop::Truncated => {
                let rest = self.records.bytes_read() - offset;
                let reason = match rest {
                    0 => "the file ends without an end mark".to_owned(),
                    _ => format!("the file ends {rest} bytes into a record"),
                };
                self.truncation = Some(Truncation { offset, reason });
                Ok(())
            }
            Stop::Unreadable(error) => Err(RecordingError::Unreadable {
                offset: self.records.bytes_read(),
                reason: error.to_string(),
            }),
            Stop::Malformed(reason) => Err(self.malformed(reason)),
        }
    }

    /// Ends the reading with an error at the last record.
    fn malformed(&mut self, reason: String) -> RecordingError {
        self.has_ended = true;
        RecordingError::Malformed {
            offset: self.records.record_start(),
            reason,
        }
    }
}

impl MessageChannel {
    fn decode_reading(self, data: &[u8]) -> Result<Option<RecordedEvent>, String> {
        let reading: Result<Reading, String> = if self.is_json {
            json::decode_reading(data).map_err(|error| error.to_string())
        } else {
            message::decode_reading(data).map_err(|error| error.to_string())
        };
        let reading = reading.map_err(|error| format!("a reading cannot be decoded: {error}"))?;
        if let Sample::Channels(channels) = &reading.sample
            && channels.has_impossible_counts()
        {
            return Err("a count is larger than its full scale".into());
        }
        Ok(Some(RecordedEvent::Reading(reading)))
    }

    /// Decodes a command; `None` for a command that the readings issue again, and for an unknown one.
    fn decode_command(self, data: &[u8]) -> Result<Option<RecordedEvent>, String> {
        let command: Result<Option<Command>, String> = if self.is_json {
            json::decode_external_command(data).map_err(|error| error.to_string())
        } else {
            message::decode_external_command(data).map_err(|error| error.to_string())
        };
        let command = command.map_err(|error| format!("a command cannot be decoded: {error}"))?;
        Ok(command.map(RecordedEvent::Command))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_damaged_command_is_an_error_and_an_unknown_one_is_left_out() {
        let decode = |is_json, data: &[u8]| MessageChannel { id: 1, is_json }.decode_command(data);
        let mut message = Vec::new();
        message::encode_command(Timestamp(9), &Command::Recenter, true, &mut message);
        let recenter = RecordedEvent::Command(Command::Recenter);
        assert_eq!(decode(false, &message), Ok(Some(recenter)));
        let text = br#"{"time_us": 9, "origin": "external", "command": "dance"}"#;
        assert_eq!(decode(true, text), Ok(None));
        let cut_message = &message[..message.len() - 1];
        let cut_text = &text[..text.len() - 1];
        for error in [decode(false, cut_message), decode(true, cut_text)] {
            let reason = error.expect_err("a command without its end");
            assert!(
                reason.starts_with("a command cannot be decoded: "),
                "{reason}"
            );
        }
    }
}
