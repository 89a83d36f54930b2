//! Recordings: MCAP files that hold readings, what came of them, and the setup they were made with.
//!
//! A recording is a plain [MCAP](https://mcap.dev/spec) file without chunks, so that one that was cut
//! off still has every message before the cut. It starts with a metadata record
//! [`FORMAT_RECORD`], goes on with one metadata record [`SETUP_RECORD`] per setup text, then
//! declares its channels, and then come messages in JSON. Readings are on the channel [`TOPIC`].

mod lengths;

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;
use std::sync::{Arc, OnceLock};
use std::time::Duration;

use mcap::records::{Metadata, Record, op};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{MAGIC, McapError};

use super::{CaptureError, Reading, Sample, Source, SourceEvent, SourceStats};

/// The channel that readings are on.
pub const READINGS_TOPIC: &str = "/readings";

/// How the messages of all channels are encoded.
pub const MESSAGE_ENCODING: &str = "json";

/// The metadata record that says which version of the format the file has, under the key `format`.
pub const FORMAT_RECORD: &str = "ademan";

/// The version of the format that is written and read here.
pub const FORMAT_VERSION: &str = "1";

/// The metadata records that hold the setup: `kind`, `name` and `text` of each.
pub const SETUP_RECORD: &str = "ademan.setup";

/// The most bytes that one record may have: enough for the largest setup text.
pub const MAX_RECORD_BYTES: usize = 4 << 20;

/// The kind of the setup text that is the time between two readings, in microseconds.
const PACKET_PERIOD: &str = "packet-period";

/// The texts that describe how a recording was made: the glove, the arm, the layout, the settings.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RecordedSetup {
    /// The texts, in the order in which they were written.
    pub entries: Vec<SetupText>,
}

/// One text of a setup.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SetupText {
    /// What it describes: `glove`, `arm`, `layout`, `settings`, ….
    pub kind: String,
    /// What its user calls it: a file or a built-in name.
    pub name: String,
    /// The text as it was in force.
    pub text: String,
}

impl RecordedSetup {
    /// Adds a text.
    #[must_use]
    pub fn with(mut self, kind: &str, name: &str, text: &str) -> Self {
        self.entries.push(SetupText {
            kind: kind.into(),
            name: name.into(),
            text: text.into(),
        });
        self
    }

    /// Adds the time between two readings of the source, on which the stall limit depends.
    #[must_use]
    pub fn with_packet_period(self, period: Option<Duration>) -> Self {
        match period {
            Some(period) => self.with(PACKET_PERIOD, "µs", &period.as_micros().to_string()),
            None => self,
        }
    }

    /// The first text of this kind.
    pub fn get(&self, kind: &str) -> Option<&SetupText> {
        self.entries.iter().find(|entry| entry.kind == kind)
    }
}

/// Where and how a recording ends before its end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Truncation {
    /// The byte at which the last whole record ends.
    pub offset: u64,
    /// What follows there.
    pub reason: String,
}

/// A recording as a source: gives its readings as fast as they are asked for.
///
/// Reads the file piece by piece, so that its size does not matter. After a file that was cut off
/// has given all whole readings it is at its [`End`](Capture::End), and [`cut`](Self::cut) says where.
///
/// The checksum stands at the end of the file: damage that leaves a reading readable is an error
/// after the last reading, not before the damaged one.
pub struct Replay<R = File> {
    name: String,
    records: Records<R>,
    setup: RecordedSetup,
    channel: Option<u16>,
    pending: Option<Reading>,
    readings: u64,
    cut: SharedTruncation,
    ended: bool,
}

/// Where a replay notes that its recording is cut off, for whoever does not have the replay any more then.
pub type SharedTruncation = Arc<OnceLock<Truncation>>;

impl Replay {
    /// Opens the recording at `path` and reads its setup; the source is called `recording:PATH`.
    pub fn open(path: &Path) -> Result<Self, CaptureError> {
        let name = format!("recording:{}", path.display());
        let refuse = |reason: String| CaptureError::Open {
            source_name: name.clone(),
            reason,
        };
        let file = File::open(path).map_err(|error| refuse(error.to_string()))?;
        if path.is_dir() {
            return Err(refuse("it is a directory, name a file in it".into()));
        }
        Self::from_reader(name, file)
    }
}

impl<R: Read + Send> Replay<R> {
    /// Reads a recording from anywhere; `name` is what errors call it.
    pub fn from_reader(name: impl Into<String>, bytes: R) -> Result<Self, CaptureError> {
        let mut replay = Self {
            name: name.into(),
            records: Records::new(bytes),
            setup: RecordedSetup::default(),
            channel: None,
            pending: None,
            readings: 0,
            cut: SharedTruncation::default(),
            ended: false,
        };
        match replay.records.read_magic() {
            Ok(()) => replay.pending = replay.next_reading()?,
            Err(stop) => replay.end(stop)?,
        }
        Ok(replay)
    }

