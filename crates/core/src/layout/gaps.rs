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

    /// Returns the share of the outline with this index: on each side half the width of the gap to the nearest other outline beside
    /// it, at most `part` of its own shorter side, and at most `max` metres. A gap that narrows towards one end, as between two keys
    /// on an arc, counts by its widest part, but the share does not reach into the other outline: both shares cover the gap, and overlap.
    pub fn share(&self, index: usize, part: f32, max: f32) -> Share {
        let outline = &self.outlines[index];
        let half = outline.half_extents();
        let reach = (2.0 * part * half.min_element()).min(max);
        // `[side][axis]`, the negative side first.
        let mut free = [[2.0 * reach; 2]; 2];
        for other in self.near(index, 2.0 * reach) {
            let corners = outline.local_corners(other);
            for axis in 0..2 {
                let Some(beside) = Beside::new(&corners, axis, half[1 - axis]) else {
                    continue;
                };
                let [narrow, wide] = beside.edge.map(|edge| (edge - half[axis]).max(0.0));
                let gap = wide.min(2.0 * narrow);
                let side = usize::from(beside.is_above);
                free[side][axis] = free[side][axis].min(gap);
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

/// The part of a neighbor that lies in the strip of an outline along one of its axes.
struct Beside {
    /// `true` if it lies in the positive direction.
    is_above: bool,
    /// The smallest and the largest distance of its near edge from the center of the outline, along the axis, in metres.
    edge: [f32; 2],
}

impl Beside {
    /// Returns the part of a quadrilateral in the strip of `half_width` around `axis`, or `None` if there is none.
    fn new(corners: &[Vec2; 4], axis: usize, half_width: f32) -> Option<Self> {
        let across = corners.map(|corner| corner[1 - axis]);
        let [low, high] = range(across);
        // A neighbor that shares only the border of the strip is beside it.
        if low > half_width - TOLERANCE || high < TOLERANCE - half_width {
            return None;
        }
        // The center tells the side: neighbors may overlap by a rounding error.
        let is_above = corners.iter().map(|corner| corner[axis]).sum::<f32>() > 0.0;
        let sign = if is_above { 1.0 } else { -1.0 };
        let corners = corners.map(|corner| [sign * corner[axis], corner[1 - axis]]);
        let ends = [low.max(-half_width), high.min(half_width)];
        let at_ends = ends.map(|end| near_edge(&corners, end));
        let inside = corners.iter().filter(|it| it[1].abs() <= half_width);
        let nearest = inside.map(|it| it[0]).fold(f32::INFINITY, f32::min);
        let [narrow, wide] = range(at_ends);
        Some(Self {
            is_above,
            edge: [narrow.min(nearest), wide],
        })
    }
}

/// Returns the smallest coordinate along an axis that a quadrilateral has at a coordinate across it. Corners are `[along, across]`.
fn near_edge(corners: &[[f32; 2]; 4], across: f32) -> f32 {
    let mut nearest = f32::INFINITY;
    for (index, &start) in corners.iter().enumerate() {
        let end = corners[(index + 1) % 4];
        let [low, high] = range([start[1], end[1]]);
        if across < low - TOLERANCE || across > high + TOLERANCE {
            continue;
        }
        let met = if high - low < TOLERANCE {
            start[0].min(end[0])
        } else {
            let t = ((across - start[1]) / (end[1] - start[1])).clamp(0.0, 1.0);
            start[0] + (end[0] - start[0]) * t
        };
        nearest = nearest.min(met);
    }
    nearest
}

/// Returns the smallest and the largest value.
fn range<const N: usize>(values: [f32; N]) -> [f32; 2] {
    let low = values.iter().copied().fold(f32::INFINITY, f32::min);
    let high = values.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    [low, high]
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
    fn a_key_reaches_a_turned_neighbor_but_not_into_it() {
        let turned = Outline {
            rotation: std::f32::consts::FRAC_PI_4,
            ..key(24.0, 0.0, HALF)
        };
        let gap = 24.0 - 8.5 * std::f32::consts::SQRT_2 - 8.5;
        let found = share(&[key(0.0, 0.0, HALF), turned]);
        assert!((found[1] - gap).abs() < 0.01, "{found:?}");
        assert_eq!([found[0], found[2], found[3]], [8.5; 3]);
    }

    #[test]
    fn the_shares_of_keys_on_an_arc_cover_the_gaps_between_them() {
        const RADIUS: f32 = 0.32;
        let on_arc = |radius: f32, angle: f32| {
            let direction = Vec2::from_angle(angle);
            Outline {
                center: Vec2::new(direction.y, direction.x) * radius,
                rotation: -angle,
                ..key(0.0, 0.0, HALF)
            }
        };
        let rows = [(RADIUS, 0.0), (RADIUS - 0.019, 0.5)];
        let keys: Vec<Outline> = rows
            .into_iter()
            .flat_map(|(radius, shift)| {
                (-4..=4).map(move |column| (radius, (column as f32 + shift) * 0.019 / radius))
            })
            .map(|(radius, angle)| on_arc(radius, angle))
            .collect();
        let neighbors = Neighborhood::new(&keys);
        let is_covered = |point: Vec2| {
            (0..keys.len()).any(|index| {
                let Share { low, high } = neighbors.share(index, 0.5, 1.0);
                let half = keys[index].half_extents();
                let local =
                    Vec2::from_angle(-keys[index].rotation).rotate(point - keys[index].center);
                local.cmple(half + high).all() && local.cmpge(-half - low).all()
            })
        };
        for step in 0..400 {
            let angle = (step as f32 / 400.0 - 0.5) * 0.3;
            for radius in [-17.0, -9.5, -8.5, -1.0, 0.0, 5.0, 8.5] {
                let direction = Vec2::from_angle(angle);
                let point = Vec2::new(direction.y, direction.x) * (RADIUS + radius * 1e-3);
                assert!(is_covered(point), "{point}");
            }
        }
    }
}
