//! Arm models, from `layouts/arms/*.ron`: the links of an arm.

use parry3d::math::{Mat3, Pose, Vec3};
use serde::Deserialize;

use crate::document::{Document, DocumentError};
use crate::hand::{Dof, Finger, Joint, Side};
use crate::kinematics::{ArmModel, Link};

const METRES_PER_CM: f32 = 0.01;

#[derive(Deserialize)]
#[serde(rename = "Arm", deny_unknown_fields)]
struct ArmSchema<'a> {
    #[serde(rename = "name")]
    _name: String,
    side: Side,
    tip_radius_mm: f32,
    mount: MountSchema,
    #[serde(borrow)]
    links: Vec<LinkSchema<'a>>,
}

/// The pose of the arm in the world: origin and axes.
#[derive(Deserialize)]
#[serde(rename = "Mount", deny_unknown_fields)]
struct MountSchema {
    at_cm: [f32; 3],
    x: [f32; 3],
    y: [f32; 3],
    z: [f32; 3],
}

#[derive(Deserialize)]
#[serde(rename = "Link", deny_unknown_fields)]
struct LinkSchema<'a> {
    name: &'a str,
    parent: Option<&'a str>,
    offset_cm: [f32; 3],
    axis: AxisSchema,
    dof: Option<Dof>,
    length_cm: f32,
    joint: Option<Joint>,
    fingertip: Option<Finger>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename = "Axis")]
enum AxisSchema {
    X,
    Y,
    Z,
}

impl ArmModel {
    /// Parses a document.
    pub fn parse(document: &Document) -> Result<Self, DocumentError> {
        let schema: ArmSchema = document.parse()?;
        let Some(world_from_root) = schema.mount.pose() else {
            let message =
                "x, y and z of `mount` must be unit vectors at right angles, right-handed";
            return Err(document.error_at(&document.text, message));
        };
        if !(0.1..=30.0).contains(&schema.tip_radius_mm) {
            let message = "`tip_radius_mm` is 0.1 to 30 mm";
            return Err(document.error_at(&document.text, message));
        }
        let mut links: Vec<Link> = Vec::with_capacity(schema.links.len());
        for link in &schema.links {
            let link = link.build(&links, document)?;
            links.push(link);
        }
        Self::new(
            schema.side,
            links,
            world_from_root,
            schema.tip_radius_mm * 1e-3,
        )
        .map_err(|error| document.error_at(&document.text, error))
    }
}

impl MountSchema {
    /// Returns the pose, or `None` if the axes are not a right-handed orthonormal basis.
    fn pose(&self) -> Option<Pose> {
        let [position, x, y, z] = [self.at_cm, self.x, self.y, self.z].map(Vec3::from_array);
        let is_valid = [x, y, z].iter().all(|axis| axis.is_normalized())
            && x.cross(y).distance(z) < 1e-3
            && position.is_finite();
        let rotation = glam::Quat::from_mat3(&Mat3::from_cols(x, y, z));
        is_valid.then(|| Pose::from_parts(position * METRES_PER_CM, rotation))
    }
}

impl LinkSchema<'_> {
    /// Returns the link. Its parent is one of the links before it.
    fn build(&self, before: &[Link], document: &Document) -> Result<Link, DocumentError> {
        if before.iter().any(|other| other.name == self.name) {
            let message = format!("duplicate link `{}`", self.name);
            return Err(document.error_at(self.name, message));
        }
        let parent = match self.parent {
            None => None,
            Some(parent) => {
                let index = before.iter().position(|other| other.name == parent);
                let message = || format!("no link `{parent}` comes before `{}`", self.name);
                Some(index.ok_or_else(|| document.error_at(parent, message()))?)
            }
        };
        Ok(Link {
            name: self.name.to_owned(),
            parent,
            offset: Vec3::from_array(self.offset_cm) * METRES_PER_CM,
            axis: match self.axis {
                AxisSchema::X => Vec3::X,
                AxisSchema::Y => Vec3::Y,
                AxisSchema::Z => Vec3::Z,
            },
            dof: self.dof,
            length: self.length_cm * METRES_PER_CM,
            joint: self.joint,
            fingertip: self.fingertip,
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
        let arm = ArmModel::parse(&Document::shipped("unam").unwrap()).unwrap();
        assert_eq!(arm.links().len(), 25);
        let tips = arm.links().iter().filter(|link| link.fingertip.is_some());
        assert_eq!(tips.count(), 5);
        assert_eq!(
            arm.world_from_root().rotation,
            ArmModel::palm_down_pose().rotation
        );
    }

    #[test]
    fn an_invalid_tree_and_an_invalid_mount_are_rejected() {
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
