//! Errors of bend sensors beyond their noise: hysteresis, and a drift with time.

use crate::capture::{Channels, MAX_CHANNELS};
use crate::estimate::ChannelMap;
use crate::sim::noise::gaussian;
use crate::time::Timestamp;

/// The errors of all sensors of a glove, in parts of the full scale.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SensorErrors {
    /// The difference of the counts at one bend after closing and after opening: the width of a play, which the sensor has to take
    /// up after each reversal.
    pub hysteresis: f64,
    /// The change of all counts per minute.
    pub drift_per_minute: f64,
    /// The standard deviation of the noise of each count.
    pub noise: f64,
}

/// The sensors of a glove with errors: the play of each has a state.
#[derive(Clone, Debug)]
pub(super) struct SensorPlay {
    errors: SensorErrors,
    channels: Vec<usize>,
    /// The count in the middle of the play; `None` before the first reading.
    middle: [Option<f64>; MAX_CHANNELS],
}

impl SensorPlay {
    pub(super) fn new(errors: SensorErrors, map: &ChannelMap) -> Self {
        Self {
            errors,
            channels: map.rows().iter().map(|row| row.channel).collect(),
            middle: [None; MAX_CHANNELS],
        }
    }

    /// Returns what the converter shows of exact counts.
    pub(super) fn read(
        &mut self,
        exact: &[f64; MAX_CHANNELS],
        full_scale: u16,
        time: Timestamp,
        random: &mut fastrand::Rng,
    ) -> Channels {
        let scale = f64::from(full_scale);
        let reach = self.errors.hysteresis * scale / 2.0;
        let drift = self.errors.drift_per_minute * scale * time.0 as f64 / 60e6;
        let counts = exact.iter().enumerate().map(|(channel, &count)| {
            if !self.channels.contains(&channel) {
                return count.round() as u16;
            }
            let middle = self.middle[channel].unwrap_or(count);
            let middle = middle.clamp(count - reach, count + reach);
            self.middle[channel] = Some(middle);
            let noise = self.errors.noise * scale * gaussian(random);
            (middle + drift + noise).round().clamp(1.0, scale - 1.0) as u16
        });
        Channels {
            full_scale,
            counts: counts.collect(),
            unsent: Default::default(),
        }
    }
}
