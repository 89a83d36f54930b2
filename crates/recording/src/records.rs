//! The records of an MCAP file, one after the other, also those within chunks.

use std::io::{self, BufReader, Read};
use std::ops::Range;

use mcap::records::{Channel, Metadata, Record, op};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{MAGIC, McapError};

use super::{MAX_RECORD_BYTES, chunk, lengths};

/// Bytes of a record before its content: its code and its length.
const RECORD_HEAD_BYTES: usize = 9;

/// Bytes of a message before its data: its channel, its number and its times.
const MESSAGE_HEAD_BYTES: usize = 22;

/// Bytes of a read from a file. Files of format 1 have a record for each message.
const READ_BYTES: usize = 1 << 16;

/// Content of a record, as far as a replay needs it.
pub(super) enum Content<'a> {
    Channel(Channel),
    Metadata(Metadata),
    /// Channel id and data of a message.
    Message(u16, &'a [u8]),
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
    /// `true` if the record with the checksum over all data was read.
    is_checked: bool,
    /// A record of the file, or the records of a chunk.
    buffer: Vec<u8>,
    /// Records of a chunk that were not returned.
    rest: Range<usize>,
}

impl<R: Read> Records<R> {
    /// Creates a reader at the start of a file.
    pub fn new(bytes: R) -> Self {
        let options = LinearReaderOptions::default()
            .with_validate_data_section_crc(true)
            .with_emit_chunks(true)
            .with_record_length_limit(MAX_RECORD_BYTES);
        Self {
            bytes: BufReader::with_capacity(READ_BYTES, bytes),
            reader: LinearReader::new_with_options(options),
            bytes_read: 0,
            record_start: 0,
            complete_end: 0,
            is_checked: false,
            buffer: Vec::new(),
            rest: 0..0,
        }
    }

    /// Returns the number of bytes read.
    pub fn bytes_read(&self) -> u64 {
        self.bytes_read
    }

    /// Returns the offset of the last record, or of the chunk that contains it.
    pub fn record_start(&self) -> u64 {
        self.record_start
    }

    /// Returns the offset of the end of the last complete record.
    pub fn complete_end(&self) -> u64 {
        self.complete_end
    }

    /// Returns `true` if the next record is in memory.
    pub fn has_next(&self) -> bool {
        !self.rest.is_empty()
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

    /// Reads the next record. Metadata do not belong into chunks and are left out there: compressed, they could be of any size.
    pub fn next(&mut self) -> Result<Content<'_>, Stop> {
        let (opcode, data) = loop {
            if !self.rest.is_empty() {
                let record = self.next_in_chunk()?;
                if record.0 == op::METADATA {
                    return Ok(Content::Other);
                }
                break record;
            }
            let opcode = self.read_record()?;
            if opcode != op::CHUNK {
                break (opcode, 0..self.buffer.len());
            }
            self.read_chunk()?;
        };
        content(opcode, &self.buffer[data])
    }

    /// Reads the next record of the file into the buffer. Returns its code.
    fn read_record(&mut self) -> Result<u8, Stop> {
        self.record_start = self.complete_end;
        loop {
            match self.reader.next_event() {
                None if self.is_checked => return Err(Stop::Finished),
                // A record with a damaged length can contain the checksum and end where another one starts.
                None => return Err(Stop::Malformed("the end of the data is missing".into())),
                // The reader requests exactly the bytes of a record, so the record ends with the bytes read.
                Some(Ok(LinearReadEvent::Record { opcode, data })) => {
                    self.buffer.clear();
                    self.buffer.extend(data);
                    self.complete_end = self.bytes_read;
                    self.is_checked |= opcode == op::DATA_END;
                    return Ok(opcode);
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

    /// Replaces the chunk in the buffer by its records.
    fn read_chunk(&mut self) -> Result<(), Stop> {
        let chunk = std::mem::take(&mut self.buffer);
        let record = parse(op::CHUNK, &chunk)?;
        if let Record::Chunk { header, data } = record {
            chunk::decompress(&header, &data, &mut self.buffer).map_err(Stop::Malformed)?;
        }
        self.rest = 0..self.buffer.len();
        Ok(())
    }

    /// Splits the next record off the chunk. Returns its code and its content.
    fn next_in_chunk(&mut self) -> Result<(u8, Range<usize>), Stop> {
        let too_long = || Stop::Malformed("a record is longer than its chunk".into());
        let rest = &self.buffer[self.rest.clone()];
        let (head, content) = rest
            .split_at_checked(RECORD_HEAD_BYTES)
            .ok_or_else(too_long)?;
        let length = u64::from_le_bytes(head[1..].try_into().expect("it has eight bytes"));
        if length > content.len() as u64 {
            return Err(too_long());
        }
        let start = self.rest.start + RECORD_HEAD_BYTES;
        let end = start + length as usize;
        self.rest.start = end;
        Ok((head[0], start..end))
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
fn content(opcode: u8, data: &[u8]) -> Result<Content<'_>, Stop> {
    if opcode == op::MESSAGE {
        let undecodable = || Stop::Malformed(UNDECODABLE.into());
        let message = data.split_at_checked(MESSAGE_HEAD_BYTES);
        let (head, body) = message.ok_or_else(undecodable)?;
        return Ok(Content::Message(
            u16::from_le_bytes([head[0], head[1]]),
            body,
        ));
    }
    if !matches!(opcode, op::CHANNEL | op::METADATA) {
        return Ok(Content::Other);
    }
    Ok(match parse(opcode, data)? {
        Record::Channel(channel) => Content::Channel(channel),
        Record::Metadata(metadata) => Content::Metadata(metadata),
        _ => Content::Other,
    })
}

fn parse(opcode: u8, data: &[u8]) -> Result<Record<'_>, Stop> {
    if !lengths::are_within_record(opcode, data) {
        let reason = "a text of the record is longer than the record";
        return Err(Stop::Malformed(reason.into()));
    }
    mcap::parse_record(opcode, data).map_err(|error| Stop::Malformed(reason(error)))
}

const UNDECODABLE: &str = "a record cannot be decoded";

fn reason(error: McapError) -> String {
    match error {
        McapError::BadDataCrc { .. } => "the preceding data do not match their checksum".into(),
        McapError::BadMagic => "the end mark is damaged".into(),
        McapError::RecordTooLarge { len, .. } => {
            format!("a record states a length of {len} bytes; the limit is {MAX_RECORD_BYTES}")
        }
        McapError::Parse(_) => UNDECODABLE.into(),
        other => other.to_string(),
    }
}
