//! The stages of one hand from readings to poses.

use super::StepOutput;
use super::other_hand::RoomState;
use super::start::StartDetector;
use super::unreached::ReachWatch;
use crate::contact::{Presses, Touches};
use crate::device::TimedCommands;
use crate::estimate::{Estimate, FingerBends, HandEstimator, JointAngles};
use crate::hand::{HandPart, Side};
use crate::kinematics::ArmModel;
use crate::time::Timestamp;

/// The number of consecutive rejected readings after which everything is released. A single one can be a flipped bit;
/// the estimator accepts a jump of the hand at the third reading.
const MAX_CONSECUTIVE_REJECTIONS: u8 = 3;

/// The estimator, arm model and latest output of one hand.
pub(super) struct HandPipeline {
    pub(super) estimator: HandEstimator,
    pub(super) arm: ArmModel,
    /// The latest output, updated in place because it is too large to move for every reading.
    pub(super) output: StepOutput,
    /// The time of the last accepted reading; `None` if none is expected.
    pub(super) last_accepted: Option<Timestamp>,
    /// `true` if the latest pose was clear of every control. A lost hand is not clear.
    pub(super) is_clear: bool,
    /// `true` once any reading has shown the position of the hand.
    was_placed: bool,
    consecutive_rejections: u8,
    /// `true` after the hand has pressed faster than the rate limit while another one is tracked: it touches nothing until the
    /// run is resumed.
    pub(super) is_suspended: bool,
    /// `true` while the source of the hand has repeated all positions for too long.
    pub(super) is_stuck: bool,
    /// `true` if the latest zeroing has changed the hand.
    pub(super) is_zeroed: bool,
    pub(super) start: StartDetector,
    pub(super) reach: ReachWatch,
    pub(super) room: RoomState,
}

impl HandPipeline {
    pub(super) fn new(estimator: impl Into<HandEstimator>, arm: ArmModel) -> Self {
        let estimate = Estimate::new(Timestamp::default(), JointAngles::default());
        Self {
            output: StepOutput {
                estimate,
                pose: arm.forward(&estimate),
                bends: FingerBends::default(),
                touches: Touches::new(),
                presses: Presses::new(),
                commands: TimedCommands::new(),
            },
            estimator: estimator.into(),
            arm,
            last_accepted: None,
            is_clear: false,
            was_placed: false,
            consecutive_rejections: 0,
            is_suspended: false,
            is_stuck: false,
            is_zeroed: false,
            start: StartDetector::default(),
            reach: ReachWatch::default(),
            room: RoomState::default(),
        }
    }

    /// Counts consecutive rejected readings. Returns `true` when the number reaches the limit.
    pub(super) fn count_rejection(&mut self, is_rejected: bool) -> bool {
        self.consecutive_rejections = if is_rejected {
            self.consecutive_rejections.saturating_add(1)
        } else {
            0
        };
        self.consecutive_rejections == MAX_CONSECUTIVE_REJECTIONS
    }

    /// Notes that a reading was accepted. A hand that is suspended, or whose source is stuck, touches nothing; when its source measures
    /// again, the hand counts as re-acquired.
    pub(super) fn accept(&mut self, time: Timestamp) {
        let was_stuck = std::mem::replace(&mut self.is_stuck, self.estimator.is_stuck());
        self.lose_if_stopped();
        self.output.estimate.jumped |= was_stuck;
        self.last_accepted = Some(time);
        self.was_placed |= self.output.estimate.is_placed;
    }

    /// Forgets a part of the hand, or all of it: nothing of what was lost touches or points at anything.
    pub(super) fn lose(&mut self, part: Option<HandPart>) {
        self.is_clear = false;
        match self.estimator.lose(part) {
            Some(rest) => {
                self.output.estimate = *rest;
                self.lose_if_stopped();
            }
            None => {
                self.output.estimate.lose_hand();
                self.last_accepted = None;
            }
        }
    }

    /// Forgets the hand and its inputs if it is suspended or its source is stuck.
    fn lose_if_stopped(&mut self) {
        if self.is_suspended || self.is_stuck {
            self.output.estimate.lose_hand();
        }
    }

    /// Returns `true` if the hand was tracked and is lost.
    pub(super) fn is_lost(&self) -> bool {
        self.was_placed && !self.output.estimate.is_placed
    }

    /// Returns `true` if output may not be armed yet because of this hand: it is tracked, and not clear of every control.
    pub(super) fn blocks_arming(&self) -> bool {
        self.last_accepted.is_some() && self.output.estimate.is_placed && !self.is_clear
    }

    pub(super) fn side(&self) -> Side {
        self.arm.side()
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::capture::{Reading, Sample};
    use crate::document::Document;
    use crate::estimate::{Estimator, EstimatorSettings, FusedEstimator};
    use crate::hand::Dof;

    #[test]
    fn a_hand_that_is_suspended_or_stuck_stays_lost_when_one_of_its_sources_is_lost() {
        let document = Document::shipped("unam").expect("a shipped arm");
        let arm = ArmModel::parse(&document).expect("an arm");
        let mut hands = [(true, false), (false, true), (false, false)].map(|stopped| {
            let estimator = || Estimator::new(EstimatorSettings::default());
            let timeout = Duration::from_millis(200);
            let fused = FusedEstimator::new(estimator(), estimator(), timeout);
            let mut hand = HandPipeline::new(fused, arm.clone());
            for (part, dof) in [
                (HandPart::Arm, Dof::ElbowFlexion),
                (HandPart::Fingers, Dof::IndexMcpFlexion),
            ] {
                let mut angles = JointAngles::default();
                angles.set(dof, 0.1);
                let time = Timestamp(1_000_000 + 5_000 * part.index() as u64);
                let mut reading = Reading::new(time, None, Sample::Angles { angles });
                reading.part = Some(part);
                let estimate = hand
                    .estimator
                    .update(&reading)
                    .expect("a plausible reading");
                hand.output.estimate = *estimate;
                hand.accept(time);
            }
            (hand.is_suspended, hand.is_stuck) = stopped;
            hand
        });
        let lost = hands.each_mut().map(|hand| {
            hand.lose(Some(HandPart::Fingers));
            hand.is_lost()
        });
        assert_eq!(lost, [true, true, false]);
    }
}
