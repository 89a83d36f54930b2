//! The writer of MCAP files with compressed chunks.
//!
//! <https://mcap.dev/spec>. The compression of the crate `mcap` needs a compiler of C; this one does not.

use std::io::{self, Write};

use lz4_flex::frame::{BlockMode, BlockSize, FrameEncoder, FrameInfo};
use mcap::MAGIC;
use mcap::records::op;

use crate::capture::recording::COMPRESSION;
use ademan_core::time::Timestamp;

/// Span of time after which a chunk ends. Half of the second that a cut or a crash may cost: the recorder ends a chunk as
/// well when no step has come for the other half.
const CHUNK_US: u64 = 500_000;

/// Size after which a chunk ends, however short its time.
const CHUNK_BYTES: usize = 256 << 10;

/// Writer of an MCAP file: metadata and channels first, then messages.
pub(super) struct Container<W> {
    out: W,
    checksum: crc32fast::Hasher,
    written: u64,
    /// A record in preparation.
    record: Vec<u8>,
    /// Records of the present chunk.
    chunk: Vec<u8>,
    /// Times of the messages of the present chunk: first, earliest, latest.
    times: Option<[Timestamp; 3]>,
    /// Records of the schemas and channels, which the summary repeats.
    declarations: Vec<u8>,
    /// Records of the summary with the offset, length and name of each metadata record.
    metadata_indexes: Vec<u8>,
    statistics: Statistics,
}

#[derive(Default)]
struct Statistics {
    metadata: u32,
    chunks: u32,
    /// Earliest and latest time of all messages.
    times: Option<[Timestamp; 2]>,
    /// Number of messages by channel.
    messages: Vec<u32>,
}

impl<W: Write> Container<W> {
    /// Writes the start of a file. `library` names the program.
    pub fn new(out: W, library: &str) -> io::Result<Self> {
        let mut container = Self {
            out,
            checksum: crc32fast::Hasher::new(),
            written: 0,
            record: Vec::new(),
            chunk: Vec::with_capacity(CHUNK_BYTES + (CHUNK_BYTES >> 2)),
            times: None,
            declarations: Vec::new(),
            metadata_indexes: Vec::new(),
            statistics: Statistics::default(),
        };
        container.write(MAGIC)?;
        container.write_record(op::HEADER, |record| {
            put_text(record, "");
            put_text(record, library);
        })?;
        Ok(container)
    }

    /// Writes a metadata record. Packages of MCAP find it by its index in the summary.
    pub fn write_metadata(&mut self, name: &str, fields: &[(&str, &str)]) -> io::Result<()> {
        self.statistics.metadata += 1;
        let offset = self.written;
        self.write_record(op::METADATA, |record| {
            put_text(record, name);
            put_block(record, |record| {
                for (key, value) in fields {
                    put_text(record, key);
                    put_text(record, value);
                }
            });
        })?;
        let length = self.written - offset;
        put_record(&mut self.metadata_indexes, op::METADATA_INDEX, |record| {
            record.extend(offset.to_le_bytes());
            record.extend(length.to_le_bytes());
            put_text(record, name);
        });
        Ok(())
    }

    /// Writes a channel and its schema. Returns the id of both; the first one is 1.
    pub fn add_channel(
        &mut self,
        topic: &str,
        encoding: &str,
        schema_name: &str,
        schema: &[u8],
    ) -> io::Result<u16> {
        self.statistics.messages.push(0);
        let id = self.statistics.messages.len() as u16;
        self.write_record(op::SCHEMA, |record| {
            record.extend(id.to_le_bytes());
            put_text(record, schema_name);
            put_text(record, encoding);
            put_block(record, |record| record.extend(schema));
        })?;
        self.declarations.extend(&self.record);
        self.write_record(op::CHANNEL, |record| {
            record.extend(id.to_le_bytes());
            record.extend(id.to_le_bytes());
            put_text(record, topic);
            put_text(record, encoding);
            put_block(record, |_| {});
        })?;
        self.declarations.extend(&self.record);
        Ok(id)
    }

