//! Meshes in Wavefront OBJ. Materials, normals and textures are not used.

use std::io::Cursor;

use parry3d::math::Vec3;

use super::ShapeError;
use super::mesh::TriangleMesh;

/// Reads all objects of a file; faces with more than three corners are divided.
pub(super) fn read(bytes: &[u8]) -> Result<TriangleMesh, ShapeError> {
    let options = tobj::LoadOptions {
        triangulate: true,
        ignore_lines: true,
        ignore_points: true,
        ..tobj::LoadOptions::default()
    };
    let no_materials = |_: &std::path::Path| Ok(Default::default());
    let (models, _) =
        tobj::load_obj_buf(&mut Cursor::new(bytes), &options, no_materials).map_err(|error| {
            ShapeError::Invalid {
                format: "OBJ",
                reason: error.to_string(),
            }
        })?;
    let mut mesh = TriangleMesh::default();
    for model in models {
        let positions = model.mesh.positions.chunks_exact(3);
        let vertices = positions.map(|at| Vec3::new(at[0], at[1], at[2]));
        mesh.add(vertices, model.mesh.indices)?;
    }
    mesh.checked()
}
