//! Filters between the calibrated angles and the hand.

use super::one_euro::{OneEuroFilter, OneEuroSettings};
use super::rows::Row;
use crate::capture::Channels;

/// Which filter smooths a glove's angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Smoothing {
    /// None: every count shows.
    Off,
    /// The filters of the thesis that the glove comes from, corrected: the mean of this and the last smoothed count of each
    /// channel, then y = (x + y₁ + y₂) / 3 on each angle, its state its own.
    RecursiveAverage,
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

/// The chosen filter and what it remembers of each row of a channel map.
#[derive(Clone, Debug)]
pub(super) enum Smoother {
    Off,
    Thesis(Vec<Option<Thesis>>),
    OneEuro(OneEuroFilter),
}

/// What the thesis's filters remember of one row.
#[derive(Clone, Copy, Debug)]
pub(super) struct Thesis {
    count: f64,
    newer: f64,
    older: f64,
}

impl Smoother {
    pub(super) fn new(kind: Smoothing, rows: usize) -> Self {
        match kind {
            Smoothing::Off => Self::Off,
            Smoothing::RecursiveAverage => Self::Thesis(vec![None; rows]),
            Smoothing::OneEuro(settings) => Self::OneEuro(OneEuroFilter::new(settings, rows)),
        }
    }

    pub(super) fn reset(&mut self) {
        match self {
            Self::Off => {}
            Self::Thesis(memory) => memory.fill(None),
            Self::OneEuro(filter) => filter.reset(),
        }
    }

    /// Smooths in place the angles that `rows` tell of `channels`, `seconds` after the frame before.
    pub(super) fn smooth(
        &mut self,
        angles: &mut [f64],
        rows: &[Row],
        channels: &Channels,
        seconds: f64,
    ) {
        match self {
            Self::Off => {}
            Self::Thesis(memory) => {
                for ((row, memory), angle) in rows.iter().zip(memory).zip(angles) {
                    *angle = Thesis::filter(memory, row, row.count(channels));
                }
            }
            Self::OneEuro(filter) => filter.filter(angles, seconds),
        }
    }
}

impl Thesis {
    fn filter(memory: &mut Option<Self>, row: &Row, count: f64) -> f64 {
        let count = memory.map_or(count, |last| (count + last.count) / 2.0);
        let angle = row.range.clamp(row.calibration.apply(count));
        let (value, newer) = match memory {
            Some(last) => ((angle + last.newer + last.older) / 3.0, last.newer),
            None => (angle, angle),
        };
        *memory = Some(Self {
            count,
            newer: value,
            older: newer,
        });
        value
    }
}
