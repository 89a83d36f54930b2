//! One hand on its way from readings to poses.

use super::StepOutput;
use crate::contact::Touches;
use crate::device::TimedCommands;
use crate::estimate::{Estimate, Estimator, JointAngles};
use crate::hand::Side;
use crate::kinematics::ArmModel;
use crate::time::Timestamp;

/// A hand with what its readings go through.
pub(super) struct Hand {
    pub(super) estimator: Estimator,
    pub(super) arm: ArmModel,
    /// The latest, in place: it is too large to be passed around for nothing.
    pub(super) frame: StepOutput,
    /// When the last reading came that became a pose; `None` when none is expected.
    pub(super) last_accepted: Option<Timestamp>,
    /// Whether the latest pose was off all controls.
    pub(super) is_clear: bool,
    /// How many of its latest readings in a row gave no angles.
    refused: u8,
}

/// So many readings in a row without angles let go of everything: one can be a flipped bit, and whoever is
/// elsewhere all of a sudden is believed at the third.
const REFUSALS: u8 = 3;

impl Hand {
    pub(super) fn new(estimator: Estimator, arm: ArmModel) -> Self {
        let estimate = Estimate::new(Timestamp::default(), JointAngles::default());
        Self {
            frame: StepOutput {
                estimate,
                pose: arm.forward(&estimate),
                touches: Touches::new(),
                commands: TimedCommands::new(),
            },
            estimator,
            arm,
            last_accepted: None,
            is_clear: false,
            refused: 0,
        }
    }

    /// Takes note of what became of a reading; whether it was one too many that gave no angles.
    pub(super) fn was_refused(&mut self, is_refused: bool) -> bool {
        self.refused = match is_refused {
            true => self.refused.saturating_add(1),
            false => 0,
        };
        self.refused == REFUSALS
    }

    pub(super) fn side(&self) -> Side {
        self.arm.side()
    }
}
