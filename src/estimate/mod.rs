//! 2 · [`Reading`](crate::capture::Reading) → [`JointAngles`].

mod calibration;
mod channels;
mod estimator;
mod limits;
mod one_euro;
mod rows;
mod smoothing;

pub use calibration::{AffineMap, FitError, divider_resistance};
pub use channels::{ChannelMap, ChannelRow};
pub use estimator::{Estimator, EstimatorSettings, MAX_ROWS};
pub use limits::JointLimits;
pub use one_euro::{OneEuroFilter, OneEuroSettings};
pub use smoothing::Smoothing;

use crate::hand::{Dof, FingerSet};
use crate::names::named_enum;
use crate::time::Timestamp;

/// The angles of an arm and hand at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointAngles {
    /// When the reading behind them was complete.
    pub time: Timestamp,
    /// Fingers whose sensors cannot be believed at the moment: they press nothing.
    pub untrusted: FingerSet,
    /// Whether the hand was re-acquired in another place: what lies between was not seen.
    pub jumped: bool,
    radians: [f64; Dof::COUNT],
    known: u32,
}

impl JointAngles {
    /// The zero pose, with nothing known.
    pub fn new(time: Timestamp) -> Self {
        Self {
            time,
            untrusted: FingerSet::NONE,
            jumped: false,
            radians: [0.0; Dof::COUNT],
            known: 0,
        }
    }

    /// The angle in radians; 0 where the source does not measure it.
    pub fn get(&self, dof: Dof) -> f64 {
        self.radians[dof.index()]
    }

    /// All angles in radians, in the order of [`Dof::ALL`]; 0 where the source does not measure.
    pub fn radians(&self) -> &[f64; Dof::COUNT] {
        &self.radians
    }

    /// Sets an angle, in radians, and marks it as measured.
    pub fn set(&mut self, dof: Dof, radians: f64) {
        self.radians[dof.index()] = radians;
        self.known |= 1 << dof.index();
    }

    /// Whether the source measures this angle.
    pub fn is_known(&self, dof: Dof) -> bool {
        self.known & (1 << dof.index()) != 0
    }

    /// The measured angles, in the order of [`Dof::ALL`].
    pub fn known(&self) -> impl Iterator<Item = (Dof, f64)> + '_ {
        Dof::ALL
            .iter()
            .filter(|dof| self.is_known(**dof))
            .map(|&dof| (dof, self.get(dof)))
    }
}

named_enum! {
    /// Why a reading gave no angles.
    pub enum Rejection ("reason") {
        /// The reading has too few channels, or is of another kind than the estimator reads.
        WrongShape = "wrong-shape",
        /// It is not later than the one before.
        Stale = "not-later",
        /// An angle came out that is not a finite number.
        NotFinite = "not-finite",
        /// An angle is further outside the joint's range than a calibration error explains.
        OutsideLimits = "outside-limits",
        /// A joint turned faster than a person can; accepted once it stays there.
        TooFast = "too-fast",
    }
}
