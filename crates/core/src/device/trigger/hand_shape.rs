//! Shapes of a hand and their confidence, from the bends of the fingers alone.

use crate::estimate::FingerBends;
use crate::hand::Finger;
use crate::names::named_enum;

named_enum! {
    /// A shape of a hand, in whatever direction the hand points.
    ///
    /// As a trigger, an open hand counts only if the hand was closed less than 1 s before: a flat hand at rest is open, too.
    pub enum HandShape ("hand shape") {
        /// All fingers are bent, the thumb over or beside them.
        Fist = "fist",
        /// All fingers are straight.
        OpenHand = "open-hand",
        /// The index finger is straight and the next three are bent. The thumb is free.
        Point = "point",
        /// The thumb is straight and the fingers are bent.
        ThumbsUp = "thumbs-up",
    }
}

/// The bends between which the confidence that a finger has its part of a shape rises from 0 to 1; falls, if the first is larger.
type Ramp = (f32, f32);

/// A bent finger. Cameras see a bend of 0.7 or more in a fist, and of 0.5 in a relaxed hand.
const BENT: Ramp = (0.4, 0.65);
/// A straight finger beside bent ones. Cameras show the last joint of an index finger that points bent by 35°.
const EXTENDED: Ramp = (0.45, 0.2);
/// A straight finger of an open hand.
const OPEN: Ramp = (0.45, 0.25);
/// The thumb of an open hand, whose base is bent towards the palm at rest, too.
const OPEN_THUMB: Ramp = (0.6, 0.35);
/// The thumb of a fist, and a raised one, half-way between those that cameras see: 0.6 and 0.1. The two exclude each other: no hand
/// is a fist and thumbs-up.
const FOLDED_THUMB: Ramp = (0.28, 0.48);
const RAISED_THUMB: Ramp = (0.48, 0.28);

impl HandShape {
    /// Returns the confidence that a hand has the shape, 0..=1. The finger that fits least decides. `None` if the bend of a
    /// finger that counts is not measured or not finite.
    pub fn confidence(self, bends: &FingerBends) -> Option<f32> {
        confidence(bends, |finger| self.ramp(finger))
    }

    /// Returns the confidence that all fingers but the thumb are bent, 0..=1; `None` if one of them is unknown.
    pub(super) fn closed_confidence(bends: &FingerBends) -> Option<f32> {
        confidence(bends, |finger| (finger != Finger::Thumb).then_some(BENT))
    }

    /// Returns the bend at which a finger has its part of the shape for certain; `None` for a finger that is free.
    pub fn bend(self, finger: Finger) -> Option<f32> {
        let (from, to) = self.ramp(finger)?;
        Some(if from < to { 0.85 } else { 0.0 })
    }

    fn ramp(self, finger: Finger) -> Option<Ramp> {
        match (self, finger) {
            (Self::Fist, Finger::Thumb) => Some(FOLDED_THUMB),
            (Self::OpenHand, Finger::Thumb) => Some(OPEN_THUMB),
            (Self::OpenHand, _) => Some(OPEN),
            (Self::Point, Finger::Thumb) => None,
            (Self::Point, Finger::Index) => Some(EXTENDED),
            (Self::ThumbsUp, Finger::Thumb) => Some(RAISED_THUMB),
            (Self::Fist | Self::Point | Self::ThumbsUp, _) => Some(BENT),
        }
    }
}

/// Returns the least confidence of the fingers with a ramp; `None` if one of them is unknown.
fn confidence(bends: &FingerBends, ramp: impl Fn(Finger) -> Option<Ramp>) -> Option<f32> {
    let mut confidence = 1.0_f32;
    for &finger in Finger::ALL {
        let Some((from, to)) = ramp(finger) else {
            continue;
        };
        let bend = bends.get(finger).filter(|bend| bend.is_finite())?;
        confidence = confidence.min(((bend - from) / (to - from)).clamp(0.0, 1.0));
    }
    Some(confidence)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the confidences of all shapes for bends of the fingers from the thumb on; negative for unknown.
    fn confidences(bends: [f32; Finger::COUNT]) -> [Option<f32>; HandShape::COUNT] {
        let mut known = FingerBends::default();
        for (&finger, bend) in Finger::ALL.iter().zip(bends) {
            known.set(finger, (bend >= 0.0 || bend.is_nan()).then_some(bend));
        }
        let shapes = [0, 1, 2, 3].map(|index| HandShape::ALL[index]);
        shapes.map(|shape| shape.confidence(&known))
    }

    #[test]
    fn each_shape_has_its_own_bends() {
        let [yes, no] = [Some(1.0), Some(0.0)];
        for (bends, expected) in [
            ([0.6, 0.8, 0.8, 0.8, 0.7], [yes, no, no, no]),
            ([0.3, 0.1, 0.1, 0.1, 0.0], [Some(0.0), yes, no, no]),
            ([0.6, 0.1, 0.8, 0.8, 0.7], [no, no, yes, no]),
            ([0.1, 0.8, 0.8, 0.8, 0.7], [no, no, no, yes]),
            ([0.3, 0.4, 0.4, 0.4, 0.45], [Some(0.0), Some(0.0), no, no]),
        ] {
            assert_eq!(confidences(bends), expected, "{bends:?}");
        }
    }

    #[test]
    fn a_finger_that_is_unknown_makes_its_shapes_unknown() {
        let without_thumb = confidences([-1.0, 0.1, 0.8, 0.8, 0.8]);
        assert_eq!(without_thumb, [None, None, Some(1.0), None]);
        assert_eq!(confidences([0.6, 0.8, 0.8, -1.0, 0.8]), [None; 4]);
        assert_eq!(confidences([0.6, 0.8, 0.8, f32::NAN, 0.8]), [None; 4]);
    }

    #[test]
    fn no_thumb_makes_both_a_fist_and_thumbs_up_at_the_default_threshold() {
        for percent in 0_u8..=100 {
            let thumb = f32::from(percent) / 100.0;
            let [fist, _, _, thumbs_up] = confidences([thumb, 0.8, 0.8, 0.8, 0.8]);
            assert!(fist.unwrap().min(thumbs_up.unwrap()) < 0.8, "{thumb}");
        }
    }
}
