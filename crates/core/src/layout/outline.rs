//! Outlines of keys and controls in the plane of their board, and the test for overlaps.

use parry3d::math::Vec2;

use crate::contact::surface::Shape;

/// Depth by which two outlines may overlap, in metres: far above rounding errors, far below what a person can see.
const OVERLAP_TOLERANCE: f32 = 1e-5;

/// The outline of a key or control in the plane of its board.
///
/// In the board's frame, in metres: +X to the right along the rows, +Y away from the wearer. The plane of a cylinder is its
/// unrolled surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outline {
    /// The center.
    pub center: Vec2,
    /// Rotation about the center, in radians, counter-clockwise as seen by the wearer.
    pub rotation: f32,
    /// Half extents of a box or radius of a disc.
    pub shape: Shape,
}

impl Outline {
    /// Returns the half extents before the rotation; a disc has its radius in both.
    pub fn half_extents(&self) -> Vec2 {
        match self.shape {
            Shape::Box(half) => half,
            Shape::Disc(radius) => Vec2::splat(radius),
        }
    }

    /// Returns the half extents of the axis-aligned bounding box.
    pub fn aabb_half_extents(&self) -> Vec2 {
        match self.shape {
            Shape::Disc(radius) => Vec2::splat(radius),
            Shape::Box(half) => {
                let [x_axis, y_axis] = self.axes();
                x_axis.abs() * half.x + y_axis.abs() * half.y
            }
        }
    }

    /// Returns `true` if the outlines share more than an edge.
    pub fn overlaps(&self, other: &Self) -> bool {
        self.overlap_depth(other) > OVERLAP_TOLERANCE
    }

    /// Returns the distance by which one outline has to move so that they only touch, in metres; 0 or negative if they do not
    /// overlap.
    pub(super) fn overlap_depth(&self, other: &Self) -> f32 {
        let offset = other.center - self.center;
        match (self.shape, other.shape) {
            (Shape::Disc(a), Shape::Disc(b)) => a + b - offset.length(),
            (Shape::Box(half), Shape::Disc(radius)) => {
                depth_in_box(self.local(offset), half, radius)
            }
            (Shape::Disc(radius), Shape::Box(half)) => {
                depth_in_box(other.local(-offset), half, radius)
            }
            // Separating axis theorem.
            (Shape::Box(_), Shape::Box(_)) => {
                let axes = self.axes().into_iter().chain(other.axes());
                let depths = axes.map(|axis| {
                    self.half_extent_along(axis) + other.half_extent_along(axis)
                        - offset.dot(axis).abs()
                });
                depths.fold(f32::INFINITY, f32::min)
            }
        }
    }

    /// Returns the corners of another outline, or of the square around a disc, in the axes of this one.
    pub(super) fn local_corners(&self, other: &Self) -> [Vec2; 4] {
        let [x_axis, y_axis] = other.axes();
        let half = other.half_extents();
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| {
            let corner = x_axis * (x * half.x) + y_axis * (y * half.y);
            self.local(other.center + corner - self.center)
        })
    }

    /// Returns the local +X and +Y axes.
    fn axes(&self) -> [Vec2; 2] {
        let x_axis = Vec2::from_angle(self.rotation);
        [x_axis, x_axis.perp()]
    }

    fn half_extent_along(&self, axis: Vec2) -> f32 {
        let [x_axis, y_axis] = self.axes();
        let half = self.half_extents();
        half.x * axis.dot(x_axis).abs() + half.y * axis.dot(y_axis).abs()
    }

    fn local(&self, direction: Vec2) -> Vec2 {
        let [x_axis, y_axis] = self.axes();
        Vec2::new(direction.dot(x_axis), direction.dot(y_axis))
    }
}

/// Returns the depth of a disc in the box with these half extents around the origin.
fn depth_in_box(center: Vec2, half: Vec2, radius: f32) -> f32 {
    let beyond = center - center.clamp(-half, half);
    let inside = (half - center.abs()).min_element().max(0.0);
    radius - beyond.length() + inside
}

