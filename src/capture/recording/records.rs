//! The records of an MCAP file, one after the other.

use std::io::{self, BufReader, Read};

use mcap::records::{Metadata, Record, op};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{MAGIC, McapError};

use super::{MAX_RECORD_BYTES, lengths};

/// Content of a record, as far as a replay needs it.
pub(super) enum Content {
    Channel(mcap::records::Channel),
    Metadata(Metadata),
    /// Channel id and data of a message.
    Message(u16, Vec<u8>),
    Other,
}

/// Reason why there are no more records.
pub(super) enum Stop {
    Finished,
    Truncated,
    Unreadable(io::Error),
    Malformed(String),
}

/// Reader of the records of a file.
pub(super) struct Records<R> {
    bytes: BufReader<R>,
    reader: LinearReader,
    bytes_read: u64,
    record_start: u64,
    complete_end: u64,
    /// The record with the checksum over all data was read.
    is_checked: bool,
}

impl<R: Read> Records<R> {
    /// Creates a reader at the start of a file.
    pub fn new(bytes: R) -> Self {
        let options = LinearReaderOptions::default()
            .with_validate_data_section_crc(true)
            .with_validate_chunk_crcs(true)
            .with_record_length_limit(MAX_RECORD_BYTES);
        Self {
            bytes: BufReader::new(bytes),
            reader: LinearReader::new_with_options(options),
            bytes_read: 0,
            record_start: 0,
            complete_end: 0,
            is_checked: false,
        }
    }

    /// Returns the number of bytes read.
    pub fn bytes_read(&self) -> u64 {
        self.bytes_read
    }

    /// Returns the offset of the last record.
    pub fn record_start(&self) -> u64 {
        self.record_start
    }

    /// Returns the offset of the end of the last complete record.
    pub fn complete_end(&self) -> u64 {
        self.complete_end
    }

    /// Reads the magic bytes at the start of a file.
    pub fn read_magic(&mut self) -> Result<(), Stop> {
        let mut magic = Vec::with_capacity(MAGIC.len());
        let mut head = self.bytes.by_ref().take(MAGIC.len() as u64);
        head.read_to_end(&mut magic).map_err(Stop::Unreadable)?;
        self.bytes_read = magic.len() as u64;
        if magic.is_empty() {
            return Err(Stop::Malformed("the file is empty".into()));
        }
        if !MAGIC.starts_with(&magic) {
            let without_version = &MAGIC[..5];
            return Err(Stop::Malformed(if magic.starts_with(without_version) {
                "it is not MCAP version 0".into()
            } else {
                "it is not an MCAP file".into()
            }));
        }
        if magic.len() < MAGIC.len() {
            return Err(Stop::Truncated);
        }
        self.complete_end = self.bytes_read;
        self.reader.insert(magic.len()).copy_from_slice(&magic);
        self.reader.notify_read(magic.len());
        Ok(())
    }

    /// Reads the next record.
    pub fn next(&mut self) -> Result<Content, Stop> {
        self.record_start = self.complete_end;
        loop {
            match self.reader.next_event() {
                None if self.is_checked => return Err(Stop::Finished),
                // A record with a damaged length can contain the checksum and end where another one starts.
                None => return Err(Stop::Malformed("the end of the data is missing".into())),
                // The reader requests exactly the bytes of a record, so the record ends with the bytes read.
                Some(Ok(LinearReadEvent::Record { opcode, data })) => {
                    let content = content(opcode, data);
                    self.complete_end = self.bytes_read;
                    self.is_checked |= opcode == op::DATA_END;
                    return content;
                }
                Some(Ok(LinearReadEvent::ReadRequest(size))) => {
                    let read = read_some(&mut self.bytes, self.reader.insert(size));
                    let read = read.map_err(Stop::Unreadable)?;
                    self.reader.notify_read(read);
                    self.bytes_read += read as u64;
                }
                Some(Err(McapError::UnexpectedEof)) => return Err(Stop::Truncated),
                Some(Err(error)) => return Err(Stop::Malformed(reason(error))),
            }
        }
    }
}

fn read_some(bytes: &mut impl Read, buffer: &mut [u8]) -> io::Result<usize> {
    loop {
        match bytes.read(buffer) {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            result => return result,
        }
    }
}

/// Decodes the records that a replay needs. Damage in other records is ignored.
fn content(opcode: u8, data: &[u8]) -> Result<Content, Stop> {
    if !matches!(opcode, op::CHANNEL | op::METADATA | op::MESSAGE) {
        return Ok(Content::Other);
    }
    if !lengths::are_within_record(opcode, data) {
        let reason = "a text of the record is longer than the record";
        return Err(Stop::Malformed(reason.into()));
    }
    let record =
        mcap::parse_record(opcode, data).map_err(|error| Stop::Malformed(reason(error)))?;
    Ok(match record {
        Record::Channel(channel) => Content::Channel(channel),
        Record::Metadata(metadata) => Content::Metadata(metadata),
        Record::Message { header, data } => Content::Message(header.channel_id, data.into_owned()),
        _ => Content::Other,
    })
}

fn reason(error: McapError) -> String {
    match error {
        McapError::BadDataCrc { .. } => "the preceding data do not match their checksum".into(),
        McapError::BadMagic => "the end mark is damaged".into(),
        McapError::RecordTooLarge { len, .. } => {
            format!("a record states a length of {len} bytes; the limit is {MAX_RECORD_BYTES}")
        }
        McapError::Parse(_) => "a record cannot be decoded".into(),
        other => other.to_string(),
    }
}
