//! `layouts/arms/*.ron`: the links of an arm.

use parry3d::math::{Mat3, Pose, Vec3};
use serde::Deserialize;

use crate::document::Document;
use crate::document::DocumentError;
use crate::hand::{Dof, Finger, Joint, Side};
use crate::kinematics::{ArmModel, Link};

/// Centimetres to metres.
const CM: f32 = 0.01;

#[derive(Deserialize)]
#[serde(rename = "Arm", deny_unknown_fields)]
struct Written<'a> {
    #[serde(rename = "name")]
    _name: String,
    side: Side,
    tip_radius_mm: f32,
    mount: Mount,
    #[serde(borrow)]
    links: Vec<WrittenLink<'a>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Mount {
    at_cm: [f32; 3],
    x: [f32; 3],
    y: [f32; 3],
    z: [f32; 3],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenLink<'a> {
    name: &'a str,
    parent: Option<&'a str>,
    offset_cm: [f32; 3],
    axis: Axis,
    dof: Option<Dof>,
    length_cm: f32,
    joint: Option<Joint>,
    tip: Option<Finger>,
}

#[derive(Clone, Copy, Deserialize)]
enum Axis {
    X,
    Y,
    Z,
}

impl ArmModel {
    /// The arm with this name or path.
    pub fn load(name: &str) -> Result<Self, DocumentError> {
        Self::parse(&Document::open(name)?)
    }

    /// The arm that a document describes.
    pub fn parse(document: &Document) -> Result<Self, DocumentError> {
        let written: Written = document.parse()?;
        let Some(world_from_root) = written.mount.pose() else {
            let message =
                "the mount's x, y and z are three unit axes at right angles, right-handed";
            return Err(document.error_at(&document.text, message));
        };
        if !(0.1..=30.0).contains(&written.tip_radius_mm) {
            let message = "`tip_radius_mm` is 0.1 to 30 mm";
            return Err(document.error_at(&document.text, message));
        }
        let mut links: Vec<Link> = Vec::with_capacity(written.links.len());
        for link in &written.links {
            let link = link.checked(&links, document)?;
            links.push(link);
        }
        Self::new(
            written.side,
            links,
            world_from_root,
            written.tip_radius_mm * 1e-3,
        )
        .map_err(|error| document.error_at(&document.text, error))
    }
}

impl Mount {
    fn pose(&self) -> Option<Pose> {
        let [at, x, y, z] = [self.at_cm, self.x, self.y, self.z].map(Vec3::from_array);
        let usable = [x, y, z].iter().all(|axis| axis.is_normalized())
            && x.cross(y).distance(z) < 1e-3
            && at.is_finite();
        let rotation = glam::Quat::from_mat3(&Mat3::from_cols(x, y, z));
        usable.then(|| Pose::from_parts(at * CM, rotation))
    }
}

impl WrittenLink<'_> {
    fn checked(&self, before: &[Link], document: &Document) -> Result<Link, DocumentError> {
        if before.iter().any(|other| other.name == self.name) {
            return Err(
                document.error_at(self.name, format!("two links are called `{}`", self.name))
            );
        }
        let parent = match self.parent {
            None => None,
            Some(parent) => {
                let place = before.iter().position(|other| other.name == parent);
                let message = || format!("no link `{parent}` comes before `{}`", self.name);
                Some(place.ok_or_else(|| document.error_at(parent, message()))?)
            }
        };
        Ok(Link {
            name: self.name.to_owned(),
            parent,
            offset: Vec3::from_array(self.offset_cm) * CM,
            axis: match self.axis {
                Axis::X => Vec3::X,
                Axis::Y => Vec3::Y,
                Axis::Z => Vec3::Z,
            },
            dof: self.dof,
            length: self.length_cm * CM,
            joint: self.joint,
            fingertip: self.tip,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(links: &str, mount_z: &str) -> String {
        let text = format!(
            "Arm(name: \"a\", side: \"right\", tip_radius_mm: 5,\n\
             mount: (at_cm: (0, 0, 0), x: (1, 0, 0), y: (0, 1, 0), z: {mount_z}),\nlinks: [\n{links}\n])"
        );
        ArmModel::parse(&Document::new("a.ron", text))
            .unwrap_err()
            .to_string()
    }

    #[test]
    fn the_shipped_arm_has_25_links_and_five_fingertips() {
        let arm = ArmModel::load("unam").unwrap();
        assert_eq!(arm.links().len(), 25);
        assert_eq!(
            arm.links()
                .iter()
                .filter(|link| link.fingertip.is_some())
                .count(),
            5
        );
        assert_eq!(
            arm.world_from_root().rotation,
            ArmModel::palm_down_pose().rotation
        );
    }

    #[test]
    fn a_tree_that_is_none_and_a_mount_that_is_none_are_refused() {
        let link = |name: &str, parent: &str| {
            format!(
                "(name: \"{name}\", parent: \"{parent}\", offset_cm: (0, 0, 0), axis: X, length_cm: 1),"
            )
        };
        let orphan = error(&link("b", "nobody"), "(0, 0, 1)");
        assert!(
            orphan.contains("a.ron:4:") && orphan.contains("no link `nobody` comes before `b`"),
            "{orphan}"
        );
        assert!(error("", "(0, 0, -1)").contains("right-handed"));
        assert!(error("", "(0, 0, 1)").contains("no link is a fingertip"));
    }
}
