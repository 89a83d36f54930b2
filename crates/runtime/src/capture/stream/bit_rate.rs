//! The bit rate of a sender that is slower than the receiver of a serial line.
//!
//! A receiver samples a start bit, eight data bits and a stop bit at its own rate, from a falling edge on. If each bit of the sender
//! lasts k samples, its start bit fills the first k of them, and each of the next bits k more: only a few bytes are possible. A byte
//! whose stop bit is low arrives as 0, as Linux passes it on. A sender that is faster gives bytes of all kinds.

use std::num::NonZeroU32;

/// Bit rates that devices use, the slowest first.
const RATES: [u32; 7] = [9_600, 19_200, 38_400, 57_600, 115_200, 230_400, 460_800];

/// Fewest bytes that show a bit rate.
const MIN_BYTES: usize = 64;

/// Returns the bit rate of the sender of these bytes if it is a fraction of the receiver's, `baud`.
pub fn slower_sender(bytes: &[u8], baud: NonZeroU32) -> Option<u32> {
    if bytes.len() < MIN_BYTES {
        return None;
    }
    let baud = baud.get();
    let slower = RATES.iter().copied();
    let mut slower = slower.filter(|rate| *rate < baud && baud.is_multiple_of(*rate));
    slower.find(|rate| {
        let samples = baud / rate;
        let possible = bytes.iter().filter(|byte| is_possible(**byte, samples));
        // Noise at edges changes one of twenty.
        possible.count() * 20 >= bytes.len() * 19
    })
}

/// Returns `true` if a sender whose bits last this number of samples causes a byte.
fn is_possible(byte: u8, samples: u32) -> bool {
    // Bit 0 is the start bit, and bit 9 the stop bit.
    let received = u32::from(byte) << 1 | 1 << 9;
    let bit = |index: u32| received >> index & 1;
    let is_constant = |index: u32| bit(index) == bit(index / samples * samples);
    byte == 0 || (0..10).all(is_constant)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the bytes that a receiver makes of bytes of a sender whose bits last `samples` of its own, with a pause of `pause` bits
    /// after each.
    fn receive(sent: &[u8], samples: usize, pause: usize) -> Vec<u8> {
        let mut line = vec![true; 20];
        for byte in sent {
            let data = (0..8).map(|bit| byte >> bit & 1 == 1);
            let stop = std::iter::repeat_n(true, 1 + pause);
            let bits = [false].into_iter().chain(data).chain(stop);
            line.extend(bits.flat_map(|level| std::iter::repeat_n(level, samples)));
        }
        line.extend([true; 20]);
        let mut received = Vec::new();
        let mut at = 1;
        while at + 10 < line.len() {
            if line[at] || !line[at - 1] {
                at += 1;
                continue;
            }
            let byte = (0..8).fold(0, |byte, bit| byte | u8::from(line[at + 1 + bit]) << bit);
            received.push(if line[at + 9] { byte } else { 0 });
            at += 9;
        }
        received
    }

    #[test]
    fn slower_senders_are_told_by_the_bytes_that_they_cause() {
        let mut random = fastrand::Rng::with_seed(11);
        let sent: Vec<u8> = (0..400).map(|_| random.u8(..)).collect();
        for (rate, baud, pause) in [
            (9_600, 115_200, 0),
            (9_600, 115_200, 3),
            (19_200, 115_200, 0),
            (38_400, 115_200, 1),
            (57_600, 115_200, 0),
            (9_600, 38_400, 0),
        ] {
            let received = receive(&sent, baud as usize / rate as usize, pause);
            let found = slower_sender(&received, NonZeroU32::new(baud).unwrap());
            assert_eq!(found, Some(rate), "{rate} at {baud}");
        }
    }

    #[test]
    fn bytes_at_the_same_rate_and_too_few_bytes_show_no_other_one() {
        let mut random = fastrand::Rng::with_seed(12);
        let noise: Vec<u8> = (0..400).map(|_| random.u8(..)).collect();
        let baud = NonZeroU32::new(115_200).unwrap();
        assert_eq!(receive(&noise, 1, 0), noise);
        assert_eq!(slower_sender(&noise, baud), None);
        let half_zero: Vec<u8> = noise.iter().flat_map(|byte| [*byte, 0]).collect();
        assert_eq!(slower_sender(&half_zero, baud), None);
        assert_eq!(slower_sender(&[0; 63], baud), None);
    }
}
