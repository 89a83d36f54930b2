//! The pose that forward kinematics moves from link to link.

use glam::{Quat, Vec4, Vec4Swizzles};
use parry3d::math::{Pose, Vec3};

/// The pose of a link: of one hand, or of a hand or finger in each lane of vectors.
///
/// The offset and the axis of a link have a number `N` for all lanes or for each.
pub trait LinkPose<N>: Copy {
    /// A number of the pose: an `f32`, or a vector with one for each lane.
    type Number;

    /// Moves the pose by an offset in its own frame.
    fn translate(&mut self, offset: &Offset<N>);

    /// Moves the pose along X of its own frame, in metres.
    fn advance(&mut self, along: N);

    /// Turns the pose about an axis of its own frame, by the sine and cosine of half an angle.
    fn turn(&mut self, axis: &Axis<N>, sine: Self::Number, cosine: Self::Number);
}

/// The position of a pivot in the frame of the parent, in metres.
#[derive(Clone, Copy, Debug)]
pub enum Offset<N> {
    /// The pivot of the parent.
    None,
    /// A point on the X axis.
    AlongX(N),
    /// Any point.
    Any([N; 3]),
}

/// The axis about which a link turns: an axis of its frame with the sense of the rotation, ±1, or any unit vector.
#[derive(Clone, Copy, Debug)]
pub enum Axis<N> {
    /// The link does not turn.
    None,
    /// The X axis.
    X(N),
    /// The Y axis.
    Y(N),
    /// The Z axis.
    Z(N),
    /// A unit vector; 0 in a lane that does not turn.
    Any([N; 3]),
}

impl<N> Offset<N> {
    /// Creates the offset of each lane; `join` makes one number of the numbers of the lanes.
    pub fn new<const COUNT: usize>(
        offsets: [Vec3; COUNT],
        join: impl Fn([f32; COUNT]) -> N,
    ) -> Self {
        let component = |index: usize| join(offsets.map(|offset| offset[index]));
        if are_along(Vec3::ZERO, &offsets) {
            Self::None
        } else if are_along(Vec3::X, &offsets) {
            Self::AlongX(component(0))
        } else {
            Self::Any([0, 1, 2].map(component))
        }
    }
}

impl<N> Axis<N> {
    /// Creates the axis of each lane, as [`Offset::new`] does. A lane whose axis is 0 does not turn.
    pub fn new<const COUNT: usize>(axes: [Vec3; COUNT], join: impl Fn([f32; COUNT]) -> N) -> Self {
        let component = |index: usize| join(axes.map(|axis| axis[index]));
        if are_along(Vec3::ZERO, &axes) {
            Self::None
        } else if are_along(Vec3::X, &axes) {
            Self::X(component(0))
        } else if are_along(Vec3::Y, &axes) {
            Self::Y(component(1))
        } else if are_along(Vec3::Z, &axes) {
            Self::Z(component(2))
        } else {
            Self::Any([0, 1, 2].map(component))
        }
    }

    /// Returns `true` if the link turns in any lane.
    #[inline]
    pub fn is_some(&self) -> bool {
        !matches!(self, Self::None)
    }
}

/// Returns `true` if all vectors lie along an axis of the frame; along 0 if they are 0.
fn are_along(axis: Vec3, vectors: &[Vec3]) -> bool {
    vectors.iter().all(|vector| *vector * axis == *vector)
}

impl LinkPose<f32> for Pose {
    type Number = f32;

    #[inline]
    fn translate(&mut self, offset: &Offset<f32>) {
        match *offset {
            Offset::None => {}
            Offset::AlongX(along) => self.advance(along),
            Offset::Any(offset) => self.translation += self.rotation * Vec3::from_array(offset),
        }
    }

    #[inline]
    fn advance(&mut self, along: f32) {
        self.translation += self.rotation * Vec3::new(along, 0.0, 0.0);
    }

    /// About an axis of the frame, computes the product of two quaternions without the terms that are 0, in the same order.
    #[inline]
    fn turn(&mut self, axis: &Axis<f32>, sine: f32, cosine: f32) {
        let q = Vec4::from(self.rotation);
        let (swapped, signs, sense) = match *axis {
            Axis::None => return,
            Axis::X(sense) => (q.wzyx(), Vec4::new(1.0, 1.0, -1.0, -1.0), sense),
            Axis::Y(sense) => (q.zwxy(), Vec4::new(-1.0, 1.0, 1.0, -1.0), sense),
            Axis::Z(sense) => (q.yxwz(), Vec4::new(1.0, -1.0, 1.0, -1.0), sense),
            Axis::Any(axis) => {
                let about = Vec3::from_array(axis) * sine;
                self.rotation *= Quat::from_vec4(about.extend(cosine));
                return;
            }
        };
        self.rotation = Quat::from_vec4(q * cosine + swapped * (signs * (sine * sense)));
    }
}
