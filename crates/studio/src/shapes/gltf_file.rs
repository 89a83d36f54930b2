//! Meshes in glTF 2.0, as JSON or GLB: the triangles of the default scene with the transforms of their nodes.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gltf::buffer::Source;
use gltf::mesh::Mode;
use parry3d::math::Vec3;

use super::mesh::TriangleMesh;
use super::{MAX_FILE_BYTES, ShapeError};

/// The most nodes above another one.
const MAX_DEPTH: usize = 32;

/// Reads a file. `read_buffer` returns the bytes of a file beside it.
pub(super) fn read(
    bytes: &[u8],
    read_buffer: &mut dyn FnMut(&str) -> Result<Vec<u8>, ShapeError>,
) -> Result<TriangleMesh, ShapeError> {
    let mut gltf = gltf::Gltf::from_slice(bytes).map_err(|error| invalid(error.to_string()))?;
    let mut blob = gltf.blob.take();
    let mut buffers = Vec::new();
    for buffer in gltf.buffers() {
        let content = match buffer.source() {
            Source::Bin => blob
                .take()
                .ok_or_else(|| invalid("the binary part is missing"))?,
            Source::Uri(uri) => match uri.split_once(";base64,") {
                Some((start, text)) if start.starts_with("data:") => STANDARD
                    .decode(text)
                    .map_err(|error| invalid(error.to_string()))?,
                _ => read_buffer(uri)?,
            },
        };
        if content.len() < buffer.length() || content.len() as u64 > MAX_FILE_BYTES {
            return Err(invalid("a buffer has another length than stated"));
        }
        buffers.push(content);
    }
    let scene = gltf.default_scene().or_else(|| gltf.scenes().next());
    let scene = scene.ok_or(ShapeError::Empty)?;
    let mut mesh = TriangleMesh::default();
    for node in scene.nodes() {
        add_node(&mut mesh, &node, glam::Mat4::IDENTITY, &buffers, MAX_DEPTH)?;
    }
    mesh.checked()
}

fn add_node(
    mesh: &mut TriangleMesh,
    node: &gltf::Node,
    parent: glam::Mat4,
    buffers: &[Vec<u8>],
    depth: usize,
) -> Result<(), ShapeError> {
    let depth = depth
        .checked_sub(1)
        .ok_or_else(|| invalid("its nodes are nested too deeply"))?;
    let scene_from_node = parent * glam::Mat4::from_cols_array_2d(&node.transform().matrix());
    let primitives = node
        .mesh()
        .into_iter()
        .flat_map(|node_mesh| node_mesh.primitives());
    for primitive in primitives {
        if primitive.mode() != Mode::Triangles {
            continue;
        }
        let reader = primitive.reader(|buffer| buffers.get(buffer.index()).map(Vec::as_slice));
        let positions = reader.read_positions().ok_or(ShapeError::Broken)?;
        let vertices: Vec<Vec3> = positions
            .map(|at| scene_from_node.transform_point3(Vec3::from_array(at)))
            .collect();
        let count = vertices.len() as u32;
        match reader.read_indices() {
            Some(indices) => mesh.add(vertices, indices.into_u32())?,
            None => mesh.add(vertices, 0..count)?,
        }
        if mesh.triangles.len() > super::MAX_TRIANGLES {
            return Err(ShapeError::TooManyTriangles(mesh.triangles.len()));
        }
    }
    for child in node.children() {
        add_node(mesh, &child, scene_from_node, buffers, depth)?;
    }
    Ok(())
}

fn invalid(reason: impl Into<String>) -> ShapeError {
    ShapeError::Invalid {
        format: "glTF",
        reason: reason.into(),
    }
}
