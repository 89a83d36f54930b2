//! Smoothing filters for joint angles.

use super::JointAngles;
use super::one_euro::{OneEuroFilter, OneEuroSettings};
use crate::hand::Dof;

/// A choice of smoothing filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Smoothing {
    /// No filter.
    Off,
    /// The filters of the 68HC11 glove's original software, corrected: s = (x + s₁) / 2 on each angle, then
    /// y = (s + y₁ + y₂) / 3. The result does not depend on the time between readings.
    RecursiveAverage,
    /// A 1-Euro filter on each angle; `beta` in Hz per rad/s.
    OneEuro(OneEuroSettings),
}

impl Default for Smoothing {
    /// A 1-Euro filter, tuned on simulated key presses through 8-bit counts at 14.5 and 174.5 readings per second.
    fn default() -> Self {
        Self::OneEuro(OneEuroSettings {
            min_cutoff_hz: 2.0,
            beta: 6.0,
            derivative_cutoff_hz: 4.0,
        })
    }
}

/// The chosen filter and its state for every degree of freedom.
#[derive(Clone, Debug)]
pub(super) enum Smoother {
    Off,
    RecursiveAverage(Box<RecursiveAverage>),
    OneEuro(Box<OneEuroFilter<{ Dof::COUNT }>>),
}

/// The state of [`Smoothing::RecursiveAverage`].
#[derive(Clone, Debug, Default)]
pub(super) struct RecursiveAverage {
    has_samples: bool,
    /// s₁ of each degree of freedom.
    means: [f64; Dof::COUNT],
    /// y₁ and y₂ of each degree of freedom.
    outputs: [[f64; 2]; Dof::COUNT],
}

impl Smoother {
    pub(super) fn new(smoothing: Smoothing) -> Self {
        match smoothing {
            Smoothing::Off => Self::Off,
            Smoothing::RecursiveAverage => Self::RecursiveAverage(Box::default()),
            Smoothing::OneEuro(settings) => Self::OneEuro(Box::new(OneEuroFilter::new(settings))),
        }
    }

    /// Clears the state: the next angles pass unchanged.
    pub(super) fn reset(&mut self) {
        match self {
            Self::Off => {}
            Self::RecursiveAverage(filter) => filter.has_samples = false,
            Self::OneEuro(filter) => filter.reset(),
        }
    }

    /// Filters the angles in place, measured `seconds` after the previous ones.
    pub(super) fn filter(&mut self, angles: &mut JointAngles, seconds: f64) {
        match self {
            Self::Off => {}
            Self::RecursiveAverage(filter) => filter.filter(angles.radians_mut()),
            Self::OneEuro(filter) => filter.filter(angles.radians_mut(), seconds),
        }
    }
}

impl RecursiveAverage {
    fn filter(&mut self, angles: &mut [f64; Dof::COUNT]) {
        if !self.has_samples {
            self.has_samples = true;
            self.means = *angles;
            self.outputs = angles.map(|angle| [angle; 2]);
            return;
        }
        let state = self.means.iter_mut().zip(&mut self.outputs);
        for (angle, (mean, [newer, older])) in angles.iter_mut().zip(state) {
            *mean = (*angle + *mean) / 2.0;
            *angle = (*mean + *newer + *older) / 3.0;
            (*newer, *older) = (*angle, *newer);
        }
    }
}
