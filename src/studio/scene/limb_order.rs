//! The order in which limbs are drawn: each after those that it covers on the screen.
//!
//! Limbs are drawn as wholes. Where two of them grow together, facets sorted one by one would interleave in teeth.

use parry3d::math::Vec2;

/// A ball of those that fill a limb, on the screen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ball {
    /// The middle, in points.
    pub position: Vec2,
    /// The radius, in points.
    pub radius: f32,
    /// Distance from the eye, in metres.
    pub depth: f32,
}

/// Returns the indices of limbs, those behind others first. Limbs that do not meet on the screen keep their order, and so do
/// limbs of which each is in front of the next in a circle.
pub(super) fn back_to_front(limbs: &[Vec<Ball>]) -> Vec<usize> {
    let mut left: Vec<usize> = (0..limbs.len()).collect();
    let mut order = Vec::with_capacity(limbs.len());
    while !left.is_empty() {
        let covers_none = |&front: &usize| {
            let mut others = left.iter().filter(|&&other| other != front);
            others.all(|&other| !covers(&limbs[front], &limbs[other]))
        };
        let next = left.iter().position(covers_none).unwrap_or(0);
        order.push(left.remove(next));
    }
    order
}

/// Returns `true` if a limb is in front of another one where they meet on the screen.
fn covers(front: &[Ball], back: &[Ball]) -> bool {
    let mut depth = 0.0;
    for near in front {
        for far in back {
            let reach = near.radius + far.radius;
            if near.position.distance_squared(far.position) < reach * reach {
                depth += far.depth - near.depth;
            }
        }
    }
    depth > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a limb from one point to another, whose depths are the third coordinates.
    fn limb(from: [f32; 3], to: [f32; 3]) -> Vec<Ball> {
        let at = |axis: usize, t: f32| from[axis] + (to[axis] - from[axis]) * t;
        let ball = |step: i32| {
            let t = step as f32 / 20.0;
            Ball {
                position: Vec2::new(at(0, t), at(1, t)),
                radius: 1.0,
                depth: at(2, t),
            }
        };
        (0..=20).map(ball).collect()
    }

    #[test]
    fn a_limb_is_drawn_after_those_that_it_covers() {
        let near = limb([0.0, 5.0, 0.3], [10.0, 5.0, 0.3]);
        let far = limb([5.0, 0.0, 0.5], [5.0, 10.0, 0.5]);
        assert_eq!(back_to_front(&[near.clone(), far.clone()]), [1, 0]);
        assert_eq!(back_to_front(&[far, near]), [0, 1]);
    }

    #[test]
    fn only_the_depth_where_limbs_meet_counts() {
        // Nearer in the mean, and behind where it crosses.
        let oblique = limb([0.0, 5.0, 0.9], [100.0, 5.0, 0.1]);
        let other = limb([5.0, 0.0, 0.7], [5.0, 10.0, 0.7]);
        assert_eq!(back_to_front(&[other, oblique]), [1, 0]);
    }

    #[test]
    fn limbs_that_do_not_meet_keep_their_order() {
        let limbs = [0.1, 0.9, 0.5].map(|depth| {
            let x = depth * 100.0;
            limb([x, 0.0, depth], [x, 10.0, depth])
        });
        assert_eq!(back_to_front(&limbs), [0, 1, 2]);
    }

    #[test]
    fn limbs_that_cover_each_other_in_a_circle_are_all_drawn() {
        let limbs = [
            limb([0.0, 0.0, 0.2], [10.0, 0.0, 0.8]),
            limb([10.0, 0.0, 0.2], [5.0, 9.0, 0.8]),
            limb([5.0, 9.0, 0.2], [0.0, 0.0, 0.8]),
        ];
        let mut order = back_to_front(&limbs);
        order.sort_unstable();
        assert_eq!(order, [0, 1, 2]);
    }
}
