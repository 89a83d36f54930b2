//! The modes of a pointer, as written → checked.

use parry3d::math::{Pose, Rot3, Vec2, Vec3};
use serde::Deserialize;

use crate::device::pointer::mode::{
    AngleMapping, DirectPointing, Displacement, JointPointing, RateControl, RayOrigin, RayPointing,
};
use crate::device::pointer::{self, mode};
use crate::document::DocumentError;
use crate::hand::Dof;
use crate::layout::builder::Checked;
use crate::layout::model::metres;
use crate::layout::placement;
use crate::layout::ranged::{Angle, CursorSpeed, DeadShare, Exponent, Extent};
use crate::layout::schema::Place;

/// How a hand says where to point.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Mode {
    /// By three angles.
    Joint {
        /// To the right.
        x: Angles,
        /// Up.
        y: Angles,
        /// Towards the wearer.
        #[serde(default)]
        z: Option<Angles>,
    },
    /// By the index fingertip in a box.
    Direct {
        /// The middle of the box.
        place: Place,
        /// Width, height and depth.
        size_mm: (Extent, Extent, Extent),
    },
    /// By a ray from the hand through a rectangle.
    Ray {
        /// What it comes from.
        #[serde(default)]
        from: Origin,
        /// The middle of the rectangle.
        place: Place,
        /// Width and height.
        size_mm: (Extent, Extent),
    },
    /// By how far the hand is from its rest.
    Rate {
        /// What is displaced.
        of: Of,
        /// The share of the way that is rest.
        #[serde(default)]
        dead_share: DeadShare,
        /// How fast the pointer goes in the end.
        top_px_s: CursorSpeed,
        /// How much slower it goes in the middle.
        #[serde(default)]
        curve: Exponent,
    },
}

/// An angle that is a displacement.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Angles {
    /// The angle.
    pub dof: Dof,
    /// Where it begins.
    pub from_deg: Angle,
    /// Where it ends.
    pub to_deg: Angle,
    /// How far that is in a space.
    #[serde(default)]
    pub range_mm: Extent,
    /// How much finer the middle is.
    #[serde(default)]
    pub curve: Exponent,
}

/// What a ray comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
pub enum Origin {
    /// The knuckle, away from the wrist.
    #[default]
    Hand,
    /// The fingertip, away from the knuckle.
    Index,
}

/// What is displaced.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Of {
    /// The index fingertip.
    Tip {
        /// Its rest.
        place: Place,
        /// How far it goes.
        full_mm: Extent,
    },
    /// Two angles.
    Angles {
        /// To the right.
        x: Angles,
        /// Up.
        y: Angles,
    },
}

/// A frame around an anchor, for what does not lie like a board.
pub struct Frame;

impl Frame {
    /// +X to its right, +Y up, +Z towards the wearer.
    pub fn of(place: &Place) -> pointer::AnchoredFrame {
        let bearing = place.bearing_deg.get().to_radians() as f32;
        let tilt = place.tilt_deg.get().to_radians() as f32;
        let turn = Rot3::from_rotation_y(-bearing);
        let forward = place.forward_mm.unwrap_or_default();
        let origin = Vec3::new(0.0, metres(place.height_mm.get()), -metres(forward.get()));
        pointer::AnchoredFrame {
            anchor: placement::anchor(place.anchor),
            anchor_from_frame: Pose::from_parts(turn * origin, turn * Rot3::from_rotation_x(tilt)),
        }
    }
}

impl Checked<'_> {
    pub(super) fn mode(&self, written: &Mode) -> Result<mode::PointingMode, DocumentError> {
        Ok(match written {
            Mode::Joint { x, y, z } => mode::PointingMode::Joint(JointPointing {
                x: self.axis_of(x)?,
                y: self.axis_of(y)?,
                z: z.as_ref().map(|z| self.axis_of(z)).transpose()?,
            }),
            Mode::Direct { place, size_mm } => mode::PointingMode::Direct(DirectPointing {
                frame: Frame::of(place),
                size: extents(*size_mm),
            }),
            Mode::Ray {
                from,
                place,
                size_mm: (width, height),
            } => mode::PointingMode::Ray(RayPointing {
                from: match from {
                    Origin::Hand => RayOrigin::Hand,
                    Origin::Index => RayOrigin::Index,
                },
                frame: Frame::of(place),
                size: Vec2::new(metres(width.get()), metres(height.get())),
            }),
            Mode::Rate {
                of,
                dead_share,
                top_px_s,
                curve,
            } => mode::PointingMode::Rate(RateControl {
                displacement: match of {
                    Of::Tip { place, full_mm } => {
                        Displacement::Fingertip(Frame::of(place), metres(full_mm.get()))
                    }
                    Of::Angles { x, y } => Displacement::Angles(self.axis_of(x)?, self.axis_of(y)?),
                },
                dead_zone: dead_share.get() as f32,
                max_speed_px_s: top_px_s.get() as f32,
                curve: curve.get() as f32,
            }),
        })
    }

    fn axis_of(&self, written: &Angles) -> Result<AngleMapping, DocumentError> {
        let (from, to) = (written.from_deg.get(), written.to_deg.get());
        if (to - from).abs() < 1.0 {
            let message = format!(
                "the range of `{}` is 1° or more: from_deg is {from}, to_deg {to}",
                written.dof
            );
            return self.wrong(message);
        }
        Ok(AngleMapping {
            dof: written.dof,
            from: from.to_radians() as f32,
            to: to.to_radians() as f32,
            extent: metres(written.range_mm.get()),
            curve: written.curve.get() as f32,
        })
    }
}

/// Width, height and depth of a file in metres.
pub(in crate::layout) fn extents((x, y, z): (Extent, Extent, Extent)) -> Vec3 {
    Vec3::new(metres(x.get()), metres(y.get()), metres(z.get()))
}
