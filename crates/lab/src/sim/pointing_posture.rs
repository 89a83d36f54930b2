//! The posture of a hand before one of its fingers points.

use super::effector::{Effector, Limb};
use super::typing_hand::TypingHand;
use crate::hand::{Dof, Finger};
use crate::kinematics::typing_angle;

/// Flexion of the MCP joint of an index finger that is out of the way of another finger, in radians.
const RAISED: f64 = -0.5;

impl TypingHand {
    /// Returns the channels that have to move before `effector` points, with their values then: the posture at rest, but with a
    /// raised index finger if another finger or no arm points, and with another long finger half flexed if it points with the arm. The
    /// arm stays where it is if it points.
    pub(super) fn pointing_posture(
        &self,
        effector: Effector,
        rest: &[f64],
        values: &[f64],
    ) -> Vec<(usize, f64)> {
        let is_index = effector == Effector::INDEX;
        let value = |index: usize| match self.finger_of(index) {
            None if effector.limb == Limb::Arm => values[index],
            Some(Finger::Index) if !is_index => self.raised(index),
            // From an extended finger, the wrist would go down to the key, and with it the other fingers.
            Some(finger) if finger == effector.finger && effector.flexes() => self.flexed(index),
            _ => rest[index],
        };
        let is_far = |&(index, wanted): &(usize, f64)| {
            let (low, high) = self.variables[index].range;
            (values[index] - wanted).abs() > (high - low) * 1e-3
        };
        let all = (0..self.variables.len()).map(|index| (index, value(index)));
        all.filter(is_far).collect()
    }

    /// Returns the value of a channel of a raised index finger.
    fn raised(&self, index: usize) -> f64 {
        let first = self.variables[index].mappings.first();
        let is_knuckle = first.is_some_and(|(dof, _)| *dof == Dof::IndexMcpFlexion);
        self.value_near(index, if is_knuckle { RAISED } else { 0.0 })
    }

    /// Returns the value of a channel of a finger that is half flexed as the index finger is at rest.
    fn flexed(&self, index: usize) -> f64 {
        let variable = &self.variables[index];
        match variable.mappings.first() {
            Some((dof, _)) if Finger::FLEXIONS.iter().any(|joints| joints.contains(dof)) => {
                self.value_near(index, typing_angle(Dof::IndexMcpFlexion))
            }
            _ => variable.rest,
        }
    }
}
