//! Filters between the calibrated angles and the hand.

use super::one_euro::{OneEuro, OneEuroSettings};
use crate::capture::MAX_CHANNELS;

/// Which filter smooths a glove's angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Smoothing {
    /// None: every count shows.
    Off,
    /// The filters of the seed, corrected: the mean of this and the last smoothed count of each
    /// channel, then y = (x + y₁ + y₂) / 3 on each angle, its state its own.
    Thesis,
    /// A 1-Euro filter on each angle; `beta` in Hz per rad/s.
    OneEuro(OneEuroSettings),
}

impl Default for Smoothing {
    /// 1-Euro, tuned on simulated key strokes through 8-bit counts at 14.5 and 174.5 frames a second.
    fn default() -> Self {
        Self::OneEuro(OneEuroSettings {
            min_cutoff_hz: 2.0,
            beta: 6.0,
            derivative_cutoff_hz: 4.0,
        })
    }
}

/// The state of the chosen filter: one lane for each row of a channel map.
#[derive(Clone, Debug)]
pub(super) struct Smoother {
    kind: Smoothing,
    counts: [Option<f64>; MAX_CHANNELS],
    lanes: Vec<Lane>,
}

#[derive(Clone, Debug)]
enum Lane {
    Off,
    Thesis(Option<(f64, f64)>),
    OneEuro(OneEuro),
}

impl Smoother {
    pub(super) fn new(kind: Smoothing, rows: usize) -> Self {
        let lane = match kind {
            Smoothing::Off => Lane::Off,
            Smoothing::Thesis => Lane::Thesis(None),
            Smoothing::OneEuro(settings) => Lane::OneEuro(OneEuro::new(settings)),
        };
        Self {
            kind,
            counts: [None; MAX_CHANNELS],
            lanes: vec![lane; rows],
        }
    }

    pub(super) fn reset(&mut self) {
        self.counts = [None; MAX_CHANNELS];
        for lane in &mut self.lanes {
            match lane {
                Lane::Off => {}
                Lane::Thesis(state) => *state = None,
                Lane::OneEuro(filter) => filter.reset(),
            }
        }
    }

    /// Smooths the counts of one frame where the filter works on counts: call once a frame.
    pub(super) fn smooth_counts(&mut self, counts: &[u16], smoothed: &mut [f64; MAX_CHANNELS]) {
        for (channel, (&count, out)) in counts.iter().zip(smoothed).enumerate() {
            let count = f64::from(count);
            *out = match (self.kind, self.counts[channel]) {
                (Smoothing::Thesis, Some(last)) => (count + last) / 2.0,
                _ => count,
            };
            self.counts[channel] = Some(*out);
        }
    }

    /// Smooths the angle of one row, `seconds` after the frame before.
    pub(super) fn smooth_angle(&mut self, row: usize, angle: f64, seconds: f64) -> f64 {
        match &mut self.lanes[row] {
            Lane::Off => angle,
            Lane::Thesis(state) => {
                let (newer, older) = state.unwrap_or((angle, angle));
                let value = match state {
                    Some(_) => (angle + newer + older) / 3.0,
                    None => angle,
                };
                *state = Some((value, newer));
                value
            }
            Lane::OneEuro(filter) => filter.filter(angle, seconds),
        }
    }
}
