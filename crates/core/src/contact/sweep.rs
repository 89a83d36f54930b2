//! The movement of a fingertip relative to one target: geometry in the target's frame.
//!
//! A fingertip is a sphere. Its **pad**, the sphere's furthest point along the press direction
//! (`center − radius · normal`), is the point that touches targets. All tests are about the pad.

use parry3d::math::{Vec2, Vec3};

use super::surface::{Shape, Share, Target};

/// Returns the position of a fingertip's pad in the target's frame; `center` and `radius` (metres) are in the surface's
/// frame.
pub fn pad_position(target: &Target, center: Vec3, radius: f32) -> Vec3 {
    target.surface_from_target.inverse_transform_point(center) - Vec3::Z * radius
}

/// Returns `true` if a point in the plane of the front is inside the outline widened by `margin` metres. Points on the
/// outline are outside: a point on the shared edge of two targets is on neither.
pub fn is_inside(shape: Shape, point: Vec2, margin: f32) -> bool {
    match shape {
        Shape::Box(half) => point.abs().cmplt(half + margin).all(),
        Shape::Disc(radius) => point.length_squared() < (radius + margin) * (radius + margin),
    }
}

/// Returns `true` if a point in the plane of the front is inside the outline widened by the target's share and by `margin`
/// metres.
fn is_inside_share((shape, share): (Shape, Share), point: Vec2, margin: f32) -> bool {
    match shape {
        Shape::Box(half) => {
            point.cmplt(half + share.high + margin).all()
                && point.cmpgt(-(half + share.low + margin)).all()
        }
        Shape::Disc(_) => is_inside(shape, point, share.smallest() + margin),
    }
}

/// Returns the distance of a point in the plane of a front from the outline, in metres; 0 within it.
pub fn distance_from_outline(shape: Shape, point: Vec2) -> f32 {
    match shape {
        Shape::Box(half) => (point.abs() - half).max(Vec2::ZERO).length(),
        Shape::Disc(radius) => (point.length() - radius).max(0.0),
    }
}

/// The straight path of a pad during one step, in the target's frame (metres).
///
/// Positions along it are values of `t`: 0 at `from`, 1 at `to`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sweep {
    /// The position of the pad in the previous pose.
    pub from: Vec3,
    /// The position of the pad in the current pose.
    pub to: Vec3,
}

impl Sweep {
    /// Creates the sweep of a fingertip's pad; both centers and the radius are in the surface's frame.
    pub fn from_centers(target: &Target, centers: [Vec3; 2], radius: f32) -> Self {
        Self {
            from: pad_position(target, centers[0], radius),
            to: pad_position(target, centers[1], radius),
        }
    }

    /// Returns the position at `t`.
    pub fn point_at(&self, t: f32) -> Vec3 {
        self.from.lerp(self.to, t)
    }

    /// Returns the `t` at which the pad enters through the front: from the front side or the plane to behind the plane,
    /// inside the outline widened by the share. Returns `None` if it enters from behind or from the side, or passes the edge.
    pub fn t_at_entry(&self, shape: Shape, share: Share) -> Option<f32> {
        if self.from.z < 0.0 || self.to.z >= 0.0 {
            return None;
        }
        let t = self.from.z / (self.from.z - self.to.z);
        is_inside_share((shape, share), self.point_at(t).truncate(), 0.0).then_some(t)
    }

    /// Returns the `t` at which the pad reaches `depth` metres behind the front on its way in; 0 if it
    /// starts deeper, `None` if it ends less deep.
    pub fn t_at_depth_inward(&self, depth: f32) -> Option<f32> {
        (-self.to.z >= depth).then(|| self.t_at_depth(depth))
    }

    /// Returns the `t` at which the pad reaches `depth` metres behind the front on its way out; 0 if it
    /// starts less deep, `None` if it ends deeper. At depth 0 it leaves through the front.
    pub fn t_at_depth_outward(&self, depth: f32) -> Option<f32> {
        (-self.to.z <= depth).then(|| self.t_at_depth(depth))
    }

    /// Returns the `t` at which the pad leaves the outline, widened by the share and by `margin` metres, sideways; 0 if it was
    /// never inside, `None` if it ends inside.
    pub fn t_at_side_exit(&self, shape: Shape, share: Share, margin: f32) -> Option<f32> {
        let (from, to) = (self.from.truncate(), self.to.truncate());
        if is_inside_share((shape, share), to, margin) {
            return None;
        }
        // With +0 where it does not move: the sign decides which edge is ahead.
        let direction = to - from + Vec2::ZERO;
        let t = match shape {
            Shape::Box(half) => {
                // The edge in the direction of movement; a pad that does not move never reaches it.
                let edge = Vec2::select(
                    direction.cmplt(Vec2::ZERO),
                    -(half + share.low + margin),
                    half + share.high + margin,
                );
                let t_by_axis = (edge - from) / direction;
                t_by_axis.x.min(t_by_axis.y)
            }
            Shape::Disc(radius) => {
                let radius = radius + share.smallest() + margin;
                let (a, b) = (direction.length_squared(), from.dot(direction));
                let c = from.length_squared() - radius * radius;
                ((b * b - a * c).sqrt() - b) / a
            }
        };
        // NaN if the pad neither moves nor was inside.
        Some(if t > 0.0 { t.min(1.0) } else { 0.0 })
    }

    fn t_at_depth(&self, depth: f32) -> f32 {
        let t = (self.from.z + depth) / (self.from.z - self.to.z);
        // NaN if the depth does not change.
        if t > 0.0 { t.min(1.0) } else { 0.0 }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    const KEY: Shape = Shape::Box(Vec2::new(0.008, 0.006));
    const DISC: Shape = Shape::Disc(0.008);

    /// Creates a sweep from positions in millimetres.
    fn sweep(from: [f32; 3], to: [f32; 3]) -> Sweep {
        Sweep {
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
    fn a_sweep_enters_only_through_the_front_inside_the_outline() {
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
                "fast, right through",
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
                "in the corner around a disc",
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
            assert_close(
                sweep(from, to).t_at_entry(shape, Share::NONE),
                expected,
                what,
            );
        }
    }

    #[test]
    fn a_sweep_exits_sideways_where_it_crosses_the_widened_outline() {
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
            let t = sweep(from, to).t_at_side_exit(shape, Share::NONE, 0.002);
            assert_close(t, expected, what);
        }
    }

    #[test]
    fn a_sweep_reaches_each_depth_at_its_t() {
        let down = sweep([0.0, 0.0, 1.0], [0.0, 0.0, -3.0]);
        let up = sweep([0.0, 0.0, -3.0], [0.0, 0.0, 1.0]);
        assert_close(down.t_at_depth_inward(0.002), Some(0.75), "reaches 2 mm");
        assert_close(down.t_at_depth_inward(0.004), None, "does not reach 4 mm");
        assert_close(up.t_at_depth_inward(0.002), None, "ends above 2 mm");
        assert_close(up.t_at_depth_outward(0.001), Some(0.5), "returns to 1 mm");
        assert_close(
            up.t_at_depth_outward(0.0),
            Some(0.75),
            "returns to the front",
        );
        assert_close(down.t_at_depth_outward(0.001), None, "does not return");
        assert_close(up.t_at_depth_outward(0.005), Some(0.0), "starts above 5 mm");
    }
}