/// Returns pairs of indices of overlapping outlines, the smaller index first, at most `max`, in the order in which a reader of
/// the file meets the second one.
///
/// Sweeps along X, so that 10 000 keys take milliseconds.
pub(super) fn overlapping_pairs(outlines: &[Outline], max: usize) -> Vec<(usize, usize)> {
    let aabbs: Vec<(Vec2, Vec2)> = outlines
        .iter()
        .map(|outline| {
            let half = outline.aabb_half_extents();
            (outline.center - half, outline.center + half)
        })
        .collect();
    let mut by_left_edge: Vec<usize> = (0..outlines.len()).collect();
    by_left_edge.sort_by(|&a, &b| aabbs[a].0.x.total_cmp(&aabbs[b].0.x));
    let mut pairs = Vec::new();
    'sweep: for (rank, &a) in by_left_edge.iter().enumerate() {
        let (min, max_corner) = aabbs[a];
        let candidates = by_left_edge[rank + 1..]
            .iter()
            .copied()
            .take_while(|&b| aabbs[b].0.x < max_corner.x)
            .filter(|&b| aabbs[b].0.y < max_corner.y && min.y < aabbs[b].1.y);
        for b in candidates {
            if outlines[a].overlaps(&outlines[b]) {
                pairs.push((a.min(b), a.max(b)));
                if pairs.len() == max {
                    break 'sweep;
                }
            }
        }
    }
    pairs.sort_unstable_by_key(|&(first, second)| (second, first));
    pairs
}

#[cfg(test)]
mod tests {
    use std::f32::consts::FRAC_PI_4;

    use super::*;

    fn square(x: f32, y: f32, rotation: f32) -> Outline {
        Outline {
            center: Vec2::new(x, y),
            rotation,
            shape: Shape::Box(Vec2::splat(0.01)),
        }
    }

    fn disc(x: f32, y: f32) -> Outline {
        Outline {
            shape: Shape::Disc(0.01),
            ..square(x, y, 0.0)
        }
    }

    #[test]
    fn touching_edges_do_not_overlap_and_a_tenth_of_a_millimetre_does() {
        for (distance, overlaps) in [(0.02, false), (0.0199, true)] {
            let upright = square(0.0, 0.0, 0.0);
            assert_eq!(upright.overlaps(&square(distance, 0.0, 0.0)), overlaps);
            assert_eq!(disc(0.0, 0.0).overlaps(&disc(0.0, distance)), overlaps);
            assert_eq!(upright.overlaps(&disc(distance, 0.0)), overlaps);
            assert_eq!(disc(distance, 0.0).overlaps(&upright), overlaps);
        }
    }

    #[test]
    fn corners_are_compared_exactly() {
        let upright = square(0.0, 0.0, 0.0);
        // The bounding boxes overlap, the shapes do not.
        assert!(!upright.overlaps(&disc(0.0175, 0.0175)));
        assert!(!upright.overlaps(&square(0.0175, 0.0175, FRAC_PI_4)));
        assert!(upright.overlaps(&square(0.0165, 0.0165, FRAC_PI_4)));
        assert!(upright.overlaps(&square(0.024, 0.0, FRAC_PI_4)));
        assert!(!upright.overlaps(&square(0.0242, 0.0, FRAC_PI_4)));
    }

    #[test]
    fn a_key_inside_another_overlaps_it() {
        let small = Outline {
            shape: Shape::Disc(0.001),
            ..disc(0.002, 0.002)
        };
        assert!(square(0.0, 0.0, 0.3).overlaps(&small) && small.overlaps(&disc(0.0, 0.0)));
    }

    #[test]
    fn the_depth_is_the_way_out() {
        let depth = |one: Outline, other: Outline| (one.overlap_depth(&other) * 1e4).round() / 10.0;
        let upright = square(0.0, 0.0, 0.0);
        assert_eq!(depth(upright, square(0.018, 0.005, 0.0)), 2.0);
        assert_eq!(depth(disc(0.0, 0.0), disc(0.0, 0.015)), 5.0);
        assert_eq!(depth(upright, disc(0.017, 0.0)), 3.0);
        assert_eq!(depth(disc(0.004, 0.0), upright), 16.0, "from the inside");
        assert_eq!(depth(upright, square(0.023, 0.0, 0.0)), -3.0);
    }

    #[test]
    fn overlaps_are_in_the_order_of_the_file() {
        let row = [
            square(0.30, 0.0, 0.0),
            square(0.10, 0.0, 0.0),
            square(0.305, 0.0, 0.0),
            square(0.105, 0.0, 0.0),
        ];
        assert_eq!(overlapping_pairs(&row, 10), [(0, 2), (1, 3)]);
        assert_eq!(overlapping_pairs(&row, 1).len(), 1);
        assert_eq!(overlapping_pairs(&row[..2], 10), []);
    }
}
