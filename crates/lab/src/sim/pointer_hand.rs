//! A mouse or a finger on the screen as the tip of an index finger.

use parry3d::math::Vec3;

use super::tremor::Tremor;
use super::typing_hand::TypingHand;
use crate::capture::Sample;
use crate::hand::{Finger, Side};
use crate::kinematics::{ArmModel, HandPose};

/// Height of the fingertip above what it points at, in metres.
const HOVER_M: f32 = 0.012;

/// Depth of a press below the end of the travel, in metres.
const BOTTOM_M: f32 = 0.0005;

/// Speed across the board and towards it, in metres per second: a quick hand.
const SPEED_M_S: [f32; 2] = [1.6, 0.35];

/// The aim of a pointer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pointed {
    /// A point on the front of a board or key, in the world (metres).
    pub point: Vec3,
    /// The direction out of the front, of length 1.
    pub normal: Vec3,
    /// The travel of the key there, in metres.
    pub travel: f32,
    /// `true` if the button or finger is down.
    pub is_down: bool,
}

/// A hand whose index finger follows a pointer. Arm and finger reach for it as a person's do.
pub struct PointerHand {
    hand: TypingHand,
    side: Side,
    values: Vec<f64>,
    pointed: Option<Pointed>,
    /// The point below the pad of the fingertip, and the height of the pad above it.
    pad: Option<(Vec3, f32)>,
    /// `true` if a press has not reached its bottom: a click may be shorter than the way there.
    is_pressing: bool,
    /// `true` if the finger rises before a new press, as it would slide into a key from the side.
    is_rising: bool,
    tremor: Tremor,
}

impl PointerHand {
    /// Creates a hand at rest.
    pub fn new(arm: &ArmModel) -> Self {
        let hand = TypingHand::without_glove(arm);
        Self {
            values: hand.rest_values(),
            side: arm.side(),
            hand,
            pointed: None,
            pad: None,
            is_pressing: false,
            is_rising: false,
            tremor: Tremor::default(),
        }
    }

    /// Opens the hand at rest until it points, as a layout that the hand places at the start asks for.
    #[must_use]
    pub fn opened(self) -> Self {
        Self {
            values: self.hand.open_values(),
            ..self
        }
    }

    /// Returns the side of the hand.
    pub fn side(&self) -> Side {
        self.side
    }

    /// Returns its pose in the world.
    pub fn pose(&self) -> HandPose {
        self.hand.pose(&self.values)
    }

    /// Points at something.
    pub fn point(&mut self, pointed: Pointed) {
        let was_down = self.pointed.is_some_and(|before| before.is_down);
        self.is_rising |= pointed.is_down && !was_down;
        self.is_pressing |= pointed.is_down;
        self.pointed = Some(match self.pointed {
            // The press is for the key on which it began.
            Some(before) if self.is_pressing && !pointed.is_down => Pointed {
                is_down: false,
                ..before
            },
            _ => pointed,
        });
    }

    /// Lifts the finger, also out of a press that has not reached its bottom.
    pub fn lift(&mut self) {
        self.is_pressing = false;
        if let Some(pointed) = &mut self.pointed {
            pointed.is_down = false;
        }
    }

    /// Moves the hand and returns what a sensor of its joints measures then.
    pub fn advance(&mut self, seconds: f32) -> Sample {
        if let Some(pointed) = self.pointed {
            self.approach(&pointed, seconds);
        }
        let positions = self.pose().positions();
        let mut sample = Sample::Joints { positions };
        self.tremor.add_to(&mut sample, f64::from(seconds));
        sample
    }

    fn approach(&mut self, pointed: &Pointed, seconds: f32) {
        let pose = self.pose();
        let radius = pose.tip_radius;
        let start = || {
            let tip = pose.fingertip(Finger::Index).unwrap_or_default();
            (tip - pointed.normal * (radius + HOVER_M), HOVER_M)
        };
        let (point, height) = self.pad.unwrap_or_else(start);
        let [across, towards] = SPEED_M_S.map(|speed| speed * seconds);
        let is_down = pointed.is_down || self.is_pressing;
        let way = pointed.point - point;
        let is_there = way.length() <= across;
        let is_up = height > HOVER_M / 2.0;
        self.is_rising &= !is_up;
        let may_press = is_down && !self.is_rising;
        let point = match (is_there, is_up || may_press) {
            (true, _) => pointed.point,
            (false, true) => point + way.normalize_or_zero() * across,
            // It rises before it leaves a key.
            (false, false) => point,
        };
        // Down only where it points, so that it presses nothing on its way.
        let wanted = if may_press && (is_there || !is_up) {
            -(pointed.travel + BOTTOM_M)
        } else {
            HOVER_M
        };
        let height = height + (wanted - height).clamp(-towards, towards);
        if may_press && height <= -pointed.travel {
            self.is_pressing = false;
        }
        self.pad = Some((point, height));
        let tip = point + pointed.normal * (height + radius);
        self.hand.reach(tip, &mut self.values, &[]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::BoneLengths;

    #[test]
    fn a_hand_that_keeps_still_does_not_repeat_its_positions_for_5_s() {
        let bones = BoneLengths::from_hand_and_forearm(0.18, 0.25).expect("lengths");
        let arm = ArmModel::anthropometric(Side::Right, &bones).expect("an arm");
        let mut hand = PointerHand::new(&arm);
        let first = hand.advance(0.01);
        let changed = (1..=500).find(|_| hand.advance(0.01) != first);
        assert!(changed.is_some());
        assert_eq!(hand.advance(0.01), first);
    }
}
