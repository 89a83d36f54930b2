//! The state of a hand between two actions.

use std::time::Duration;

use parry3d::math::Vec3;

use super::{Planner, TipState};
use crate::contact::surface::Scene;
use crate::hand::{Finger, FingerSet};
use crate::sim::action::{HandAction, TargetPoint};
use crate::sim::action_error::ActionErrorKind;
use crate::sim::effector::{Effector, Limb};
use crate::sim::motor::Motor;
use crate::sim::movement::Movement;
use crate::sim::reach_target::ReachTarget;
use crate::sim::typing_hand::TypingHand;

/// A hand between two actions.
#[derive(Clone)]
pub(in crate::sim) struct HandState {
    pub(in crate::sim) hand: TypingHand,
    /// The intention of the person.
    pub(in crate::sim) motor: Motor,
    /// Posture after the movements so far.
    pub(in crate::sim) values: Vec<f64>,
    /// Posture to which the hand returns at the end.
    pub(super) rest: Vec<f64>,
    pub(super) tip_state: TipState,
    /// The finger or the hand that moves to the targets.
    pub(super) effector: Effector,
    /// Fingers whose joints the actions have set. They stay as they are when another finger points.
    pub(super) posed: FingerSet,
    pub(super) is_pinched: bool,
    /// Channels other than the thumb's that the pinch changed: their indices, and their values before.
    pub(super) before_pinch: Vec<(usize, f64)>,
    /// First position of the fingertip, clear of all targets (world, metres).
    pub(super) home: Vec3,
    /// Fingers that are bent to press.
    pub(super) bent: Vec<Finger>,
    /// `true` if the boards have moved under the hand: the next way to a target is checked for contacts.
    pub(super) is_displaced: bool,
    /// `true` if the hand has risen since the boards moved under it.
    pub(super) is_raised: bool,
}

impl HandState {
    /// Creates a hand at rest.
    pub(in crate::sim) fn new(hand: TypingHand, motor: Motor) -> Self {
        Self {
            // Resting fingers keep their posture, even if they touch a target.
            posed: motor.resting,
            motor,
            values: hand.rest_values(),
            rest: hand.rest_values(),
            hand,
            tip_state: TipState::Clear,
            effector: Effector::INDEX,
            is_pinched: false,
            before_pinch: Vec::new(),
            home: Vec3::ZERO,
            bent: Vec::new(),
            is_displaced: false,
            is_raised: false,
        }
    }

    /// Returns `true` if the person changes the pointing finger on the way to a target.
    pub(super) fn changes_fingers_on_the_way(&self, effector: Effector) -> bool {
        !self.motor.fingers.is_empty() && effector.limb == Limb::Arm
    }

    /// Returns the posture in which a fingertip is above a point, from the present one.
    pub(super) fn values_above(
        &self,
        effector: Effector,
        point: TargetPoint,
        target: &ReachTarget,
    ) -> Vec<f64> {
        let mut values = self.values.clone();
        let is_posed = |index| {
            let finger = self.hand.finger_of(index);
            finger.is_some_and(|finger| self.posed.contains(finger))
        };
        for (index, value) in self.hand.pointing_posture(effector, &self.rest, &values) {
            if !is_posed(index) {
                values[index] = value;
            }
        }
        let hover = target.tip_position(point, target.hover_height);
        self.hand.reach_with(effector, hover, &mut values, &[]);
        values
    }

    /// Stays in the posture `values` while the boards move.
    pub(in crate::sim) fn displace(&mut self, values: &[f64]) {
        self.values.copy_from_slice(values);
        self.tip_state = TipState::Clear;
        self.is_pinched = false;
        self.bent.clear();
        self.is_displaced = true;
        self.is_raised = false;
    }

    /// Copies the rest posture, the effector and the posed fingers from an earlier state of the hand.
    pub(in crate::sim) fn keep_habits(&mut self, earlier: &Self) {
        self.rest.clone_from(&earlier.rest);
        self.effector = earlier.effector;
        self.posed = earlier.posed;
    }

    /// Replaces the person by the person of another state, and keeps the posture and the learned positions of the keys.
    pub(in crate::sim) fn set_person(&mut self, other: Self) {
        let keys = std::mem::take(&mut self.motor.keys);
        (self.hand, self.motor, self.rest) = (other.hand, other.motor, other.rest);
        self.motor.keys = keys;
    }

    /// Moves the hand to the start of these actions, and returns the movements.
    pub(in crate::sim) fn begin(
        &mut self,
        actions: &[HandAction],
        scene: &Scene,
        period: Duration,
    ) -> Vec<Movement> {
        let mut planner = Planner::new(self.clone(), scene, period);
        planner.begin(actions);
        *self = planner.state;
        planner.movements
    }

    /// Plans actions that follow. An error changes nothing.
    pub(in crate::sim) fn add(
        &mut self,
        actions: &[HandAction],
        scene: &Scene,
        period: Duration,
    ) -> Result<Vec<Movement>, ActionErrorKind> {
        let mut planner = Planner::new(self.clone(), scene, period);
        for action in actions {
            planner.add(action)?;
            planner.check_pinch()?;
        }
        *self = planner.state;
        Ok(planner.movements)
    }

    /// Plans the return to the first posture.
    pub(in crate::sim) fn end(&mut self, scene: &Scene, period: Duration) -> Vec<Movement> {
        let mut planner = Planner::new(self.clone(), scene, period);
        planner.end();
        *self = planner.state;
        planner.movements
    }
}
