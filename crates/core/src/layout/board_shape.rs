//! Flat and curved boards: from row coordinates to the board's frame and back.
//!
//! Layout files have row coordinates: x along the key's own row, y across the rows, in metres.

use std::f32::consts::PI;

use parry3d::math::{Pose, Rot3, Vec2, Vec3};

use super::outline::Outline;
use crate::contact::surface::Shape;

/// The shape of a board; radii in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BoardShape {
    /// A flat board with straight rows.
    Flat,
    /// A flat board whose rows are arcs around a point on the wearer's side. The radius is that at y = 0.
    Arc(f32),
    /// A cylinder whose axis is parallel to Y, at this distance in front of (0, 0); its rows are curved.
    CurvedRows(f32),
    /// A cylinder whose axis is parallel to X; its columns are curved.
    CurvedColumns(f32),
}

impl BoardShape {
    /// Returns the outline of a key at a position in row coordinates.
    ///
    /// Returns `None` if the key is nearer to the center of an arc than its own size, or extends beyond half a turn of an arc or
    /// a cylinder.
    pub(super) fn outline(self, row_position: Vec2, shape: Shape) -> Option<Outline> {
        let upright = Outline {
            center: row_position,
            rotation: 0.0,
            shape,
        };
        let half = upright.half_extents();
        match self {
            Self::Flat => Some(upright),
            Self::CurvedRows(radius) => {
                (row_position.x.abs() + half.x <= PI * radius).then_some(upright)
            }
            Self::CurvedColumns(radius) => {
                (row_position.y.abs() + half.y <= PI * radius).then_some(upright)
            }
            Self::Arc(radius_at_zero) => {
                let radius = radius_at_zero + row_position.y;
                let size = match shape {
                    Shape::Box(extents) => extents.length(),
                    Shape::Disc(disc_radius) => disc_radius,
                };
                let angle = row_position.x / radius;
                if radius <= size || angle.abs() > PI {
                    return None;
                }
                let direction = Vec2::new(angle.sin(), angle.cos());
                Some(Outline {
                    center: direction * radius - Vec2::Y * radius_at_zero,
                    rotation: -angle,
                    shape,
                })
            }
        }
    }

    /// Returns the frame tangent to the board at an outline, its +Z pointing out of the board.
    pub(super) fn surface_from_tangent(self, outline: &Outline) -> Pose {
        let center = outline.center;
        let in_plane = Rot3::from_rotation_z(outline.rotation);
        match self {
            Self::Flat | Self::Arc(_) => Pose::from_parts(center.extend(0.0), in_plane),
            Self::CurvedRows(radius) => {
                let angle = center.x / radius;
                let position = Vec3::new(angle.sin() * radius, center.y, rise(angle, radius));
                Pose::from_parts(position, Rot3::from_rotation_y(-angle) * in_plane)
            }
            Self::CurvedColumns(radius) => {
                let angle = center.y / radius;
                let position = Vec3::new(center.x, angle.sin() * radius, rise(angle, radius));
                Pose::from_parts(position, Rot3::from_rotation_x(angle) * in_plane)
            }
        }
    }

    /// Returns the row coordinates of a point in the plane of the board: the inverse of `outline`.
    pub fn row_position(self, point: Vec2) -> Vec2 {
        let Self::Arc(radius_at_zero) = self else {
            return point;
        };
        let from_center = point + Vec2::Y * radius_at_zero;
        let radius = from_center.length();
        Vec2::new(
            from_center.x.atan2(from_center.y) * radius,
            radius - radius_at_zero,
        )
    }

    /// Returns the rotation of an upright key at a position in row coordinates, in radians.
    pub fn row_rotation(self, row_position: Vec2) -> f32 {
        match self {
            Self::Arc(radius_at_zero) => -row_position.x / (radius_at_zero + row_position.y),
            _ => 0.0,
        }
    }

    /// Returns the point of the board's frame at row coordinates: the inverse of `unbend` on the board.
    pub fn bend(self, row_position: Vec2) -> Vec3 {
        let center = match self {
            Self::Arc(radius_at_zero) => {
                let radius = radius_at_zero + row_position.y;
                let (sin, cos) = (row_position.x / radius).sin_cos();
                Vec2::new(sin, cos) * radius - Vec2::Y * radius_at_zero
            }
            _ => row_position,
        };
        let outline = Outline {
            center,
            rotation: 0.0,
            shape: Shape::Disc(0.0),
        };
        self.surface_from_tangent(&outline).translation
    }

    /// Returns a point of the board's frame as row coordinates (x, y) and distance in front of the board (z), in metres.
    pub fn unbend(self, point: Vec3) -> Vec3 {
        let unroll = |along: f32, radius: f32| {
            let from_axis = Vec2::new(along, radius - point.z);
            (
                from_axis.x.atan2(from_axis.y) * radius,
                radius - from_axis.length(),
            )
        };
        match self {
            Self::Flat | Self::Arc(_) => self.row_position(point.truncate()).extend(point.z),
            Self::CurvedRows(radius) => {
                let (x, height) = unroll(point.x, radius);
                Vec3::new(x, point.y, height)
            }
            Self::CurvedColumns(radius) => {
                let (y, height) = unroll(point.y, radius);
                Vec3::new(point.x, y, height)
            }
        }
    }
}

/// Returns the distance of a point of a cylinder from its tangent plane at (0, 0).
fn rise(angle: f32, radius: f32) -> f32 {
    radius * (1.0 - angle.cos())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn row_coordinates_are_bent_and_unbent() {
        let shapes = [
            BoardShape::Flat,
            BoardShape::Arc(0.06),
            BoardShape::CurvedRows(0.1),
            BoardShape::CurvedColumns(0.1),
        ];
        for shape in shapes {
            for at in [Vec2::ZERO, Vec2::new(0.05, 0.02), Vec2::new(-0.08, -0.03)] {
                let back = shape.unbend(shape.bend(at));
                assert!(
                    back.distance(at.extend(0.0)) < 1e-6,
                    "{shape:?} {at}: {back}"
                );
            }
        }
        let end = BoardShape::Arc(0.06).bend(Vec2::new(0.06, 0.0));
        assert!(
            end.y < -0.02,
            "the end of a row is nearer to the wearer: {end}"
        );
    }
}
