//! Arm models, from `layouts/arms/*.ron`: the links of an arm.

use parry3d::math::{Mat3, Pose, Vec3};
use serde::Deserialize;

use super::shape::{Shape, ShapeSchema};
use crate::document::{Document, DocumentError, Table, schema, tables_of};
use crate::hand::{Dof, Finger, Joint, Side};
use crate::kinematics::{ArmModel, Link};

const METRES_PER_CM: f32 = 0.01;

schema! {
    /// An arm model file.
    #[derive(Deserialize)]
    #[serde(rename = "Arm", deny_unknown_fields)]
    struct ArmSchema<'a> {
        /// Name for displays.
        #[serde(rename = "name")]
        _name: String,
        /// The arm of this hand.
        side: Side,
        /// Radius of a fingertip, 0.1 to 30.
        tip_radius_mm: f32,
        /// Pose of the arm in the world.
        mount: MountSchema,
        /// The links, each after its parent.
        #[serde(borrow)]
        links: Vec<LinkSchema<'a>>,
        /// Meshes in place of the skin.
        #[serde(borrow, default)]
        shapes: Vec<ShapeSchema<'a>>,
    }
}

schema! {
    /// The pose of an arm in the world. The axes are unit vectors at right angles, right-handed.
    #[derive(Deserialize)]
    #[serde(rename = "Mount", deny_unknown_fields)]
    struct MountSchema {
        /// Origin.
        at_cm: [f32; 3],
        /// X axis of the arm.
        x: [f32; 3],
        /// Y axis of the arm.
        y: [f32; 3],
        /// Z axis of the arm.
        z: [f32; 3],
    }
}

schema! {
    /// A link of an arm.
    #[derive(Deserialize)]
    #[serde(rename = "Link", deny_unknown_fields)]
    struct LinkSchema<'a> {
        /// Name, by which its children name it.
        name: &'a str,
        /// Name of the link to which it is attached. Default: the mount.
        parent: Option<&'a str>,
        /// Position of its joint in the frame of the parent.
        offset_cm: [f32; 3],
        /// Axis of its joint.
        axis: AxisSchema,
        /// Angle of its joint. Default: the joint does not move.
        dof: Option<Dof>,
        /// Length along its x axis.
        length_cm: f32,
        /// Point of the hand at its end.
        joint: Option<Joint>,
        /// Finger whose tip is at its end.
        fingertip: Option<Finger>,
    }
}

schema! {
    /// The axis of a joint.
    #[derive(Clone, Copy, Deserialize)]
    #[serde(rename = "Axis")]
    enum AxisSchema {
        /// The x axis.
        X,
        /// The y axis.
        Y,
        /// The z axis.
        Z,
    }
}

/// Returns the tables of the fields of an arm model file.
pub fn arm_field_tables() -> Vec<Table> {
    tables_of::<ArmSchema>()
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
        schema.shapes(document)?;
        Self::new(
            schema.side,
            links,
            world_from_root,
            schema.tip_radius_mm * 1e-3,
        )
        .map_err(|error| document.error_at(&document.text, error))
    }
}

/// Returns the meshes of the limbs in an arm file; none if the limbs have the skin of the program. They have the value 0.
pub fn arm_shapes(document: &Document) -> Result<Vec<Shape>, DocumentError> {
    let schema: ArmSchema = document.parse()?;
    schema.shapes(document)
}

impl ArmSchema<'_> {
    fn shapes(&self, document: &Document) -> Result<Vec<Shape>, DocumentError> {
        let shapes = self.shapes.iter();
        shapes.map(|shape| shape.build(document)).collect()
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
    fn meshes_of_limbs_are_checked_and_a_shipped_arm_has_none() {
        let shipped = Document::shipped("unam").unwrap();
        assert_eq!(arm_shapes(&shipped), Ok(Vec::new()));
        let with = |shapes: &str| {
            let end = shipped.text.rfind(')').unwrap();
            Document::new(
                "a.ron",
                format!("{}shapes: [{shapes}])", &shipped.text[..end]),
            )
        };
        let own = with("(file: \"palm.glb\", joint: \"wrist\", unit_mm: 1000)");
        assert_eq!(arm_shapes(&own).unwrap()[0].unit, 1.0);
        assert!(ArmModel::parse(&own).is_ok());
        let error = ArmModel::parse(&with("(file: \"../palm.glb\", joint: \"wrist\")"));
        let error = error.unwrap_err().to_string();
        assert!(
            error.contains("a.ron:") && error.contains("in the folder"),
            "{error}"
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
