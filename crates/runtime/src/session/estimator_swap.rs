//! The swap of an estimator between two readings.

use crossbeam_channel::Sender;

use ademan_core::estimate::Estimator;

/// An estimator that is ready to replace the estimator of the first hand.
#[derive(Debug)]
pub(super) struct EstimatorSwap {
    /// The new estimator.
    pub estimator: Box<Estimator>,
    /// Receives the old estimator after the swap.
    pub retired: Sender<Box<Estimator>>,
}
