//! Meshes in glTF 2.0, as JSON or GLB: the triangles of the default scene with the transforms of their nodes.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gltf::accessor::{Accessor, DataType, Dimensions};
use gltf::buffer::{Source, View};
use gltf::mesh::{Mode, Semantic};
use parry3d::math::Vec3;

use super::mesh::TriangleMesh;
use super::{MAX_FILE_BYTES, ShapeError};

/// The most nodes above another one.
const MAX_DEPTH: usize = 32;

/// The types of indices.
const INDEX_TYPES: [DataType; 3] = [DataType::U8, DataType::U16, DataType::U32];

/// The most vertices of all primitives: a file that names one list of positions often would take all memory.
const MAX_VERTICES: usize = 1 << 20;

/// The most bytes of all buffers, for the same reason: 16 MiB.
const MAX_BUFFER_BYTES: usize = 4 * MAX_FILE_BYTES as usize;

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
        if buffers.iter().map(Vec::len).sum::<usize>() > MAX_BUFFER_BYTES {
            return Err(invalid("its buffers have more than 16 MiB"));
        }
    }
    let scene = gltf.default_scene().or_else(|| gltf.scenes().next());
    let scene = scene.ok_or(ShapeError::Empty)?;
    let mut scene_mesh = SceneMesh {
        mesh: TriangleMesh::default(),
        buffers: &buffers,
        nodes: gltf.nodes().len(),
    };
    for node in scene.nodes() {
        scene_mesh.add(&node, glam::Mat4::IDENTITY, MAX_DEPTH)?;
    }
    scene_mesh.mesh.checked()
}

/// The mesh of a scene so far.
struct SceneMesh<'a> {
    mesh: TriangleMesh,
    buffers: &'a [Vec<u8>],
    /// Nodes of the file that were not added yet.
    nodes: usize,
}

impl SceneMesh<'_> {
    /// Adds a node, and those below it.
    fn add(
        &mut self,
        node: &gltf::Node,
        parent: glam::Mat4,
        depth: usize,
    ) -> Result<(), ShapeError> {
        let depth_below = depth
            .checked_sub(1)
            .ok_or_else(|| invalid("its nodes are nested too deeply"))?;
        // Nodes with two parents each would be added more often than time permits.
        self.nodes = self
            .nodes
            .checked_sub(1)
            .ok_or_else(|| invalid("a node is below several others; export it again"))?;
        let scene_from_node = parent * glam::Mat4::from_cols_array_2d(&node.transform().matrix());
        let primitives = node
            .mesh()
            .into_iter()
            .flat_map(|node_mesh| node_mesh.primitives());
        for primitive in primitives {
            if primitive.mode() == Mode::Triangles {
                self.add_primitive(&primitive, scene_from_node)?;
            }
        }
        for child in node.children() {
            self.add(&child, scene_from_node, depth_below)?;
        }
        Ok(())
    }

    /// Adds triangles with a transform.
    fn add_primitive(
        &mut self,
        primitive: &gltf::Primitive,
        scene_from_node: glam::Mat4,
    ) -> Result<(), ShapeError> {
        let positions = primitive.get(&Semantic::Positions);
        let positions = positions.ok_or(ShapeError::Broken)?;
        let count = checked_count(&positions, Dimensions::Vec3, &[DataType::F32])?;
        let corners = match primitive.indices() {
            Some(indices) => checked_count(&indices, Dimensions::Scalar, &INDEX_TYPES)?,
            None => count,
        };
        let triangles = self.mesh.triangles.len().saturating_add(corners / 3);
        if triangles > super::MAX_TRIANGLES {
            return Err(ShapeError::TooManyTriangles(triangles));
        }
        if self.mesh.vertices.len().saturating_add(count) > MAX_VERTICES {
            return Err(invalid("it has more than a million vertices; reduce them"));
        }
        let buffers = self.buffers;
        let reader = primitive.reader(|buffer| buffers.get(buffer.index()).map(Vec::as_slice));
        let vertices = reader.read_positions().ok_or(ShapeError::Broken)?;
        let vertices = vertices.map(|at| scene_from_node.transform_point3(Vec3::from_array(at)));
        match reader.read_indices() {
            Some(indices) => self.mesh.add(vertices, indices.into_u32()),
            None => self.mesh.add(vertices, 0..count as u32),
        }
    }
}

/// Returns the number of values of an accessor. On one that is not valid, the reader of the crate would panic.
fn checked_count(
    accessor: &Accessor,
    dimensions: Dimensions,
    types: &[DataType],
) -> Result<usize, ShapeError> {
    let size = accessor.size();
    let is_wide = |view: View, least: usize| view.stride().is_none_or(|stride| stride >= least);
    let is_readable = accessor.dimensions() == dimensions
        && types.contains(&accessor.data_type())
        && accessor.count() > 0
        && accessor.view().is_none_or(|view| is_wide(view, size))
        && accessor.sparse().is_none_or(|sparse| {
            let indices = sparse.indices();
            sparse.count() > 0
                && is_wide(indices.view(), indices.index_type().size())
                && is_wide(sparse.values().view(), size)
        });
    if is_readable {
        Ok(accessor.count())
    } else {
        let reason = "an accessor of positions or indices has no values, or values of another type; export it again";
        Err(invalid(reason))
    }
}

fn invalid(reason: impl Into<String>) -> ShapeError {
    ShapeError::Invalid {
        format: "glTF",
        reason: reason.into(),
    }
}
