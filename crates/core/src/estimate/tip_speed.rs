//! Plausibility of measured fingertips: the displacement of each from one reading to the next.

use arrayvec::ArrayVec;
use parry3d::math::Vec3;

use super::{Estimate, MeasuredJoints};
use crate::hand::{Finger, FingerSet, Joint};

/// The distance of a fingertip from its knuckle, in metres: the lever by which a rotation of a finger joint moves the fingertip.
const FINGER_LENGTH: f64 = 0.09;

/// The distance of a fingertip from the wrist, in metres: the lever by which a rotation of the wrist moves the fingertip.
const HAND_LENGTH: f64 = 0.2;

/// The fewest fingertips whose common movement counts as a movement of the hand.
const MIN_TIPS_OF_HAND: usize = 3;

/// The positions of the measured fingertips, in metres.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tips {
    known: FingerSet,
    at: [Vec3; Finger::COUNT],
}

impl Tips {
    /// Returns the trusted fingertips of an estimate that were measured, relative to the joint that moves with the hand.
    pub(super) fn measured(estimate: &Estimate, origin: Option<Vec3>) -> Self {
        let mut tips = Self::default();
        let measured: &MeasuredJoints = &estimate.measured;
        if measured.is_empty() {
            return tips;
        }
        let origin = origin.unwrap_or(Vec3::ZERO);
        for &finger in Finger::ALL {
            let tip = measured.get(Joint::tip(finger));
            if let Some(tip) = tip.filter(|_| !estimate.untrusted.contains(finger)) {
                tips.set(finger, tip - origin);
            }
        }
        tips
    }

    /// Returns `true` if no fingertip was measured.
    pub(super) fn is_empty(&self) -> bool {
        self.known.is_empty()
    }

    /// Forgets the tips of `fingers`.
    pub(super) fn remove(&mut self, fingers: FingerSet) {
        self.known = self.known.difference(fingers);
    }

    fn set(&mut self, finger: Finger, at: Vec3) {
        self.at[finger.index()] = at;
        self.known = self.known.with(finger);
    }

    fn get(&self, finger: Finger) -> Option<Vec3> {
        self.known.contains(finger).then(|| self.at[finger.index()])
    }

    /// Returns the fingers of a later reading that moved further against the hand than a finger does while a joint turns by
    /// `rotation` radians.
    pub(super) fn out_of_reach(&self, later: &Self, rotation: f64) -> FingerSet {
        let moves = self.moves(later);
        let hand = median(&moves);
        let reach = (rotation * FINGER_LENGTH) as f32;
        let beyond = moves
            .iter()
            .filter(|(_, moved)| (*moved - hand).length() > reach);
        beyond.fold(FingerSet::NONE, |fingers, &(finger, _)| {
            fingers.with(finger)
        })
    }

    /// Returns `true` if every fingertip that both readings have moved further than a hand does while a joint turns by `rotation`
    /// radians: a tracker has taken another hand for this one.
    pub(super) fn are_all_out_of_reach(&self, later: &Self, rotation: f64) -> bool {
        let reach = (rotation * HAND_LENGTH) as f32;
        let moves = self.moves(later);
        !moves.is_empty() && moves.iter().all(|(_, moved)| moved.length() > reach)
    }

    /// Returns the movements of the fingertips that both readings have.
    fn moves(&self, later: &Self) -> Moves {
        let moved = |&finger: &Finger| Some((finger, later.get(finger)? - self.get(finger)?));
        Finger::ALL.iter().filter_map(moved).collect()
    }
}

/// The movements of fingertips, in metres.
type Moves = ArrayVec<(Finger, Vec3), { Finger::COUNT }>;

