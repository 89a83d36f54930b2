//! Detection of a converter of 10 bits whose counts are read as counts of 12 bits.

use crate::capture::protocol::StreamFormat;
use crate::capture::protocol::lucidgloves::{CURL, JOINT, MAX, PROTOCOL, SPLAY, STICK_X};
use crate::capture::{Channels, Sample};

/// Largest count of a converter of 10 bits.
const LARGEST_COUNT: u16 = 1023;

/// Smallest difference from the lowest count so far that shows a bent finger, if the converter has 10 bits. The counts of straight
/// fingers differ by less with either converter.
const MIN_BEND: u16 = 384;

/// Number of readings with a bent finger after which a warning is due: 3 s of a usual glove. With 12 bits, a finger passes such counts
/// within some readings, and then exceeds them.
const MIN_BENT_READINGS: u32 = 300;

/// The counts of the fingers of a LucidGloves source that does not state the largest one.
pub struct LowCounts {
    /// `false` once a larger count was seen or a warning was due, and for any other source.
    is_watching: bool,
    lowest: u16,
    /// Readings with a bent finger.
    bent: u32,
}

impl LowCounts {
    /// Creates the detector of a source.
    pub fn new(format: &StreamFormat) -> Self {
        let is_lucidgloves = format.protocol.name == PROTOCOL.name;
        Self {
            is_watching: is_lucidgloves && !format.options.is_stated(&MAX),
            lowest: LARGEST_COUNT,
            bent: 0,
        }
    }

    /// Handles a sample. Returns `true` once, if a warning is due: fingers have bent, and no count was larger than a converter of 10
    /// bits gives. Does not allocate.
    pub fn update(&mut self, sample: &Sample) -> bool {
        let Sample::Channels(channels) = sample else {
            return false;
        };
        if !self.is_watching {
            return false;
        }
        let curls = channels.counts.get(CURL..SPLAY).unwrap_or_default();
        let joints = channels.counts.get(JOINT..STICK_X).unwrap_or_default();
        let mut largest = 0;
        for &count in curls.iter().chain(joints) {
            if count != Channels::UNKNOWN {
                self.lowest = self.lowest.min(count);
                largest = largest.max(count);
            }
        }
        if largest.saturating_sub(self.lowest) >= MIN_BEND {
            self.bent += 1;
        }
        let is_low = largest <= LARGEST_COUNT;
        self.is_watching = is_low && self.bent < MIN_BENT_READINGS;
        is_low && !self.is_watching
    }
}
