//! Chunks: the messages of up to a second, compressed.

use std::io::Read;

use lz4_flex::frame::FrameDecoder;
use mcap::records::ChunkHeader;

use super::MAX_RECORD_BYTES;

/// Name of the compression of chunks in an MCAP file.
pub const COMPRESSION: &str = "lz4";

/// Decompresses the records of a chunk into `records`. Fails if they are not what the header states.
pub(super) fn decompress(
    header: &ChunkHeader,
    data: &[u8],
    records: &mut Vec<u8>,
) -> Result<(), String> {
    let size = header.uncompressed_size;
    if size > MAX_RECORD_BYTES as u64 {
        return Err(format!(
            "a chunk states a size of {size} bytes; the limit is {MAX_RECORD_BYTES}"
        ));
    }
    records.clear();
    match header.compression.as_str() {
        "" => records.extend(data),
        COMPRESSION => {
            // One byte more reveals a chunk that is longer than it states.
            let mut decoder = FrameDecoder::new(data).take(size + 1);
            let read = decoder.read_to_end(records);
            read.map_err(|_| "a chunk cannot be decompressed: the file was damaged")?;
        }
        other => {
            return Err(format!(
                "its chunks are compressed with `{other}`, and this program reads `{COMPRESSION}`; convert it with `mcap \
                 compress --compression {COMPRESSION}`"
            ));
        }
    }
    if records.len() as u64 != size {
        return Err("a chunk has another size than it states".into());
    }
    // 0 stands for no checksum.
    let expected = header.uncompressed_crc;
    if expected != 0 && crc32fast::hash(records) != expected {
        return Err("the messages of a chunk do not match their checksum".into());
    }
    Ok(())
}
