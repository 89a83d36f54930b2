//! The hand of a person: its joint limits, and its resting fingers.

use super::typing_hand::TypingHand;
use crate::estimate::JointLimits;
use crate::hand::FingerSet;
use crate::kinematics::half_bent_fingers;

impl TypingHand {
    /// Becomes a hand whose joints have these limits, besides the limits of its sensors.
    #[must_use]
    pub fn with_limits(mut self, limits: &JointLimits) -> Self {
        if *limits == JointLimits::human() {
            return self;
        }
        for variable in &mut self.variables {
            let (mut low, mut high) = variable.range;
            for (dof, map) in &variable.mappings {
                let (least, most) = limits.range(*dof);
                let ends = (map.apply_inverse(least), map.apply_inverse(most));
                low = low.max(ends.0.min(ends.1));
                high = high.min(ends.0.max(ends.1));
            }
            // Joints that one sensor bends together may have no angle in common.
            if low <= high {
                variable.range = (low, high);
            }
            variable.rest = variable.rest.clamp(variable.range.0, variable.range.1);
        }
        self.at_rest()
    }

    /// Becomes a hand whose `fingers` rest half bent.
    #[must_use]
    pub(super) fn with_resting(mut self, fingers: FingerSet) -> Self {
        if fingers.is_empty() {
            return self;
        }
        let half_bent = half_bent_fingers();
        for variable in &mut self.variables {
            let Some((dof, map)) = variable.mappings.first() else {
                continue;
            };
            if dof.finger().is_some_and(|finger| fingers.contains(finger)) {
                let (low, high) = variable.range;
                variable.rest = map.apply_inverse(half_bent.get(*dof)).clamp(low, high);
            }
        }
        self.at_rest()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Document;
    use crate::hand::Side;
    use crate::kinematics::{ArmModel, BoneLengths};
    use crate::layout::Glove;

    #[test]
    fn a_glove_whose_counts_never_show_an_angle_of_the_joint_is_worn_all_the_same() {
        let bones = BoneLengths::from_hand_and_forearm(0.18, 0.25).expect("lengths");
        let arm = ArmModel::anthropometric(Side::Right, &bones).expect("an arm");
        for offset in [-1000.0, 1000.0] {
            let text = format!(
                "Glove(name: \"g\", side: \"right\", full_scale_counts: 255, rows: [(label: \"a\", dof: \"elbow-flexion\", \
                 channel: 1, offset_counts: {offset}, full_scale_rad: 1, offset_rad: 0)])"
            );
            let document = Document::new("g.ron", text.as_str());
            let map = Glove::parse(&document).expect("a glove").map;
            let hand = TypingHand::new(&arm, &map).with_limits(&JointLimits::human());
            let rest = hand.rest_values()[0];
            assert!((1.0..=254.0).contains(&rest), "{offset}: {rest}");
        }
    }
}
