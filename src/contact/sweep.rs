//! How a fingertip moves over one target: pure geometry, in the target's frame.
//!
//! A fingertip is a sphere. What meets a target is its **pad**: the sphere's furthest point along
//! the press direction, `centre − radius · normal`. All tests are about that point.

use parry3d::math::{Vec2, Vec3};

use super::surface::{Shape, Target};

/// The pad of a fingertip in the target's frame; `centre` and `radius` (metres) in the surface's.
pub fn pad(target: &Target, centre: Vec3, radius: f32) -> Vec3 {
    target.surface_from_target.inverse_transform_point(centre) - Vec3::Z * radius
}

/// Whether a point in the plane of the front lies inside the outline made wider by `margin`
/// metres. The outline itself is outside: a point on the shared edge of two targets is on neither.
pub fn is_inside(shape: Shape, point: Vec2, margin: f32) -> bool {
    match shape {
        Shape::Box(half) => point.abs().cmplt(half + margin).all(),
        Shape::Disc(radius) => point.length_squared() < (radius + margin) * (radius + margin),
    }
}

/// The straight way of a pad from one frame to the next, in the target's frame (metres).
///
/// Places on it are shares of the way: 0 at `from`, 1 at `to`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Where the pad was in the frame before.
    pub from: Vec3,
    /// Where it is now.
    pub to: Vec3,
}

impl Stroke {
    /// The way of a fingertip sphere's pad; both centres and the radius in the surface's frame.
    pub fn of(target: &Target, centres: [Vec3; 2], radius: f32) -> Self {
        Self {
            from: pad(target, centres[0], radius),
            to: pad(target, centres[1], radius),
        }
    }

    /// The point at this share of the way.
    pub fn at(&self, share: f32) -> Vec3 {
        self.from.lerp(self.to, share)
    }

    /// The share at which the pad comes in through the front: from in front of the plane (or on
    /// it) to behind it, inside the outline. `None` from behind, from the side and past the edge.
    pub fn enters(&self, shape: Shape) -> Option<f32> {
        if self.from.z < 0.0 || self.to.z >= 0.0 {
            return None;
        }
        let share = self.from.z / (self.from.z - self.to.z);
        is_inside(shape, self.at(share).truncate(), 0.0).then_some(share)
    }

    /// The share at which the pad is `depth` metres behind the front on its way in; 0 if it
    /// started deeper, `None` if it does not end as deep.
    pub fn sinks_to(&self, depth: f32) -> Option<f32> {
        (-self.to.z >= depth).then(|| self.share_at_depth(depth))
    }

    /// The share at which the pad is `depth` metres behind the front on its way out; 0 if it
    /// started less deep, `None` if it ends deeper. It leaves through the front at depth 0.
    pub fn rises_to(&self, depth: f32) -> Option<f32> {
        (-self.to.z <= depth).then(|| self.share_at_depth(depth))
    }

    /// The share at which the pad goes out of the outline sideways, the outline made wider by
    /// `margin` metres; 0 if it was never inside, `None` if it ends inside.
    pub fn leaves_sideways(&self, shape: Shape, margin: f32) -> Option<f32> {
        let (from, to) = (self.from.truncate(), self.to.truncate());
        if is_inside(shape, to, margin) {
            return None;
        }
        let way = to - from;
        let share = match shape {
            Shape::Box(half) => {
                // The edge that the pad moves towards; a pad that keeps its place never gets there.
                let edge = (half + margin).copysign(way);
                let shares = (edge - from) / way;
                shares.x.min(shares.y)
            }
            Shape::Disc(radius) => {
                let reach = radius + margin;
                let (a, b) = (way.length_squared(), from.dot(way));
                let c = from.length_squared() - reach * reach;
                ((b * b - a * c).sqrt() - b) / a
            }
        };
        // Not a number where it neither moves nor was inside.
        Some(if share > 0.0 { share.min(1.0) } else { 0.0 })
    }

