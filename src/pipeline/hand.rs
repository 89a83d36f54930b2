//! One hand on its way from readings to poses.

use super::Frame;
use crate::contact::Touches;
use crate::estimate::{Estimator, JointAngles};
use crate::hand::Side;
use crate::kinematics::ArmModel;
use crate::time::Timestamp;

/// A hand with what its readings go through.
pub(super) struct Hand {
    pub(super) estimator: Estimator,
    pub(super) arm: ArmModel,
    /// The latest, in place: it is too large to be passed around for nothing.
    pub(super) frame: Frame,
    /// When the last reading came that became a pose; `None` when none is expected.
    pub(super) last_accepted: Option<Timestamp>,
    /// Whether the latest pose was off all controls.
    pub(super) is_clear: bool,
}

impl Hand {
    pub(super) fn new(estimator: Estimator, arm: ArmModel) -> Self {
        let angles = JointAngles::at(Timestamp::default());
        Self {
            frame: Frame {
                angles,
                pose: arm.forward(&angles),
                touches: Touches::new(),
            },
            estimator,
            arm,
            last_accepted: None,
            is_clear: false,
        }
    }

    pub(super) fn side(&self) -> Side {
        self.arm.side()
    }
}
