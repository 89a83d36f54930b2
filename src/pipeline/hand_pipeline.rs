//! The stages of one hand from readings to poses.

use super::StepOutput;
use crate::contact::Touches;
use crate::device::TimedCommands;
use crate::estimate::{Estimate, Estimator, JointAngles};
use crate::hand::Side;
use crate::kinematics::ArmModel;
use crate::time::Timestamp;

/// The number of consecutive rejected readings after which everything is released. A single one can be a flipped bit;
/// the estimator accepts a jump of the hand at the third reading.
const MAX_CONSECUTIVE_REJECTIONS: u8 = 3;

/// The estimator, arm model and latest output of one hand.
pub(super) struct HandPipeline {
    pub(super) estimator: Estimator,
    pub(super) arm: ArmModel,
    /// The latest output, updated in place because it is too large to move for every reading.
    pub(super) output: StepOutput,
    /// The time of the last accepted reading; `None` if none is expected.
    pub(super) last_accepted: Option<Timestamp>,
    /// `true` if the latest pose was clear of every control.
    pub(super) is_clear: bool,
    consecutive_rejections: u8,
}

impl HandPipeline {
    pub(super) fn new(estimator: Estimator, arm: ArmModel) -> Self {
        let estimate = Estimate::new(Timestamp::default(), JointAngles::default());
        Self {
            output: StepOutput {
                estimate,
                pose: arm.forward(&estimate),
                touches: Touches::new(),
                commands: TimedCommands::new(),
            },
            estimator,
            arm,
            last_accepted: None,
            is_clear: false,
            consecutive_rejections: 0,
        }
    }

    /// Counts consecutive rejected readings. Returns `true` when the number reaches the limit.
    pub(super) fn count_rejection(&mut self, is_rejected: bool) -> bool {
        self.consecutive_rejections = match is_rejected {
            true => self.consecutive_rejections.saturating_add(1),
            false => 0,
        };
        self.consecutive_rejections == MAX_CONSECUTIVE_REJECTIONS
    }

    pub(super) fn side(&self) -> Side {
        self.arm.side()
    }
}
