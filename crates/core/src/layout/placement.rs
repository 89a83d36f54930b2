//! Poses and shapes of boards and keys, from the schema to the types of the contact stage.

use parry3d::math::{Pose, Rot3, Vec2, Vec3};

use super::board_shape::BoardShape;
use super::fit::PoseFit;
use super::quantity::{Radius, Rotation, duration, metres};
use super::schema::{
    AnchorSchema, AutoRecenterSchema, BoardShapeSchema, Curved, OutlineSchema, PoseSchema,
};
use crate::contact::board_pose::{AutoRecenter, BoardPose};
use crate::contact::surface::{Anchor, Shape};
use crate::hand::{BodyPoint, Joint};

impl BoardShapeSchema {
    /// Returns the shape in metres. The radius of an arc grows with the reach, as its center stays at the anchor.
    pub(super) fn shape(self, fit: &PoseFit) -> BoardShape {
        match self {
            Self::Flat => BoardShape::Flat,
            Self::Arc { radius_mm } => {
                let smallest = metres(*Radius::RANGE.start());
                BoardShape::Arc((metres(radius_mm.get()) - fit.shift.z).max(smallest))
            }
            Self::Cylinder { radius_mm, curved } => match curved {
                Curved::Rows => BoardShape::CurvedRows(metres(radius_mm.get())),
                Curved::Columns => BoardShape::CurvedColumns(metres(radius_mm.get())),
            },
        }
    }
}

impl OutlineSchema {
    /// Returns the shape in metres.
    pub(super) fn shape(self, scale: f32) -> Shape {
        match self {
            Self::Box(width, depth) => {
                Shape::Box(Vec2::new(metres(width.get()), metres(depth.get())) * (scale / 2.0))
            }
            Self::Disc(diameter) => Shape::Disc(metres(diameter.get()) * (scale / 2.0)),
        }
    }
}

/// The pose of a key relative to its position on the board.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct KeyPose {
    /// Distance in front of the board, in metres.
    pub lift: f32,
    /// Rotations about the tangent frame's X, then Y, then Z, in radians.
    pub rotation: Vec3,
}

impl KeyPose {
    /// Makes a pose of a distance in metres and rotations about X, Y and Z.
    pub fn new(lift: f32, (x, y, z): (Rotation, Rotation, Rotation)) -> Self {
        let radians = |rotation: Rotation| rotation.get().to_radians() as f32;
        Self {
            lift,
            rotation: Vec3::new(radians(x), radians(y), radians(z)),
        }
    }

    /// Returns `true` if the key lies in the plane of the board, where others can overlap it.
    pub fn is_in_plane(&self) -> bool {
        self.lift == 0.0 && self.rotation.truncate() == Vec2::ZERO
    }

    /// Returns the frame of the target in the tangent frame of the board. The rotation about Z is part of the outline.
    pub fn tangent_from_target(&self) -> Pose {
        let rotation =
            Rot3::from_rotation_y(self.rotation.y) * Rot3::from_rotation_x(self.rotation.x);
        Pose::from_parts(Vec3::Z * self.lift, rotation)
    }
}

impl From<AnchorSchema> for Anchor {
    fn from(schema: AnchorSchema) -> Self {
        match schema {
            AnchorSchema::World => Self::World,
            AnchorSchema::Elbow => Self::Joint(Joint::Elbow),
            AnchorSchema::Wrist => Self::Joint(Joint::Wrist),
            AnchorSchema::Start => Self::Start,
            AnchorSchema::Other => Self::OtherHand,
            AnchorSchema::Shoulder => Self::Body(BodyPoint::Shoulder),
            AnchorSchema::Head => Self::Body(BodyPoint::Head),
            AnchorSchema::Hip => Self::Body(BodyPoint::Hip),
        }
    }
}

impl PoseSchema {
    /// Returns the board's frame in the world's axes around the anchor: origin at (0, 0), rows along +X, front along +Z.
    pub(super) fn anchor_from_board(&self, shape: BoardShapeSchema, fit: &PoseFit) -> Pose {
        let radians = |degrees: f64| degrees.to_radians() as f32;
        let forward = match (self.forward_mm, shape) {
            (Some(forward), _) => metres(forward.get()),
            (None, BoardShapeSchema::Arc { radius_mm }) => metres(radius_mm.get()),
            (None, BoardShapeSchema::Flat | BoardShapeSchema::Cylinder { .. }) => 0.0,
        };
        BoardPose {
            bearing: radians(self.bearing_deg.get()),
            right: metres(self.right_mm.get()) + fit.shift.x,
            height: metres(self.height_mm.get()) + fit.shift.y,
            forward: forward - fit.shift.z,
            tilt: radians(self.tilt_deg.get()),
        }
        .to_pose()
    }

    /// Returns the frame of a volume in the world's axes around the anchor: +X to its right, +Y up, +Z towards the wearer.
    pub(super) fn anchor_from_volume(&self, fit: &PoseFit) -> Pose {
        let bearing = self.bearing_deg.get().to_radians() as f32;
        let tilt = self.tilt_deg.get().to_radians() as f32;
        let rotation = Rot3::from_rotation_y(-bearing);
        let forward = self.forward_mm.unwrap_or_default();
        let origin = Vec3::new(0.0, metres(self.height_mm.get()), -metres(forward.get()));
        let origin = origin + fit.shift;
        Pose::from_parts(rotation * origin, rotation * Rot3::from_rotation_x(tilt))
    }
}

impl From<AutoRecenterSchema> for AutoRecenter {
    fn from(schema: AutoRecenterSchema) -> Self {
        Self {
            speed: metres(schema.speed_mm_per_s.get()),
            delay: duration(schema.delay_ms.get()),
            max_offset: metres(schema.max_offset_mm.get()),
        }
    }
}
