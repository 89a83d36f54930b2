//! Lengths that a record states of its texts, looked at before anybody makes room for them.

use mcap::records::op;

/// Whether all texts of a record lie within it: room for what a length says, up to 4 GiB, would be made before the
/// text is found to be missing. Records of kinds without texts do.
pub(super) fn fit(opcode: u8, record: &[u8]) -> bool {
    match opcode {
        op::CHANNEL => channel(record).is_some(),
        op::METADATA => metadata(record).is_some(),
        _ => true,
    }
}

/// Two numbers, topic and encoding, pairs of texts.
fn channel(record: &[u8]) -> Option<()> {
    let (_, mut rest) = record.split_first_chunk::<4>()?;
    text(&mut rest)?;
    text(&mut rest)?;
    pairs(&mut rest)
}

/// A name, pairs of texts.
fn metadata(mut record: &[u8]) -> Option<()> {
    text(&mut record)?;
    pairs(&mut record)
}

/// Takes the next text, which has its length in front of it.
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
    fn a_length_beyond_its_record_is_found_wherever_it_is() {
        for (opcode, head, texts) in [(op::METADATA, 0, 1), (op::CHANNEL, 4, 2)] {
            let whole = record(&vec![0; head], texts);
            assert!(fit(opcode, &whole));
            let lengths: Vec<usize> = (head..whole.len() - 3)
                .filter(|&place| whole[place + 1..place + 4] == [0, 0, 0])
                .filter(|&place| (4..40).contains(&whole[place]))
                .collect();
            assert_eq!(lengths.len(), texts + 3, "{whole:?}");
            for place in lengths {
                let mut wrong = whole.clone();
                wrong[place..place + 4].copy_from_slice(&u32::MAX.to_le_bytes());
                assert!(!fit(opcode, &wrong), "at {place}");
            }
        }
        assert!(fit(op::MESSAGE, &[0xff; 8]), "it has no texts");
    }
}
