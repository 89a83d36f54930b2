//! Triangles in space.

use parry3d::math::Vec3;

use super::ShapeError;

/// The most triangles of a mesh: the 3D view draws them without a graphics card.
pub const MAX_TRIANGLES: usize = 20_000;

/// A mesh in the units of its file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleMesh {
    /// The positions of the vertices.
    pub vertices: Vec<Vec3>,
    /// The corners of the triangles, as indices of vertices.
    pub triangles: Vec<[u32; 3]>,
}

impl TriangleMesh {
    /// Adds triangles whose indices begin with 0.
    pub(super) fn add(
        &mut self,
        vertices: impl IntoIterator<Item = Vec3>,
        indices: impl IntoIterator<Item = u32>,
    ) -> Result<(), ShapeError> {
        let first = self.vertices.len() as u32;
        self.vertices.extend(vertices);
        let indices: Vec<u32> = indices.into_iter().collect();
        if !indices.len().is_multiple_of(3) {
            return Err(ShapeError::Broken);
        }
        for corners in indices.chunks_exact(3) {
            let corners = [corners[0], corners[1], corners[2]];
            let corners = corners.map(|corner| corner.saturating_add(first));
            self.triangles.push(corners);
        }
        Ok(())
    }

    /// Returns the mesh if all of it can be drawn.
    pub(super) fn checked(self) -> Result<Self, ShapeError> {
        if self.triangles.is_empty() {
            return Err(ShapeError::Empty);
        }
        if self.triangles.len() > MAX_TRIANGLES {
            return Err(ShapeError::TooManyTriangles(self.triangles.len()));
        }
        let count = self.vertices.len();
        let mut corners = self.triangles.iter().flatten();
        let is_valid = self.vertices.iter().all(|vertex| vertex.is_finite())
            && corners.all(|&corner| (corner as usize) < count);
        if is_valid {
            Ok(self)
        } else {
            Err(ShapeError::Broken)
        }
    }
}
