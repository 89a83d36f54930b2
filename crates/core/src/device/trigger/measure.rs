//! The measurement of a trigger.

use super::{CircleDirection, CirclePoint, HandMemory, HandShape, Steps, SwipeDirection};
use crate::device::DeviceInput;
use crate::hand::{BodyAngle, Dof, Finger, Input};

/// The measurement of a trigger.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measure {
    /// A joint angle, in radians.
    Angle(Dof),
    /// The distance between the fingertip centers of the thumb and a finger, in metres.
    Pinch(Finger),
    /// The confidence that the hand has a shape, 0..=1; for an open hand 0 if the hand was not closed before.
    HandShape(HandShape),
    /// The distance that the palm has moved in a direction of the world within 200 ms, in metres; 0 if it has moved more than half as far
    /// across.
    Swipe(SwipeDirection),
    /// The number of times that the palm has turned back within a second, after 100 mm or more along an axis of the world.
    Shake,
    /// The number of turns that a point of the hand has drawn without a stop; `None` for either direction.
    Circle(CirclePoint, Option<CircleDirection>),
    /// The fraction of steps that were done in their order.
    Sequence(Steps),
    /// A stick, trigger or button of the glove, −1..=1.
    Input(Input),
    /// An angle of the head, a foot or a knee, in radians.
    Body(BodyAngle),
}

impl Measure {
    /// Returns `true` if it depends on the path of the palm.
    pub(super) fn is_motion(self) -> bool {
        matches!(self, Self::Swipe(_) | Self::Shake)
    }

    /// Returns the current measurement, or `None` if it is unknown.
    pub(super) fn measurement(self, input: &DeviceInput, hand: &HandMemory) -> Option<f32> {
        let is_trusted = |finger: Finger| !input.pose.untrusted.contains(finger);
        // A button and the head do not depend on the pose of the hand.
        if input.pose.jumped && !matches!(self, Self::Input(_) | Self::Body(_)) {
            return None;
        }
        let measurement = match self {
            Self::Angle(dof) => {
                let is_known = input.angles.is_known(dof) && dof.finger().is_none_or(is_trusted);
                is_known.then(|| input.angles.get(dof) as f32)
            }
            Self::Pinch(finger) => {
                let tips = [Finger::Thumb, finger];
                let [thumb, tip] = tips.map(|each| {
                    let tip = input.pose.fingertip(each);
                    tip.filter(|_| is_trusted(each))
                });
                Some(thumb?.distance(tip?))
            }
            Self::HandShape(shape) => {
                let confidence = shape.confidence(hand.bends.get())?;
                let counts = shape != HandShape::OpenHand || hand.opening.is_open();
                Some(if counts { confidence } else { 0.0 })
            }
            Self::Swipe(direction) => hand.motion.swipe(direction),
            Self::Shake => hand.motion.reversals(),
            Self::Circle(point, direction) => hand.circles[point.index()].turns(direction),
            // Follows the other triggers.
            Self::Sequence(_) => None,
            Self::Input(own) => input.inputs.get(own),
            Self::Body(angle) => input.inputs.angle(angle),
        };
        measurement.filter(|measurement| measurement.is_finite())
    }
}