    /// The setup that the recording was made with.
    pub fn setup(&self) -> &RecordedSetup {
        &self.setup
    }

    /// Where the recording is cut off, once its end has been read.
    pub fn truncation(&self) -> Option<&Truncation> {
        self.cut.get()
    }

    /// Where it will be noted that the recording is cut off.
    pub fn shared_truncation(&self) -> SharedTruncation {
        self.cut.clone()
    }

    /// Reads up to the next reading; `None` at the end.
    fn next_reading(&mut self) -> Result<Option<Reading>, CaptureError> {
        while !self.ended {
            match self.records.next() {
                Ok(Content::Reading(channel, data)) if Some(channel) == self.channel => {
                    return self.decode(&data).map(Some);
                }
                Ok(content) => self.take(content)?,
                Err(stop) => self.end(stop)?,
            }
        }
        Ok(None)
    }

    fn take(&mut self, content: Content) -> Result<(), CaptureError> {
        match content {
            Content::Channel(channel) if channel.topic == READINGS_TOPIC => {
                if channel.message_encoding != MESSAGE_ENCODING {
                    let encoding = channel.message_encoding;
                    return Err(self.malformed(format!(
                        "its readings are encoded as `{encoding}`, not as `{MESSAGE_ENCODING}`"
                    )));
                }
                self.channel = Some(channel.id);
                Ok(())
            }
            Content::Metadata(metadata) => self.take_metadata(metadata),
            _ => Ok(()),
        }
    }

