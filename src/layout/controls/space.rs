//! Targets in space as written → checked.

use parry3d::math::Vec3;
use serde::Deserialize;

use super::pointer::Frame;
use crate::contact::TargetId;
use crate::contact::volume::{Volume, VolumeSet, VolumeShape};
use crate::device::pointer;
use crate::document::DocumentError;
use crate::layout::builder::Checked;
use crate::layout::model::metres;
use crate::layout::ranged::{Distance, Extent};
use crate::layout::schema::{Does, Place};
use crate::layout::text::Spanned;

/// Targets that move as one, as they stand in the file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Space<'a> {
    /// Where (0, 0, 0) is.
    pub place: Place,
    /// What there is.
    #[serde(borrow)]
    pub targets: Vec<Target<'a>>,
}

/// A target in space.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Target<'a> {
    /// What it is called.
    #[serde(borrow)]
    pub name: Spanned<'a>,
    /// Its middle: to the right, up, towards the wearer.
    pub at_mm: (Distance, Distance, Distance),
    /// What it looks like.
    pub form: Solid,
    /// What is pressed while it is selected.
    #[serde(borrow, default)]
    pub does: Option<Does<'a>>,
}

/// What a target in space looks like.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub enum Solid {
    /// A ball of this diameter.
    Ball(Extent),
    /// A box of this width, height and depth.
    Box(Extent, Extent, Extent),
}

/// Targets in space, checked.
#[derive(Clone, Debug)]
pub struct SpaceTargets {
    /// What they are called, in order.
    pub names: Vec<String>,
    /// Where they are and what they do.
    pub space: pointer::SelectionSpace,
}

impl<'a> Checked<'a> {
    /// Checks targets in space, of which `first` is the first.
    pub(in crate::layout) fn space(
        &mut self,
        written: &Space<'a>,
        first: TargetId,
    ) -> Result<SpaceTargets, DocumentError> {
        let (mut names, mut volumes, mut actions) = (Vec::new(), Vec::new(), Vec::new());
        for target in &written.targets {
            self.refuse_target(target.name.0, target.name, first.0 as usize + names.len())?;
            let action = target
                .does
                .map(|does| self.action(does, None))
                .transpose()?;
            names.push(target.name.0.to_owned());
            actions.push(action);
            volumes.push(target.volume());
        }
        let space = pointer::SelectionSpace {
            frame: Frame::of(&written.place),
            first_target: first,
            volumes: VolumeSet::new(volumes),
            actions,
        };
        Ok(SpaceTargets { names, space })
    }
}

impl Target<'_> {
    fn volume(&self) -> Volume {
        let (x, y, z) = self.at_mm;
        let half = |length: Extent| metres(length.get()) / 2.0;
        Volume {
            center: Vec3::new(metres(x.get()), metres(y.get()), metres(z.get())),
            shape: match self.form {
                Solid::Ball(diameter) => VolumeShape::Ball(half(diameter)),
                Solid::Box(x, y, z) => VolumeShape::Box(Vec3::new(half(x), half(y), half(z))),
            },
        }
    }
}
