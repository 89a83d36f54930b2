//! The outline of a key on its board, and whether two of them overlap.

use parry3d::math::Vec2;

use crate::contact::surface::Shape;

/// How deep two outlines may lie in each other before they count as overlapping, in metres: far more
/// than rounding, far less than anybody sees.
const TOLERANCE: f32 = 1e-5;

/// Where a key is in the plane of its board, in the board's frame: metres, +X along the rows to the
/// right, +Y away from the wearer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outline {
    /// The middle.
    pub center: Vec2,
    /// How far it is turned about the middle, in radians, counter-clockwise as seen by the wearer.
    pub rotation: f32,
    /// Half extents or radius.
    pub shape: Shape,
}

impl Outline {
    /// Half extents before the turn; a disc has its radius in both.
    pub fn half_extents(&self) -> Vec2 {
        match self.shape {
            Shape::Box(half) => half,
            Shape::Disc(radius) => Vec2::splat(radius),
        }
    }

    /// Half the width and height of the upright rectangle around it.
    pub fn aabb_half_extents(&self) -> Vec2 {
        match self.shape {
            Shape::Disc(radius) => Vec2::splat(radius),
            Shape::Box(half) => {
                let [right, away] = self.axes();
                right.abs() * half.x + away.abs() * half.y
            }
        }
    }

    /// Whether the two have more than a border in common.
    pub fn overlaps(&self, other: &Self) -> bool {
        let between = other.center - self.center;
        match (self.shape, other.shape) {
            (Shape::Disc(a), Shape::Disc(b)) => between.length() < a + b - TOLERANCE,
            (Shape::Box(half), Shape::Disc(radius)) => {
                disc_reaches_box(self.local(between), half, radius)
            }
            (Shape::Disc(radius), Shape::Box(half)) => {
                disc_reaches_box(other.local(-between), half, radius)
            }
            (Shape::Box(_), Shape::Box(_)) => {
                self.axes().into_iter().chain(other.axes()).all(|axis| {
                    between.dot(axis).abs() < self.along(axis) + other.along(axis) - TOLERANCE
                })
            }
        }
    }

    /// Its own +X and +Y.
    fn axes(&self) -> [Vec2; 2] {
        let right = Vec2::from_angle(self.rotation);
        [right, right.perp()]
    }

    /// Half of how long it is along `axis`.
    fn along(&self, axis: Vec2) -> f32 {
        let [right, away] = self.axes();
        let half = self.half_extents();
        half.x * axis.dot(right).abs() + half.y * axis.dot(away).abs()
    }

    fn local(&self, direction: Vec2) -> Vec2 {
        let [right, away] = self.axes();
        Vec2::new(direction.dot(right), direction.dot(away))
    }
}

/// Whether a disc around `middle` reaches into the box around the origin.
fn disc_reaches_box(middle: Vec2, half: Vec2, radius: f32) -> bool {
    let nearest = middle.clamp(-half, half);
    (middle - nearest).length() < radius - TOLERANCE
}

/// A pair of outlines that overlap, by their places in the list, the later one second; the pair whose
/// second comes first in the list. `None` when all are apart.
pub(super) fn first_overlap(outlines: &[Outline]) -> Option<(usize, usize)> {
    let reaches: Vec<(Vec2, Vec2)> = outlines
        .iter()
        .map(|outline| {
            (
                outline.center - outline.aabb_half_extents(),
                outline.center + outline.aabb_half_extents(),
            )
        })
        .collect();
    let mut by_left: Vec<usize> = (0..outlines.len()).collect();
    by_left.sort_by(|&a, &b| reaches[a].0.x.total_cmp(&reaches[b].0.x));
    let mut found: Option<(usize, usize)> = None;
    for (rank, &a) in by_left.iter().enumerate() {
        let (low, high) = reaches[a];
        let meets = |b: usize| reaches[b].0.y < high.y && low.y < reaches[b].1.y;
        let beside = by_left[rank + 1..].iter().copied();
        for b in beside
            .take_while(|&b| reaches[b].0.x < high.x)
            .filter(|&b| meets(b))
        {
            let pair = (a.min(b), a.max(b));
            let earlier = found.is_none_or(|(first, second)| (pair.1, pair.0) < (second, first));
            if earlier && outlines[a].overlaps(&outlines[b]) {
                found = Some(pair);
            }
        }
    }
    found
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
        for (apart, overlaps) in [(0.02, false), (0.0199, true)] {
            assert_eq!(
                square(0.0, 0.0, 0.0).overlaps(&square(apart, 0.0, 0.0)),
                overlaps
            );
            assert_eq!(disc(0.0, 0.0).overlaps(&disc(0.0, apart)), overlaps);
            assert_eq!(square(0.0, 0.0, 0.0).overlaps(&disc(apart, 0.0)), overlaps);
            assert_eq!(disc(apart, 0.0).overlaps(&square(0.0, 0.0, 0.0)), overlaps);
        }
    }

    #[test]
    fn corners_count_as_they_are() {
        let upright = square(0.0, 0.0, 0.0);
        // The upright rectangles around both overlap, the shapes do not.
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
    fn of_several_overlaps_the_one_that_a_reader_meets_first_is_told() {
        let row = [
            square(0.30, 0.0, 0.0),
            square(0.10, 0.0, 0.0),
            square(0.305, 0.0, 0.0),
            square(0.105, 0.0, 0.0),
        ];
        assert_eq!(first_overlap(&row), Some((0, 2)));
        assert_eq!(first_overlap(&row[..2]), None);
    }
}