    /// Adds the message that `put` appends to the present chunk.
    pub fn add_message(&mut self, channel: u16, time: Timestamp, put: impl FnOnce(&mut Vec<u8>)) {
        let number = &mut self.statistics.messages[usize::from(channel) - 1];
        *number = number.wrapping_add(1);
        let nanoseconds = time.0.saturating_mul(1_000).to_le_bytes();
        let number = number.to_le_bytes();
        put_record(&mut self.chunk, op::MESSAGE, |chunk| {
            chunk.extend(channel.to_le_bytes());
            chunk.extend(number);
            chunk.extend(nanoseconds);
            chunk.extend(nanoseconds);
            put(chunk);
        });
        let [first, earliest, latest] = self.times.unwrap_or([time; 3]);
        self.times = Some([first, earliest.min(time), latest.max(time)]);
    }

    /// Returns `true` if the present chunk is as long as it may become.
    pub fn is_chunk_due(&self) -> bool {
        let is_long = |[first, earliest, latest]: [Timestamp; 3]| {
            first.0 - earliest.0 >= CHUNK_US || latest.0 - first.0 >= CHUNK_US
        };
        self.chunk.len() >= CHUNK_BYTES || self.times.is_some_and(is_long)
    }

    /// Writes the present chunk, if it has messages, and hands everything to the operating system.
    pub fn end_chunk(&mut self) -> io::Result<()> {
        if let Some([_, earliest, latest]) = self.times.take() {
            self.write_chunk([earliest, latest])?;
            self.chunk.clear();
        }
        self.out.flush()
    }

    fn write_chunk(&mut self, [earliest, latest]: [Timestamp; 2]) -> io::Result<()> {
        let chunk = std::mem::take(&mut self.chunk);
        self.statistics.chunks += 1;
        let [first, last] = self.statistics.times.unwrap_or([earliest, latest]);
        self.statistics.times = Some([first.min(earliest), last.max(latest)]);
        let mut compressed = Ok(());
        self.write_record(op::CHUNK, |record| {
            for time in [earliest, latest] {
                record.extend(time.0.saturating_mul(1_000).to_le_bytes());
            }
            record.extend((chunk.len() as u64).to_le_bytes());
            record.extend(crc32fast::hash(&chunk).to_le_bytes());
            put_text(record, COMPRESSION);
            let start = record.len();
            record.extend([0; 8]);
            compressed = compress(&chunk, record);
            let size = (record.len() - start - 8) as u64;
            record[start..start + 8].copy_from_slice(&size.to_le_bytes());
        })?;
        self.chunk = chunk;
        compressed
    }

    /// Writes the last chunk and the end of the file.
    pub fn finish(&mut self) -> io::Result<()> {
        self.end_chunk()?;
        let checksum = self.checksum.clone().finalize();
        self.write_record(op::DATA_END, |record| record.extend(checksum.to_le_bytes()))?;
        let summary_start = self.written;
        self.checksum = crc32fast::Hasher::new();
        let declarations = std::mem::take(&mut self.declarations);
        self.write(&declarations)?;
        let metadata_indexes = std::mem::take(&mut self.metadata_indexes);
        self.write(&metadata_indexes)?;
        let statistics = std::mem::take(&mut self.statistics);
        self.write_record(op::STATISTICS, |record| statistics.put(record))?;
        // The checksum of the summary includes the footer up to the checksum.
        self.record.clear();
        put_record(&mut self.record, op::FOOTER, |record| {
            record.extend(summary_start.to_le_bytes());
            record.extend(0_u64.to_le_bytes());
            record.extend([0; 4]);
        });
        let end = self.record.len() - 4;
        self.checksum.update(&self.record[..end]);
        let file_checksum = self.checksum.clone().finalize().to_le_bytes();
        self.record[end..].copy_from_slice(&file_checksum);
        self.out.write_all(&self.record)?;
        self.out.write_all(MAGIC)?;
        self.out.flush()
    }

