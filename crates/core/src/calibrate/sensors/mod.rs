//! Parameters of bend sensors: jitter, hysteresis, repeatability and drift, from a recording of repeated poses with pauses.
//!
//! One cycle is straight, half bent, closed, half bent, straight, each held for 2 s. The half-bent pose is the same from both
//! sides: the fingers lie along a template. Each channel is evaluated on its own, in three steps:
//!
//! 1. **Holds**: the times at which the channel is still, without the first and the last 0.3 s. The first hold of a recording gives only
//!    jitter, because it is not approached from either side.
//! 2. **Levels**: holds in the lowest fifth of the channel's range are at its low end, holds in the highest fifth at its high end.
//!    A single hold between two different ends is half-way, from the side of the end before it.
//! 3. **Parameters**, in counts. Let yᵢ be the mean of hold i, tᵢ the middle of its time, and g one of the four groups low, high,
//!    rising and falling; bars are means over a group, and N is the number of holds in groups.
//!
//! | parameter | formula |
//! |---|---|
//! | span | ȳ(high) − ȳ(low) |
//! | jitter | the root of the pooled variance within windows of 0.5 s of all holds |
//! | drift d | Σ (tᵢ − t̄g)(yᵢ − ȳg) / Σ (tᵢ − t̄g)²: the common slope of the groups, in counts per minute |
//! | repeatability | √(Σ (yᵢ − ȳg − d(tᵢ − t̄g))² / (N − groups − 1)): the standard deviation of a pose that is taken again |
//! | hysteresis | mean of (yᵢ − d tᵢ) over falling − its mean over rising: positive if the sensor lags behind the movement |
//!
//! Hysteresis and repeatability follow IEC 61298-2 ("difference between upscale and downscale readings for the same input in
//! the same cycle"; "closeness of agreement among consecutive measurements approached from the same direction"), with a mean and a
//! standard deviation in place of a largest difference. All are usually stated in percent of the span.

mod holds;
mod parameters;

use self::holds::holds;
pub use self::parameters::{Drift, HoldCounts, MIN_CYCLES, SensorParameters};
use crate::capture::{ChannelSet, Channels};
use crate::time::Timestamp;

/// The most counts that are kept: 40 minutes of 22 channels at 175 readings per second.
const MAX_COUNTS: usize = 10_000_000;

/// The counts of some channels in the course of time.
#[derive(Clone, Debug)]
pub struct SensorRecording {
    /// The indices of the channels; by default the channels of the first reading.
    channels: Option<Vec<usize>>,
    full_scale: u16,
    times: Vec<Timestamp>,
    /// The counts by position in `channels`, then by reading.
    counts: Vec<Vec<u16>>,
    /// Channels that no reading has carried.
    unsent: ChannelSet,
    ignored: usize,
}

impl SensorRecording {
    /// Creates an empty recording of these channels, or of all channels that the first reading carries.
    pub fn new(channels: Option<Vec<usize>>) -> Self {
        let counts = channels.as_ref().map_or(0, Vec::len);
        Self {
            channels,
            full_scale: 0,
            times: Vec::new(),
            counts: vec![Vec::new(); counts],
            unsent: ChannelSet::ALL,
            ignored: 0,
        }
    }

    /// Adds a reading. Readings beyond a limit of memory, of another glove, or older than the last one are
    /// [ignored](Self::ignored).
    pub fn push(&mut self, time: Timestamp, reading: &Channels) {
        let channels = self.channels.get_or_insert_with(|| {
            let all = 0..reading.counts.len();
            all.filter(|&channel| {
                !reading.unsent.contains(channel) && reading.counts[channel] != Channels::UNKNOWN
            })
            .collect()
        });
        self.counts.resize(channels.len(), Vec::new());
        if self.times.is_empty() {
            self.full_scale = reading.full_scale;
        }
        let is_late = self.times.last().is_some_and(|last| time <= *last);
        let is_full = (self.times.len() + 1) * channels.len() > MAX_COUNTS;
        if is_late || is_full || reading.full_scale != self.full_scale {
            self.ignored += 1;
            return;
        }
        self.times.push(time);
        self.unsent = self.unsent.intersection(reading.unsent);
        for (counts, &channel) in self.counts.iter_mut().zip(channels.iter()) {
            let count = reading.counts.get(channel).copied();
            counts.push(count.unwrap_or(Channels::UNKNOWN));
        }
    }

    /// Returns the number of readings.
    pub fn readings(&self) -> usize {
        self.times.len()
    }

    /// Returns the number of readings that were not kept.
    pub fn ignored(&self) -> usize {
        self.ignored
    }

    /// Returns the largest count of the glove, or 0 without a reading.
    pub fn full_scale(&self) -> u16 {
        self.full_scale
    }

    /// Returns the parameters of each channel, in the order of the channels, without those that no reading has carried.
    pub fn parameters(&self) -> Vec<SensorParameters> {
        let is_empty = self.times.is_empty();
        let channels = self.channels.iter().flatten();
        channels
            .zip(&self.counts)
            .filter(|(channel, _)| is_empty || !self.unsent.contains(**channel))
            .map(|(&channel, counts)| {
                let holds = holds(&self.times, counts, self.full_scale);
                SensorParameters::new(channel, self.full_scale, &holds)
            })
            .collect()
    }
}

#[cfg(test)]
mod tests;
