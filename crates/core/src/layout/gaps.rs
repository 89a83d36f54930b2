//! Gaps between keys: the share that each key has of them.

use parry3d::math::Vec2;

use super::outline::Outline;
use crate::contact::surface::Share;

/// A distance that is far above rounding errors and far below what a person can see, in metres.
const TOLERANCE: f32 = 1e-5;

/// The outlines on a board, sorted for the search of neighbors.
pub(super) struct Neighborhood<'a> {
    outlines: &'a [Outline],
    /// The left edge and the index of each outline, from left to right.
    by_left_edge: Vec<(f32, usize)>,
    /// The width of the widest outline, in metres.
    max_width: f32,
}

impl<'a> Neighborhood<'a> {
    /// Creates the neighborhood of the outlines on one board.
    pub fn new(outlines: &'a [Outline]) -> Self {
        let left = |outline: &Outline| outline.center.x - outline.aabb_half_extents().x;
        let mut by_left_edge: Vec<(f32, usize)> = outlines.iter().map(left).zip(0..).collect();
        by_left_edge.sort_by(|a, b| a.0.total_cmp(&b.0));
        let widths = outlines.iter().map(|it| 2.0 * it.aabb_half_extents().x);
        Self {
            outlines,
            by_left_edge,
            max_width: widths.fold(0.0, f32::max),
        }
    }

    /// Returns the share of the outline with this index: on each side half the way to the nearest other outline beside it, at
    /// most `part` of its own shorter side, and at most `max` metres.
    pub fn share(&self, index: usize, part: f32, max: f32) -> Share {
        let outline = &self.outlines[index];
        let half = outline.half_extents();
        let reach = (2.0 * part * half.min_element()).min(max);
        // `[side][axis]`, the negative side first.
        let mut free = [[2.0 * reach; 2]; 2];
        for other in self.near(index, 2.0 * reach) {
            let corners = outline.local_corners(other);
            for axis in 0..2 {
                let Some([low, high]) = extent_beside(&corners, axis, half[1 - axis]) else {
                    continue;
                };
                let (below, above) = (-half[axis] - high, low - half[axis]);
                // The centers tell the side: neighbors may overlap by a rounding error.
                let side = usize::from(low + high > 0.0);
                let gap = if side == 0 { below } else { above };
                free[side][axis] = free[side][axis].min(gap.max(0.0));
            }
        }
        let [low, high] = free.map(|side| 0.5 * Vec2::from_array(side));
        Share { low, high }
    }

    /// Iterates over the outlines within `distance` of the edges of an outline, and some others.
    fn near(&self, index: usize, distance: f32) -> impl Iterator<Item = &'a Outline> + '_ {
        let outline = &self.outlines[index];
        // A turned outline is within the circle around its corners.
        let radius = |it: &Outline| it.half_extents().length();
        let (y, reach) = (outline.center.y, radius(outline) + distance);
        let half = outline.aabb_half_extents().x + distance;
        let [low, high] = [outline.center.x - half, outline.center.x + half];
        let start = self
            .by_left_edge
            .partition_point(|(left, _)| *left < low - self.max_width);
        self.by_left_edge[start..]
            .iter()
            .take_while(move |(left, _)| *left <= high)
            .filter(move |(_, other)| *other != index)
            .map(|(_, other)| &self.outlines[*other])
            .filter(move |other| (other.center.y - y).abs() <= reach + radius(other))
    }
}

/// Returns the lowest and highest coordinate along `axis` of the part of a quadrilateral that lies in the strip of
/// `half_width` around that axis, or `None` if no part does.
fn extent_beside(corners: &[Vec2; 4], axis: usize, half_width: f32) -> Option<[f32; 2]> {
    let across = corners.map(|corner| corner[1 - axis]);
    let [low, high] = [
        across.into_iter().fold(f32::INFINITY, f32::min),
        across.into_iter().fold(f32::NEG_INFINITY, f32::max),
    ];
    // A neighbor that shares only the border of the strip is beside it.
    if low > half_width - TOLERANCE || high < TOLERANCE - half_width {
        return None;
    }
    let mut extent = [f32::INFINITY, f32::NEG_INFINITY];
    let mut include = |along: f32| extent = [extent[0].min(along), extent[1].max(along)];
    for (index, &start) in corners.iter().enumerate() {
        let end = corners[(index + 1) % 4];
        if start[1 - axis].abs() <= half_width + TOLERANCE {
            include(start[axis]);
        }
        for edge in [-half_width, half_width] {
            let [from, to] = [start, end].map(|corner| corner[1 - axis] - edge);
            if from * to < 0.0 {
                include(start[axis] + (end[axis] - start[axis]) * from / (from - to));
            }
        }
    }
    Some(extent)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::surface::Shape;

    fn key(x: f32, y: f32, half: [f32; 2]) -> Outline {
        Outline {
            center: Vec2::new(x, y) * 1e-3,
            rotation: 0.0,
            shape: Shape::Box(Vec2::from_array(half) * 1e-3),
        }
    }

    /// Returns the share of the first outline in millimetres: left, right, near, far.
    fn share(outlines: &[Outline]) -> [f32; 4] {
        let Share { low, high } = Neighborhood::new(outlines).share(0, 0.5, 1.0);
        [low.x, high.x, low.y, high.y].map(|metres| (metres * 1e5).round() * 1e-2)
    }

    const HALF: [f32; 2] = [8.5, 8.5];

    #[test]
    fn a_key_has_half_of_each_gap_and_half_a_key_at_the_edge() {
        let alone = [key(0.0, 0.0, HALF)];
        assert_eq!(share(&alone), [8.5; 4]);
        let row = [
            key(0.0, 0.0, HALF),
            key(19.0, 0.0, HALF),
            key(-25.0, 0.0, HALF),
        ];
        assert_eq!(share(&row), [4.0, 1.0, 8.5, 8.5]);
        // A gap that is wider than the key.
        let far = [key(0.0, 0.0, HALF), key(60.0, 0.0, HALF)];
        assert_eq!(share(&far), [8.5; 4]);
    }

    #[test]
    fn a_staggered_row_and_a_wide_key_limit_the_sides_that_they_are_beside() {
        let staggered = [
            key(0.0, 0.0, HALF),
            key(9.5, -19.0, HALF),
            key(-9.5, 19.0, HALF),
        ];
        assert_eq!(share(&staggered), [8.5, 8.5, 1.0, 1.0]);
        let space = [key(0.0, 0.0, HALF), key(40.0, -19.0, [56.0, 8.5])];
        assert_eq!(share(&space), [8.5, 8.5, 1.0, 8.5]);
        let diagonal = [key(0.0, 0.0, HALF), key(19.0, 19.0, HALF)];
        assert_eq!(share(&diagonal), [8.5; 4]);
    }

    #[test]
    fn a_turned_neighbor_limits_by_its_nearest_point_in_the_strip() {
        let turned = Outline {
            rotation: std::f32::consts::FRAC_PI_4,
            ..key(24.0, 0.0, HALF)
        };
        let gap = 24.0 - 8.5 * std::f32::consts::SQRT_2 - 8.5;
        let found = share(&[key(0.0, 0.0, HALF), turned]);
        assert!((found[1] - 0.5 * gap).abs() < 0.01, "{found:?}");
        assert_eq!([found[0], found[2], found[3]], [8.5; 3]);
    }
}
