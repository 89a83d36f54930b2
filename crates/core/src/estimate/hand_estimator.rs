//! The estimator of a hand that one or two sources measure.

use std::time::Duration;

use parry3d::math::Vec3;

use super::{
    BendRanges, Estimate, Estimator, FusedEstimator, Implausible, LearnedRange, Rejection,
    ZeroError, Zeroed,
};
use crate::capture::Reading;
use crate::hand::{BodyPoint, Dof, HandPart};

/// The estimator of one hand.
#[derive(Clone, Debug)]
pub enum HandEstimator {
    /// One source measures the arm and the fingers.
    Single(Box<Estimator>),
    /// Two sources measure them.
    Fused(Box<FusedEstimator>),
}

impl From<Estimator> for HandEstimator {
    fn from(estimator: Estimator) -> Self {
        Self::Single(Box::new(estimator))
    }
}

impl From<FusedEstimator> for HandEstimator {
    fn from(estimator: FusedEstimator) -> Self {
        Self::Fused(Box::new(estimator))
    }
}

impl HandEstimator {
    /// Converts a reading. A rejected reading changes nothing. Does not allocate.
    pub fn update(&mut self, reading: &Reading) -> Result<&Estimate, Rejection> {
        match self {
            Self::Single(estimator) => estimator.update(reading),
            Self::Fused(estimator) => estimator.update(reading),
        }
    }

    /// Sets the time without a reading after which one of two parts is lost.
    pub fn set_timeout(&mut self, timeout: Duration) {
        if let Self::Fused(estimator) = self {
            estimator.set_timeout(timeout);
        }
    }

    /// Turns the present angles into the rest pose: see [`Estimator::zero`]. Of two parts, the fingers are zeroed.
    pub fn zero(&mut self) -> Result<(), ZeroError> {
        self.fingers_mut().zero()
    }

    /// Removes the offsets of [`zero`](Self::zero).
    pub fn undo_zero(&mut self) -> Result<(), ZeroError> {
        self.fingers_mut().undo_zero()
    }

    /// Returns the effect of [`zero`](Self::zero), if there is one.
    pub fn zeroed(&self) -> Option<Zeroed> {
        self.fingers().zeroed()
    }

    /// Returns `true` if a sensor has been beyond its range: see [`Estimator::is_widening_due`].
    pub fn is_widening_due(&self) -> bool {
        self.fingers().is_widening_due()
    }

    /// Widens ranges: see [`Estimator::widen_ranges`].
    pub fn widen_ranges(&mut self) {
        self.fingers_mut().widen_ranges();
    }

    /// Returns to the calibrated ranges.
    pub fn undo_learning(&mut self) {
        self.fingers_mut().undo_learning();
    }

    /// Discards observed excursions: see [`Estimator::forget_excursions`].
    pub fn forget_excursions(&mut self) {
        self.fingers_mut().forget_excursions();
    }

    /// Returns the position of a point of the body, which the source of the arm measures: see [`Estimator::body_point`].
    pub fn body_point(&self, point: BodyPoint) -> Option<Vec3> {
        match self {
            Self::Single(estimator) => estimator.body_point(point),
            Self::Fused(estimator) => estimator.arm()?.body_point(point),
        }
    }

    /// Returns `true` if everything that shows the hand has repeated all of its positions exactly for more than 5 s, so that it is not
    /// known where the hand is.
    pub fn is_stuck(&self) -> bool {
        match self {
            Self::Single(estimator) => estimator.is_stuck(),
            Self::Fused(estimator) => estimator.is_stuck(),
        }
    }

    /// Returns the parts of the hand that are not trusted because their readings are implausible.
    pub fn implausible(&self) -> Implausible {
        match self {
            Self::Single(estimator) => estimator.implausible(),
            Self::Fused(estimator) => estimator.implausible(),
        }
    }

    /// Returns the sensor channel of an angle that is implausible, if a glove measures it.
    pub fn channel_of(&self, dof: Dof) -> Option<usize> {
        match self {
            Self::Single(estimator) => estimator.channel_of(dof),
            Self::Fused(estimator) => estimator.channel_of(dof),
        }
    }

    /// Returns the angles at which the fingers are straight and closed.
    pub fn bend_ranges(&self) -> &BendRanges {
        self.fingers().bend_ranges()
    }

    /// Iterates over the ranges that were widened.
    pub fn learned_ranges(&self) -> impl Iterator<Item = LearnedRange> {
        self.fingers().learned_ranges()
    }

    /// Exchanges the estimator of the whole hand, or of the fingers if another source measures the arm, for one with another
    /// calibration or filter. The offsets of [`zero`](Self::zero) stay, and the next estimate jumps. Does not allocate.
    pub fn exchange(&mut self, estimator: &mut Estimator) {
        let own = self.fingers_mut();
        estimator.adopt_zero(own);
        std::mem::swap(own, estimator);
    }

    fn fingers(&self) -> &Estimator {
        match self {
            Self::Single(estimator) => estimator,
            Self::Fused(estimator) => estimator.fingers(),
        }
    }

    fn fingers_mut(&mut self) -> &mut Estimator {
        match self {
            Self::Single(estimator) => estimator,
            Self::Fused(estimator) => estimator.fingers_mut(),
        }
    }

    /// Forgets a part of the hand, or all of it. Returns the estimate of the rest, or `None` if nothing remains.
    pub fn lose(&mut self, part: Option<HandPart>) -> Option<&Estimate> {
        match (self, part) {
            (Self::Fused(estimator), Some(part)) => estimator.lose(part),
            (Self::Fused(estimator), None) => {
                estimator.lose_all();
                None
            }
            (Self::Single(_), _) => None,
        }
    }
}
