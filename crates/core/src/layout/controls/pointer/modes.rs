//! Pointing modes: joint angles, a point of the hand, ray, rate control.

use parry3d::math::{Vec2, Vec3};
use serde::Deserialize;

use super::arm::ArmAxisSchema;
use crate::device::pointer::mode::{
    AngleMapping, DirectPointing, Displacement, HandPoint, JointPointing, RateControl, RayOrigin,
    RayPointing,
};
use crate::device::pointer::{AnchoredFrame, PointingMode};
use crate::document::schema;
use crate::hand::Dof;
use crate::layout::fit::PoseFit;
use crate::layout::quantity::{
    CursorSpeed, Extent, JointAngle, PointerExponent, RateDeadZone, metres,
};
use crate::layout::schema::PoseSchema;

schema! {
    /// The relation between the hand and the position of the cursor.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "PointingMode", deny_unknown_fields)]
    pub(super) enum PointingModeSchema<'a> {
        /// Three joint angles are three displacements.
        Joint {
            /// To the right.
            x: AngleMappingSchema,
            /// Up.
            y: AngleMappingSchema,
            /// Towards you.
            #[serde(default)]
            z: Option<AngleMappingSchema>,
        },
        /// Position of a point of the hand in a box.
        Direct {
            /// The point that moves in the box.
            #[serde(default)]
            point: HandPointSchema,
            /// Pose of the center of the box.
            pose: PoseSchema,
            /// Width, height and depth.
            size_mm: (Extent, Extent, Extent),
        },
        /// Intersection of a ray from the hand with a rectangle.
        Ray {
            /// Origin of the ray.
            #[serde(default)]
            origin: RayOriginSchema,
            /// Pose of the center of the rectangle.
            pose: PoseSchema,
            /// Width and height.
            size_mm: (Extent, Extent),
        },
        /// Displacement is speed.
        Rate {
            /// The displacement.
            input: DisplacementSchema,
            /// Fraction of the full displacement within which the cursor rests.
            #[serde(default)]
            dead_zone: RateDeadZone,
            /// Speed at full displacement.
            max_px_per_s: CursorSpeed,
            /// Exponent of the response curve.
            #[serde(default)]
            exponent: PointerExponent,
        },
        /// The motion of the hand drives axes instead of the cursor.
        Arm {
            /// The point of the hand whose displacement counts.
            #[serde(default)]
            point: HandPointSchema,
            /// The axes, each with the motion that deflects it.
            #[serde(borrow)]
            axes: Vec<ArmAxisSchema<'a>>,
            /// Fraction of the full deflection within which an axis is 0.
            #[serde(default)]
            dead_zone: RateDeadZone,
            /// Exponent of the response curve outside the dead zone; above 1 it is finer near the center.
            #[serde(default)]
            exponent: PointerExponent,
        },
    }
}

schema! {
    /// A joint angle as a displacement. Swap its ends to reverse the direction.
    #[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
    #[serde(rename = "AngleMapping", deny_unknown_fields)]
    pub(super) struct AngleMappingSchema {
        /// Degree of freedom, such as `"wrist-flexion"`.
        dof: Dof,
        /// Angle at the left, lower or far end.
        from_deg: JointAngle,
        /// Angle at the opposite end.
        to_deg: JointAngle,
        /// Distance between the ends in a space of targets, centered at 0.
        #[serde(default)]
        extent_mm: Extent,
        /// Exponent of the response curve; above 1 the middle is finer and the ends are coarser.
        #[serde(default)]
        exponent: PointerExponent,
    }
}

schema! {
    /// A point of the hand that a pointer follows.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
    #[serde(rename = "HandPoint")]
    pub(super) enum HandPointSchema {
        /// The index fingertip, also for a glove, which measures no height of the wrist.
        #[default]
        Index,
        /// The index knuckle, which stays where it is while fingers pinch.
        Knuckle,
        /// The wrist, for an arm that is tracked as a whole.
        Wrist,
    }
}

schema! {
    /// Origin and direction of a ray.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
    #[serde(rename = "RayOrigin")]
    pub(super) enum RayOriginSchema {
        /// The index knuckle, away from the wrist.
        #[default]
        Hand,
        /// The index finger, away from the knuckle.
        Index,
    }
}

