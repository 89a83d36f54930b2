//! Points of the body beside the arms.

use parry3d::math::Vec3;

use crate::names::named_enum;

named_enum! {
    /// A point of the body from which boards are measured.
    pub enum BodyPoint ("point of the body") {
        /// The shoulder of the hand.
        Shoulder = "shoulder",
        /// The middle between the ears.
        Head = "head",
        /// The hip on the side of the hand.
        Hip = "hip",
    }
}

/// The points of the body that are measured, in the frame of the hand (metres).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BodyPoints([Option<Vec3>; BodyPoint::COUNT]);

impl BodyPoints {
    /// Sets the position of a point; `None` if it is not known.
    pub fn set(&mut self, point: BodyPoint, position: Option<Vec3>) {
        self.0[point.index()] = position;
    }

    /// Returns the position of a point (metres), or `None` if it is not known.
    pub fn get(&self, point: BodyPoint) -> Option<Vec3> {
        self.0[point.index()]
    }
}
