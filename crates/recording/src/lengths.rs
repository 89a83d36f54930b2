//! Check of the text lengths in a record, before the MCAP decoder allocates memory for the texts.

use mcap::records::op;

/// Returns `true` if all texts of a record lie within it. The decoder would allocate the stated length, up to 4 GiB,
/// before it finds that the text is missing. Records without texts pass.
pub(super) fn are_within_record(opcode: u8, record: &[u8]) -> bool {
    match opcode {
        op::CHANNEL => channel(record).is_some(),
        op::CHUNK => chunk(record).is_some(),
        op::METADATA => metadata(record).is_some(),
        _ => true,
    }
}

/// Channel: two ids of 16 bits, topic, encoding, pairs of texts.
fn channel(record: &[u8]) -> Option<()> {
    let (_, mut rest) = record.split_first_chunk::<4>()?;
    text(&mut rest)?;
    text(&mut rest)?;
    pairs(&mut rest)
}

/// Chunk: two times, its size and its checksum, name of the compression, records.
fn chunk(record: &[u8]) -> Option<()> {
    let (_, mut rest) = record.split_first_chunk::<28>()?;
    text(&mut rest)?;
    Some(())
}

/// Metadata: name, pairs of texts.
fn metadata(mut record: &[u8]) -> Option<()> {
    text(&mut record)?;
    pairs(&mut record)
}

/// Splits off the next text, which follows its length (32 bits, little-endian).
fn text<'a>(rest: &mut &'a [u8]) -> Option<&'a [u8]> {
    let (length, after) = rest.split_first_chunk::<4>()?;
    let (text, after) = after.split_at_checked(u32::from_le_bytes(*length) as usize)?;
    *rest = after;
    Some(text)
}

fn pairs(rest: &mut &[u8]) -> Option<()> {
    let mut pairs = text(rest)?;
    while !pairs.is_empty() {
        text(&mut pairs)?;
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with_length(text: &[u8]) -> Vec<u8> {
        [&(text.len() as u32).to_le_bytes(), text].concat()
    }

    fn record(head: &[u8], texts: usize) -> Vec<u8> {
        let pairs = [with_length(b"kind"), with_length(b"glove")].concat();
        let mut record = head.to_vec();
        for _ in 0..texts {
            record.extend(with_length(b"ademan"));
        }
        record.extend(with_length(&pairs));
        record
    }

    #[test]
    fn any_length_beyond_its_record_is_detected() {
        for (opcode, head, texts) in [(op::METADATA, 0, 1), (op::CHANNEL, 4, 2)] {
            let whole = record(&vec![0; head], texts);
            assert!(are_within_record(opcode, &whole));
            let lengths: Vec<usize> = (head..whole.len() - 3)
                .filter(|&offset| whole[offset + 1..offset + 4] == [0, 0, 0])
                .filter(|&offset| (4..40).contains(&whole[offset]))
                .collect();
            assert_eq!(lengths.len(), texts + 3, "{whole:?}");
            for offset in lengths {
                let mut wrong = whole.clone();
                wrong[offset..offset + 4].copy_from_slice(&u32::MAX.to_le_bytes());
                assert!(!are_within_record(opcode, &wrong), "at {offset}");
            }
        }
        let mut packed = [&[0_u8; 28][..], &with_length(b"lz4"), &[0; 8]].concat();
        assert!(are_within_record(op::CHUNK, &packed));
        packed[28..32].copy_from_slice(&u32::MAX.to_le_bytes());
        assert!(!are_within_record(op::CHUNK, &packed));
        assert!(
            are_within_record(op::MESSAGE, &[0xff; 8]),
            "a message has no texts"
        );
    }
}
