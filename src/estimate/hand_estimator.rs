//! The estimator of a hand that one or two sources measure.

use std::time::Duration;

use super::{Estimate, Estimator, FusedEstimator, Rejection};
use crate::capture::Reading;
use crate::hand::HandPart;

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

    /// Forgets a part of the hand, or all of it. Returns what remains, or `None` if that is nothing.
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