/// Returns the median of movements along each axis, or no movement if there are too few.
fn median(moves: &Moves) -> Vec3 {
    if moves.len() < MIN_TIPS_OF_HAND {
        return Vec3::ZERO;
    }
    let along = |axis: usize| {
        let mut values: ArrayVec<f32, { Finger::COUNT }> =
            moves.iter().map(|(_, moved)| moved[axis]).collect();
        values.sort_unstable_by(f32::total_cmp);
        values[values.len() / 2]
    };
    Vec3::new(along(0), along(1), along(2))
}

/// The last plausible position of each fingertip, and implausible positions that consecutive readings may confirm.
#[derive(Clone, Debug, Default)]
pub(super) struct TipSpeed {
    last: Tips,
    candidates: Tips,
    /// The number of consecutive readings that agree on each candidate.
    agreeing: [u8; Finger::COUNT],
}

impl TipSpeed {
    /// Forgets all fingertips.
    pub(super) fn reset(&mut self) {
        *self = Self::default();
    }

    /// Adds the fingertips of a reading and returns the fingers that moved faster than a person can: further than while a joint turns by
    /// `rotation` radians. A fingertip is plausible again near its last plausible position, or near a position on which `consistent`
    /// consecutive readings agree.
    pub(super) fn update(&mut self, tips: &Tips, rotation: f64, consistent: u8) -> FingerSet {
        let beyond = self.last.out_of_reach(tips, rotation);
        let beyond_candidate = self.candidates.out_of_reach(tips, rotation);
        for &finger in Finger::ALL {
            let Some(tip) = tips.get(finger) else {
                continue;
            };
            let agreeing = &mut self.agreeing[finger.index()];
            *agreeing = match (beyond.contains(finger), *agreeing) {
                (false, _) => 0,
                (true, 0) => 1,
                (true, _) if beyond_candidate.contains(finger) => 1,
                (true, count) => count + 1,
            };
            if *agreeing == 0 || *agreeing >= consistent {
                *agreeing = 0;
                self.last.set(finger, tip);
                // A candidate from an earlier position of the hand would look like a movement of the finger.
                self.candidates.remove(FingerSet::NONE.with(finger));
            } else {
                self.candidates.set(finger, tip);
            }
        }
        beyond
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Radians in a reading: a fingertip goes up to 27 mm.
    const ROTATION: f64 = 0.3;
    const CONSISTENT: u8 = 3;

    /// A hand at a position to the right, in metres, and the heights of its fingertips.
    struct Hand {
        right: f32,
        heights: [f32; Finger::COUNT],
        speed: TipSpeed,
    }

    impl Hand {
        fn read(&mut self) -> FingerSet {
            let mut tips = Tips::default();
            for &finger in Finger::ALL {
                let right = self.right + 0.02 * finger.index() as f32;
                tips.set(finger, Vec3::new(right, self.heights[finger.index()], 0.0));
            }
            self.speed.update(&tips, ROTATION, CONSISTENT)
        }

        /// Moves a fingertip by 50 mm at once, and returns in how many readings it is implausible.
        fn jump(&mut self, finger: Finger) -> usize {
            self.heights[finger.index()] += 0.05;
            let implausible = |_: &usize| self.read() != FingerSet::NONE;
            (0..20).take_while(implausible).count()
        }
    }

    #[test]
    fn a_fingertip_that_stays_where_it_jumped_is_plausible_soon_wherever_others_have_jumped() {
        let mut hand = Hand {
            right: 0.0,
            heights: [0.0; Finger::COUNT],
            speed: TipSpeed::default(),
        };
        assert_eq!(hand.read(), FingerSet::NONE);
        for finger in [Finger::Index, Finger::Middle, Finger::Ring] {
            assert_eq!(hand.jump(finger), usize::from(CONSISTENT), "{finger}");
        }
        for _ in 0..15 {
            hand.right += 0.02;
            assert_eq!(hand.read(), FingerSet::NONE);
        }
        for finger in [Finger::Ring, Finger::Thumb] {
            assert_eq!(hand.jump(finger), usize::from(CONSISTENT), "{finger}");
        }
    }
}
