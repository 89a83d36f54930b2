//! Targets in space.

use parry3d::math::Vec3;
use serde::Deserialize;

use crate::contact::TargetId;
use crate::contact::volume::{Volume, VolumeSet, VolumeShape};
use crate::device::pointer::mode::HandPoint;
use crate::device::pointer::{AnchoredFrame, SelectionSpace};
use crate::document::{DocumentError, Spanned, schema};
use crate::layout::builder::LayoutBuilder;
use crate::layout::fit::PoseFit;
use crate::layout::model::SpaceTargets;
use crate::layout::quantity::{Extent, Offset, metres};
use crate::layout::render::drawing::Words;
use crate::layout::schema::{Action, PoseSchema};

schema! {
    /// Targets in space that move as one.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "Space", deny_unknown_fields)]
    pub(in crate::layout) struct SpaceSchema<'a> {
        /// As of the box of a pointer: x to the right, y up, z towards you.
        pose: PoseSchema,
        /// At least one target.
        #[serde(borrow)]
        targets: Vec<TargetSchema<'a>>,
    }
}

schema! {
    /// A target in space.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "Target", deny_unknown_fields)]
    struct TargetSchema<'a> {
        /// Name in events and scripts.
        #[serde(borrow)]
        name: Spanned<'a>,
        /// Center: to the right, up, towards you.
        at_mm: (Offset, Offset, Offset),
        /// Shape and size.
        shape: VolumeShapeSchema,
        /// Action while it is selected.
        #[serde(borrow, default)]
        action: Option<Action<'a>>,
    }
}

schema! {
    /// The shape and size of a target in space.
    #[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
    #[serde(rename = "VolumeShape")]
    enum VolumeShapeSchema {
        /// Diameter.
        Ball(Extent),
        /// Width, height and depth.
        Box(Extent, Extent, Extent),
    }
}

impl<'a> SpaceSchema<'a> {
    /// Adds the targets. `number` counts the spaces of the layout from 1.
    pub fn build(
        &self,
        builder: &mut LayoutBuilder<'a>,
        number: usize,
    ) -> Result<(), DocumentError> {
        let fit = builder.pose_fit(&self.pose, None);
        // Each target keeps its direction from the anchor, so the frame stays.
        let frame = AnchoredFrame {
            anchor: self.pose.anchor.into(),
            start: HandPoint::Index,
            anchor_from_frame: self.pose.anchor_from_volume(&PoseFit::NONE),
        };
        let mut first_target: Option<TargetId> = None;
        let (mut names, mut volumes, mut actions) = (Vec::new(), Vec::new(), Vec::new());
        for target in &self.targets {
            let name = target.name.text;
            let id = builder.add_target("target", name, name)?;
            first_target.get_or_insert(id);
            let action = target
                .action
                .map(|action| builder.action(action, None))
                .transpose()?;
            names.push(name.to_owned());
            actions.push(action);
            volumes.push(target.volume(&frame, &fit));
        }
        let Some(first_target) = first_target else {
            let message = format!("space {number} has no targets");
            return Err(builder.error(builder.name.text, message));
        };
        let space = SelectionSpace {
            frame,
            first_target,
            volumes: VolumeSet::new(volumes),
            actions,
        };
        builder.spaces.push(SpaceTargets { names, space });
        Ok(())
    }
}

impl TargetSchema<'_> {
    fn volume(&self, frame: &AnchoredFrame, fit: &PoseFit) -> Volume {
        let (x, y, z) = self.at_mm;
        let half = |extent: Extent| metres(extent.get()) / 2.0 * fit.scale;
        let center = Vec3::new(metres(x.get()), metres(y.get()), metres(z.get()));
        let anchor_from_frame = frame.anchor_from_frame;
        let shift = fit.shift_at(anchor_from_frame * center);
        Volume {
            center: center + anchor_from_frame.rotation.inverse() * shift,
            shape: match self.shape {
                VolumeShapeSchema::Ball(diameter) => VolumeShape::Ball(half(diameter)),
                VolumeShapeSchema::Box(width, height, depth) => {
                    VolumeShape::Box(Vec3::new(half(width), half(height), half(depth)))
                }
            },
        }
    }
}

/// Describes targets in space: the name of each, its shape, its center and its action.
pub(in crate::layout) fn describe(targets: &SpaceTargets, words: &Words) -> Vec<(String, String)> {
    let volumes = targets.space.volumes.iter().zip(&targets.space.actions);
    let rows = targets
        .names
        .iter()
        .zip(volumes)
        .map(|(name, (volume, action))| {
            let center = volume.center * 1e3;
            let shape = match volume.shape {
                VolumeShape::Ball(radius) => format!("ball {:.0} mm", radius * 2e3),
                VolumeShape::Box(half) => {
                    let size = half * 2e3;
                    format!("box {:.0} × {:.0} × {:.0} mm", size.x, size.y, size.z)
                }
            };
            let (x, y, z) = (center.x, center.y, center.z);
            let action = action.map_or(String::new(), |it| format!(", holds {}", words.action(it)));
            (
                name.clone(),
                format!("{shape} at ({x:.0}, {y:.0}, {z:.0}) mm{action}"),
            )
        });
    rows.collect()
}