schema! {
    /// The displacement that controls a rate.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "Displacement", deny_unknown_fields)]
    pub(super) enum DisplacementSchema {
        /// The index fingertip from its rest position.
        Fingertip {
            /// Rest pose.
            pose: PoseSchema,
            /// Full displacement.
            full_mm: Extent,
        },
        /// Two angles from the middle of their ranges.
        Angles {
            /// To the right.
            x: AngleMappingSchema,
            /// Up.
            y: AngleMappingSchema,
        },
        /// The stick of the glove from its center. The cursor moves after the stick was seen at rest.
        Stick,
    }
}

impl PointingModeSchema<'_> {
    /// Returns the checked mode. `fit` returns the fit of a box or rectangle to the hand.
    pub fn check(&self, fit: impl Fn(&PoseSchema) -> PoseFit) -> Result<PointingMode, String> {
        Ok(match self {
            Self::Joint { x, y, z } => PointingMode::Joint(JointPointing {
                x: x.check()?,
                y: y.check()?,
                z: z.as_ref().map(AngleMappingSchema::check).transpose()?,
            }),
            Self::Direct {
                point,
                pose,
                size_mm,
            } => PointingMode::Direct(DirectPointing {
                point: point.check(),
                frame: AnchoredFrame {
                    start: point.check(),
                    ..frame(pose, &fit(pose))
                },
                size: size(*size_mm) * fit(pose).scale,
            }),
            Self::Ray {
                origin,
                pose,
                size_mm: (width, height),
            } => PointingMode::Ray(RayPointing {
                from: match origin {
                    RayOriginSchema::Hand => RayOrigin::Hand,
                    RayOriginSchema::Index => RayOrigin::Index,
                },
                frame: frame(pose, &fit(pose)),
                size: Vec2::new(metres(width.get()), metres(height.get())) * fit(pose).scale,
            }),
            Self::Rate {
                input,
                dead_zone,
                max_px_per_s,
                exponent,
            } => PointingMode::Rate(RateControl {
                displacement: input.check(fit)?,
                dead_zone: dead_zone.get() as f32,
                max_speed_px_s: max_px_per_s.get() as f32,
                curve: exponent.get() as f32,
            }),
            Self::Arm { point, .. } => PointingMode::Arm(point.check()),
        })
    }
}

impl HandPointSchema {
    fn check(self) -> HandPoint {
        match self {
            Self::Index => HandPoint::Index,
            Self::Knuckle => HandPoint::Knuckle,
            Self::Wrist => HandPoint::Wrist,
        }
    }
}

impl DisplacementSchema {
    fn check(&self, fit: impl Fn(&PoseSchema) -> PoseFit) -> Result<Displacement, String> {
        Ok(match self {
            Self::Fingertip { pose, full_mm } => {
                let fit = fit(pose);
                Displacement::Fingertip(frame(pose, &fit), metres(full_mm.get()) * fit.scale)
            }
            Self::Angles { x, y } => Displacement::Angles(x.check()?, y.check()?),
            Self::Stick => Displacement::Stick,
        })
    }
}

impl AngleMappingSchema {
    fn check(&self) -> Result<AngleMapping, String> {
        let (from, to) = (self.from_deg.get(), self.to_deg.get());
        if (to - from).abs() < 1.0 {
            return Err(format!(
                "the range of `{}` must be at least 1°: from_deg is {from}, to_deg is {to}",
                self.dof
            ));
        }
        Ok(AngleMapping {
            dof: self.dof,
            from: from.to_radians() as f32,
            to: to.to_radians() as f32,
            extent: metres(self.extent_mm.get()),
            curve: self.exponent.get() as f32,
        })
    }
}

fn frame(pose: &PoseSchema, fit: &PoseFit) -> AnchoredFrame {
    AnchoredFrame {
        anchor: pose.anchor.into(),
        start: HandPoint::Index,
        anchor_from_frame: pose.anchor_from_volume(fit),
    }
}

fn size((width, height, depth): (Extent, Extent, Extent)) -> Vec3 {
    Vec3::new(
        metres(width.get()),
        metres(height.get()),
        metres(depth.get()),
    )
}
