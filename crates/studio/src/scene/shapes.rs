//! Shapes: the meshes of a layout on the joints of the hands.

use parry3d::math::{Pose, Vec3};

use super::{Canvas, skin};
use crate::model::StudioModel;
use crate::shapes::TriangleMesh;
use ademan_core::hand::Side;
use ademan_core::kinematics::HandPose;
use ademan_core::layout::Shape;

/// Adds the shapes of all triggers to the hands that have them, at the present values.
pub(super) fn add_shapes(canvas: &mut Canvas, model: &StudioModel) {
    let layout = &model.view.layout;
    for (target, shape) in &layout.shapes {
        let Some(mesh) = model.shapes.mesh(&shape.file) else {
            continue;
        };
        let side = layout.trigger_side(*target);
        let value = model.values.get(target).copied().unwrap_or(0.0);
        let poses = model.poses.iter().flatten();
        for pose in poses.filter(|pose| side.is_none_or(|side| side == pose.side)) {
            if let Some(world_from_joint) = pose.get(shape.joint) {
                add_mesh(
                    canvas,
                    mesh,
                    &placed(mesh, shape, value, world_from_joint, pose.side),
                );
            }
        }
    }
}

/// Adds the meshes of an arm file in place of the skin of a hand. Returns `false` if there are none.
pub(super) fn add_limbs(canvas: &mut Canvas, model: &StudioModel, pose: &HandPose) -> bool {
    let limbs = model.shapes.limbs();
    let has_limbs = limbs.len() > 0;
    for (shape, mesh) in limbs {
        if let Some(world_from_joint) = pose.get(shape.joint) {
            add_mesh(
                canvas,
                mesh,
                &placed(mesh, shape, 0.0, world_from_joint, pose.side),
            );
        }
    }
    has_limbs
}

/// Returns the vertices of a mesh in the world. The mesh of a left hand is mirrored.
fn placed(
    mesh: &TriangleMesh,
    shape: &Shape,
    value: f32,
    world_from_joint: &Pose,
    side: Side,
) -> Vec<Vec3> {
    let mirror = match side {
        Side::Left => Vec3::new(1.0, 1.0, -1.0),
        Side::Right => Vec3::ONE,
    };
    let place = |&vertex: &Vec3| *world_from_joint * (shape.place(vertex, value) * mirror);
    mesh.vertices.iter().map(place).collect()
}

/// Adds flat triangles, lit from both sides: the order of the corners differs between programs.
fn add_mesh(canvas: &mut Canvas, mesh: &TriangleMesh, vertices: &[Vec3]) {
    let colors = [canvas.colors.key_side, canvas.colors.label];
    canvas.skin.start_limb();
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|corner| vertices[corner as usize]);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let to_eye = canvas.projection.to_eye(a);
        let normal = normal * normal.dot(to_eye).signum();
        let lit = [a, b, c].map(|point| skin::corner(canvas, point, normal, colors, 1.0));
        if let [Some(first), Some(second), Some(third)] = lit {
            canvas.skin.add([first, second, third]);
        }
    }
}