    /// Returns the file.
    pub fn into_inner(self) -> W {
        self.out
    }

    fn write_record(&mut self, opcode: u8, put: impl FnOnce(&mut Vec<u8>)) -> io::Result<()> {
        let mut record = std::mem::take(&mut self.record);
        record.clear();
        put_record(&mut record, opcode, put);
        let written = self.write(&record);
        self.record = record;
        written
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.out.write_all(bytes)?;
        self.checksum.update(bytes);
        self.written += bytes.len() as u64;
        Ok(())
    }
}

impl Statistics {
    fn put(&self, record: &mut Vec<u8>) {
        let messages: u64 = self.messages.iter().map(|&number| u64::from(number)).sum();
        record.extend(messages.to_le_bytes());
        let channels = self.messages.len();
        record.extend((channels as u16).to_le_bytes());
        record.extend((channels as u32).to_le_bytes());
        record.extend(0_u32.to_le_bytes());
        record.extend(self.metadata.to_le_bytes());
        record.extend(self.chunks.to_le_bytes());
        for time in self.times.unwrap_or_default() {
            record.extend(time.0.saturating_mul(1_000).to_le_bytes());
        }
        put_block(record, |record| {
            for (id, &number) in (1_u16..).zip(&self.messages) {
                record.extend(id.to_le_bytes());
                record.extend(u64::from(number).to_le_bytes());
            }
        });
    }
}

/// Appends the LZ4 frame of a chunk.
fn compress(chunk: &[u8], record: &mut Vec<u8>) -> io::Result<()> {
    let settings = FrameInfo::new()
        .block_mode(BlockMode::Independent)
        .block_size(BlockSize::Max1MB);
    let mut encoder = FrameEncoder::with_frame_info(settings, record);
    encoder.write_all(chunk)?;
    encoder.finish()?;
    Ok(())
}

/// Appends a record: its code, its length and its content.
fn put_record(out: &mut Vec<u8>, opcode: u8, put: impl FnOnce(&mut Vec<u8>)) {
    out.push(opcode);
    let start = out.len();
    out.extend([0; 8]);
    put(out);
    let length = (out.len() - start - 8) as u64;
    out[start..start + 8].copy_from_slice(&length.to_le_bytes());
}

/// Appends what `put` appends after its length.
fn put_block(out: &mut Vec<u8>, put: impl FnOnce(&mut Vec<u8>)) {
    let start = out.len();
    out.extend([0; 4]);
    put(out);
    let length = (out.len() - start - 4) as u32;
    out[start..start + 4].copy_from_slice(&length.to_le_bytes());
}

fn put_text(out: &mut Vec<u8>, text: &str) {
    put_block(out, |out| out.extend(text.as_bytes()));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_metadata_record_is_found_by_the_index_in_the_summary() {
        let mut bytes = Vec::new();
        let mut container = Container::new(&mut bytes, "test").unwrap();
        let texts = [("glove", "(1)"), ("layout", "(2)")];
        for (kind, text) in texts {
            let fields = [("kind", kind), ("text", text)];
            container.write_metadata("setup", &fields).unwrap();
        }
        container
            .add_channel("/readings", "protobuf", "a", b"")
            .unwrap();
        container.finish().unwrap();
        let summary = mcap::Summary::read(&bytes).unwrap().expect("a summary");
        let found = summary.metadata_indexes.iter().map(|index| {
            assert_eq!(index.name, "setup");
            let mut fields = mcap::read::metadata(&bytes, index).unwrap().metadata;
            (
                fields.remove("kind").unwrap(),
                fields.remove("text").unwrap(),
            )
        });
        let expected = texts.map(|(kind, text)| (kind.to_owned(), text.to_owned()));
        assert_eq!(found.collect::<Vec<_>>(), expected);
    }
}