    fn take_metadata(&mut self, record: Metadata) -> Result<(), CaptureError> {
        let mut text = record.metadata;
        let mut field = |key: &str| text.remove(key).unwrap_or_default();
        match record.name.as_str() {
            FORMAT_RECORD => {
                let format = field("format");
                if format == FORMAT_VERSION {
                    return Ok(());
                }
                Err(self.malformed(format!(
                    "it has format `{format}` and this program reads format `{FORMAT_VERSION}`; use the version that wrote it"
                )))
            }
            SETUP_RECORD => {
                self.setup.entries.push(SetupText {
                    kind: field("kind"),
                    name: field("name"),
                    text: field("text"),
                });
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn decode(&mut self, data: &[u8]) -> Result<Reading, CaptureError> {
        let reading: Reading = serde_json::from_slice(data).map_err(|error| {
            self.malformed(format!("what should be a reading is none: {error}"))
        })?;
        if let Sample::Channels(channels) = &reading.sample
            && channels
                .counts
                .iter()
                .any(|count| *count > channels.full_scale)
        {
            return Err(self.malformed("a count is larger than its full scale".into()));
        }
        Ok(reading)
    }

    /// Notes why there is nothing more; only a cut is no error.
    fn end(&mut self, stop: Stop) -> Result<(), CaptureError> {
        self.ended = true;
        let offset = self.records.whole;
        match stop {
            Stop::Finished if self.channel.is_none() => Err(self.malformed(format!(
                "it has no channel `{READINGS_TOPIC}`; only what `ademan record` wrote can be replayed"
            ))),
            Stop::Finished => Ok(()),
            Stop::Cut => {
                let left = self.records.fed - offset;
                let reason = match left {
                    0 => "the file ends without an end mark".to_owned(),
                    _ => format!("the file ends {left} bytes into a record"),
                };
                tracing::warn!("{} is cut off at byte {offset}: {reason}", self.name);
                let _ = self.cut.set(Truncation { offset, reason });
                Ok(())
            }
            Stop::Unreadable(error) => Err(CaptureError::Open {
                source_name: self.name.clone(),
                reason: format!("byte {}: {error}", self.records.fed),
            }),
            Stop::Malformed(reason) => Err(self.malformed(reason)),
        }
    }

    /// An error at the record that was read last; it ends the replay.
    fn malformed(&mut self, reason: String) -> CaptureError {
        self.ended = true;
        CaptureError::Malformed {
            source_name: self.name.clone(),
            reason: format!("at byte {}, {reason}", self.records.start),
        }
    }
}

impl<R: Read + Send> Source for Replay<R> {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        let reading = match self.pending.take() {
            Some(reading) => Some(reading),
            None => self.next_reading()?,
        };
        let Some(reading) = reading else {
            return Ok(SourceEvent::End);
        };
        self.readings += 1;
        Ok(SourceEvent::Reading(reading))
    }

    fn name(&self) -> &str {
        &self.name
    }

    /// That of the source that was recorded, where it knew it.
    fn packet_period(&self) -> Option<Duration> {
        let microseconds = self.setup.get(PACKET_PERIOD)?.text.parse().ok()?;
        Some(Duration::from_micros(microseconds))
    }

    fn is_live(&self) -> bool {
        false
    }

    fn stats(&self) -> SourceStats {
        SourceStats {
            bytes: self.records.fed,
            skipped_bytes: match self.truncation() {
                Some(_) => self.records.fed - self.records.whole,
                None => 0,
            },
            readings: self.readings,
            ..SourceStats::default()
        }
    }
}

/// What a record holds, as far as a replay needs it.
enum Content {
    Channel(mcap::records::Channel),
    Metadata(Metadata),
    Reading(u16, Vec<u8>),
    Other,
}

/// Why there are no more records.
enum Stop {
    Finished,
    Cut,
    Unreadable(io::Error),
    Malformed(String),
}

/// The records of a file, one after the other.
struct Records<R> {
    bytes: BufReader<R>,
    reader: LinearReader,
    /// Bytes handed to the reader.
    fed: u64,
    /// Where the last record that was read starts.
    start: u64,
    /// Where the last whole record ends.
    whole: u64,
    /// Whether the record with the checksum over all data was there.
    is_checked: bool,
}

impl<R: Read> Records<R> {
    fn new(bytes: R) -> Self {
        let options = LinearReaderOptions::default()
            .with_validate_data_section_crc(true)
            .with_validate_chunk_crcs(true)
            .with_record_length_limit(MAX_RECORD_BYTES);
        Self {
            bytes: BufReader::new(bytes),
            reader: LinearReader::new_with_options(options),
            fed: 0,
            start: 0,
            whole: 0,
            is_checked: false,
        }
    }

    /// Reads what an MCAP file starts with.
    fn read_magic(&mut self) -> Result<(), Stop> {
        let mut magic = Vec::with_capacity(MAGIC.len());
        let mut head = self.bytes.by_ref().take(MAGIC.len() as u64);
        head.read_to_end(&mut magic).map_err(Stop::Unreadable)?;
        self.fed = magic.len() as u64;
        if magic.is_empty() {
            return Err(Stop::Malformed("the file is empty".into()));
        }
        if !MAGIC.starts_with(&magic) {
            let version = &MAGIC[..5];
            return Err(Stop::Malformed(if magic.starts_with(version) {
                "this is another version of MCAP than 0".into()
            } else {
                "this is no MCAP file".into()
            }));
        }
        if magic.len() < MAGIC.len() {
            return Err(Stop::Cut);
        }
        self.whole = self.fed;
        self.reader.insert(magic.len()).copy_from_slice(&magic);
        self.reader.notify_read(magic.len());
        Ok(())
    }

    fn next(&mut self) -> Result<Content, Stop> {
        self.start = self.whole;
        loop {
            match self.reader.next_event() {
                None if self.is_checked => return Err(Stop::Finished),
                // A record with a damaged length can swallow the checksum and end where another begins.
                None => return Err(Stop::Malformed("the end of the data is missing".into())),
                // The reader asks for no byte more than a record has, so what it has been given
                // when it gives a record ends where the record ends.
                Some(Ok(LinearReadEvent::Record { opcode, data })) => {
                    let content = content(opcode, data);
                    self.whole = self.fed;
                    self.is_checked |= opcode == op::DATA_END;
                    return content;
                }
                Some(Ok(LinearReadEvent::ReadRequest(size))) => {
                    let read = read_some(&mut self.bytes, self.reader.insert(size));
                    let read = read.map_err(Stop::Unreadable)?;
                    self.reader.notify_read(read);
                    self.fed += read as u64;
                }
                Some(Err(McapError::UnexpectedEof)) => return Err(Stop::Cut),
                Some(Err(error)) => return Err(Stop::Malformed(reason(error))),
            }
        }
    }
}

fn read_some(bytes: &mut impl Read, buffer: &mut [u8]) -> io::Result<usize> {
    loop {
        match bytes.read(buffer) {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            outcome => return outcome,
        }
    }
}

/// Decodes only what a replay needs: records of other kinds may be damaged without harm.
fn content(opcode: u8, data: &[u8]) -> Result<Content, Stop> {
    if !matches!(opcode, op::CHANNEL | op::METADATA | op::MESSAGE) {
        return Ok(Content::Other);
    }
    if !lengths::fit(opcode, data) {
        let reason = "a text of the record is longer than the record";
        return Err(Stop::Malformed(reason.into()));
    }
    let record =
        mcap::parse_record(opcode, data).map_err(|error| Stop::Malformed(reason(error)))?;
    Ok(match record {
        Record::Channel(channel) => Content::Channel(channel),
        Record::Metadata(metadata) => Content::Metadata(metadata),
        Record::Message { header, data } => Content::Reading(header.channel_id, data.into_owned()),
        _ => Content::Other,
    })
}

fn reason(error: McapError) -> String {
    match error {
        McapError::BadDataCrc { .. } => "the contents before do not match their checksum".into(),
        McapError::BadMagic => "the end mark is damaged".into(),
        McapError::RecordTooLarge { len, .. } => {
            format!("a record says that it has {len} bytes; the limit is {MAX_RECORD_BYTES}")
        }
        McapError::Parse(_) => "a record cannot be decoded".into(),
        other => other.to_string(),
    }
}