    fn share_at_depth(&self, depth: f32) -> f32 {
        let share = (self.from.z + depth) / (self.from.z - self.to.z);
        // Not a number where the pad keeps its depth.
        if share > 0.0 { share.min(1.0) } else { 0.0 }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    const KEY: Shape = Shape::Box(Vec2::new(0.008, 0.006));
    const DISC: Shape = Shape::Disc(0.008);

    /// A stroke in millimetres.
    fn stroke(from: [f32; 3], to: [f32; 3]) -> Stroke {
        Stroke {
            from: Vec3::from_array(from) * 1e-3,
            to: Vec3::from_array(to) * 1e-3,
        }
    }

    pub(in crate::contact) fn assert_close(found: Option<f32>, expected: Option<f32>, what: &str) {
        let is_close = match (found, expected) {
            (Some(found), Some(expected)) => (found - expected).abs() < 1e-5,
            _ => found == expected,
        };
        assert!(is_close, "{what}: {found:?}, expected {expected:?}");
    }

    #[test]
    fn a_stroke_enters_through_the_front_and_inside_the_outline_only() {
        let cases = [
            (
                "straight in",
                KEY,
                [0.0, 0.0, 3.0],
                [0.0, 0.0, -1.0],
                Some(0.75),
            ),
            (
                "from the plane itself",
                KEY,
                [0.0, 0.0, 0.0],
                [0.0, 0.0, -1.0],
                Some(0.0),
            ),
            (
                "stops on the plane",
                KEY,
                [0.0, 0.0, 1.0],
                [0.0, 0.0, 0.0],
                None,
            ),
            (
                "through and through",
                KEY,
                [0.0, 0.0, 30.0],
                [0.0, 0.0, -70.0],
                Some(0.3),
            ),
            ("from behind", KEY, [0.0, 0.0, -3.0], [0.0, 0.0, 1.0], None),
            (
                "from the side, behind",
                KEY,
                [-20.0, 0.0, -1.0],
                [0.0, 0.0, -2.0],
                None,
            ),
            (
                "past the edge",
                KEY,
                [8.5, 0.0, 1.0],
                [0.0, 0.0, -8.0],
                Some(1.0 / 9.0),
            ),
            (
                "past the edge, too late",
                KEY,
                [20.0, 0.0, 1.0],
                [0.0, 0.0, -1.0],
                None,
            ),
            ("on the edge", KEY, [8.0, 0.0, 1.0], [8.0, 0.0, -1.0], None),
            (
                "in the corner",
                KEY,
                [7.9, 5.9, 1.0],
                [7.9, 5.9, -1.0],
                Some(0.5),
            ),
            (
                "in no corner of a disc",
                DISC,
                [7.0, 5.0, 1.0],
                [7.0, 5.0, -1.0],
                None,
            ),
            (
                "in a disc",
                DISC,
                [5.0, 5.0, 1.0],
                [5.0, 5.0, -1.0],
                Some(0.5),
            ),
        ];
        for (what, shape, from, to, expected) in cases {
            assert_close(stroke(from, to).enters(shape), expected, what);
        }
    }

    #[test]
    fn a_stroke_leaves_sideways_where_it_crosses_the_widened_outline() {
        let cases = [
            ("stays", KEY, [0.0, 0.0, -1.0], [7.0, 5.0, -1.0], None),
            (
                "within the margin",
                KEY,
                [0.0, 0.0, -1.0],
                [9.0, 0.0, -1.0],
                None,
            ),
            ("right", KEY, [0.0, 0.0, -1.0], [20.0, 0.0, -1.0], Some(0.5)),
            (
                "left",
                KEY,
                [-5.0, 0.0, -1.0],
                [-15.0, 0.0, -2.0],
                Some(0.5),
            ),
            ("far", KEY, [0.0, 0.0, -1.0], [0.0, 16.0, -1.0], Some(0.5)),
            (
                "corner",
                KEY,
                [0.0, 0.0, -1.0],
                [10.0, 32.0, -1.0],
                Some(0.25),
            ),
            (
                "in and out again",
                KEY,
                [-20.0, 0.0, 1.0],
                [20.0, 0.0, -1.0],
                Some(0.75),
            ),
            (
                "never inside",
                KEY,
                [20.0, 0.0, -1.0],
                [20.0, 0.0, -1.0],
                Some(0.0),
            ),
            (
                "disc",
                DISC,
                [0.0, 0.0, -1.0],
                [12.0, 16.0, -1.0],
                Some(0.5),
            ),
            (
                "disc, stays",
                DISC,
                [0.0, 0.0, -1.0],
                [6.0, 6.0, -1.0],
                None,
            ),
            (
                "disc, in and out",
                DISC,
                [-20.0, 0.0, 1.0],
                [20.0, 0.0, -1.0],
                Some(0.75),
            ),
            (
                "disc, never inside",
                DISC,
                [20.0, 0.0, -1.0],
                [20.0, 5.0, -1.0],
                Some(0.0),
            ),
        ];
        for (what, shape, from, to, expected) in cases {
            let share = stroke(from, to).leaves_sideways(shape, 0.002);
            assert_close(share, expected, what);
        }
    }

    #[test]
    fn a_stroke_reaches_a_depth_at_its_share_of_the_way() {
        let down = stroke([0.0, 0.0, 1.0], [0.0, 0.0, -3.0]);
        let up = stroke([0.0, 0.0, -3.0], [0.0, 0.0, 1.0]);
        assert_close(down.sinks_to(0.002), Some(0.75), "sinks to 2 mm");
        assert_close(down.sinks_to(0.004), None, "does not sink to 4 mm");
        assert_close(up.sinks_to(0.002), None, "does not end at 2 mm");
        assert_close(up.rises_to(0.001), Some(0.5), "rises to 1 mm");
        assert_close(up.rises_to(0.0), Some(0.75), "rises to the front");
        assert_close(down.rises_to(0.001), None, "does not rise");
        assert_close(up.rises_to(0.005), Some(0.0), "has risen before");
    }
}
