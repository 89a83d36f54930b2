//! The arm as a joystick: axes that follow the motion of the hand.

use serde::Deserialize;

use crate::device::pointer::{ArmAxes, ArmAxis, ArmDirection};
use crate::document::{DocumentError, Spanned, schema};
use crate::layout::builder::LayoutBuilder;
use crate::layout::controls::value_output::axis;
use crate::layout::quantity::{
    FullDisplacement, FullRotation, PointerExponent, RateDeadZone, metres,
};

/// The smallest motion for a full deflection, in mm or degrees: a smaller one is within the tremor of a hand.
const MIN_FULL: f64 = 5.0;

schema! {
    /// An axis and the motion that deflects it.
    #[derive(Clone, Copy, Debug, Deserialize)]
    #[serde(rename = "ArmAxis", deny_unknown_fields)]
    pub(super) struct ArmAxisSchema<'a> {
        /// The axis.
        #[serde(borrow)]
        axis: Spanned<'a>,
        /// Motion for full deflection; at least 5, or at most -5 for the opposite direction.
        motion: ArmMotionSchema,
    }
}

schema! {
    /// A motion of the hand and its size for a full deflection. A negative size reverses the axis.
    #[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
    #[serde(rename = "ArmMotion")]
    enum ArmMotionSchema {
        /// To the right.
        Right(FullDisplacement),
        /// Away from you.
        Forward(FullDisplacement),
        /// Upwards.
        Up(FullDisplacement),
        /// The fingers rise.
        Pitch(FullRotation),
        /// Clockwise about the direction of the hand.
        Roll(FullRotation),
        /// To the left.
        Yaw(FullRotation),
    }
}

/// Returns the checked axes.
pub(super) fn arm_axes<'a>(
    builder: &mut LayoutBuilder<'a>,
    axes: &[ArmAxisSchema<'a>],
    dead_zone: RateDeadZone,
    exponent: PointerExponent,
) -> Result<ArmAxes, DocumentError> {
    let mut checked = Vec::new();
    for schema in axes {
        let name = schema.axis;
        let axis = axis(builder, name)?;
        builder.claim_axis(axis, name);
        let (direction, full) = schema.motion.check();
        let full = full.map_err(|message| builder.error(name.text, message))?;
        checked.push(ArmAxis {
            axis,
            direction,
            full,
        });
    }
    Ok(ArmAxes {
        axes: checked,
        dead_zone: dead_zone.get() as f32,
        curve: exponent.get() as f32,
    })
}

impl ArmMotionSchema {
    /// Returns the direction, and the size in metres or radians.
    fn check(self) -> (ArmDirection, Result<f32, String>) {
        let displacement = |size: FullDisplacement| usable(size.get()).map(metres);
        let rotation = |size: FullRotation| Ok(usable(size.get())?.to_radians() as f32);
        match self {
            Self::Right(size) => (ArmDirection::Right, displacement(size)),
            Self::Forward(size) => (ArmDirection::Forward, displacement(size)),
            Self::Up(size) => (ArmDirection::Up, displacement(size)),
            Self::Pitch(size) => (ArmDirection::Pitch, rotation(size)),
            Self::Roll(size) => (ArmDirection::Roll, rotation(size)),
            Self::Yaw(size) => (ArmDirection::Yaw, rotation(size)),
        }
    }
}

fn usable(size: f64) -> Result<f64, String> {
    if size.abs() >= MIN_FULL {
        Ok(size)
    } else {
        Err(format!(
            "the motion for a full deflection must be at least {MIN_FULL} or at most -{MIN_FULL} (mm or degrees), it is {size}"
        ))
    }
}
