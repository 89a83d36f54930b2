//! The bends of fingers that press by bending, for displays and messages.

use super::Pipeline;
use super::hand_pipeline::HandPipeline;
use crate::contact::surface::Target;
use crate::hand::{Finger, FingerSet, Side};

impl Pipeline {
    /// Returns the fingers that must be straightened before they press, because the output is not armed while they are bent;
    /// none if they press by touch.
    pub fn bent_fingers(&self) -> FingerSet {
        let layout = &self.profiles[self.active_profile].layout;
        let bent = self
            .tracked_hands()
            .map(|hand| layout.bent_fingers(&hand.output.pose, &hand.output.bends));
        bent.fold(FingerSet::NONE, FingerSet::union)
    }

    /// Iterates over the known bends of fingers that press a target by bending, with that target.
    pub fn finger_bends(&self) -> impl Iterator<Item = (Side, Finger, f32, &Target)> {
        let scene = self.layout().scene();
        self.tracked_hands().flat_map(move |hand| {
            Finger::ALL.iter().filter_map(move |&finger| {
                let (_, target) = scene.bend_target(hand.side(), finger)?;
                Some((hand.side(), finger, hand.output.bends.get(finger)?, target))
            })
        })
    }

    fn tracked_hands(&self) -> impl Iterator<Item = &HandPipeline> {
        let hands = self.hands.iter();
        hands.filter(|hand| hand.last_accepted.is_some())
    }
}
