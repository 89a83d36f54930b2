//! The search for fronts of a surface near a position: a grid for fronts that are parallel to the surface, parry's bounding
//! volume hierarchy for all others.

use parry3d::bounding_volume::{Aabb, BoundingVolume};
use parry3d::math::{Mat3, Vec3};
use parry3d::partitioning::{Bvh, BvhBuildStrategy};

use super::front_grid::FrontGrid;
use super::target::Target;

/// The padding of the bounding box of a front, in metres on every side.
///
/// It covers the rounding of rotated fronts, some 1e-7 m at arm's length. It also gives the boxes a
/// volume: parry splits a tree by volume, and a tree over boxes without volume is
/// so unbalanced (48 levels for 10 000 fronts instead of 15) that a traversal allocates.
const AABB_PADDING: f32 = 1e-5;

/// An index of the fronts of one surface. Fronts are identified by the index of their target on the surface.
///
/// No search misses a front; a search may also find fronts that are only near, or a front several times. Searches do not allocate:
/// the iterator of parry keeps its open branches, at most one for each level of the tree, inline up to 32; a tree of 10 000 fronts
/// has half as many levels.
#[derive(Clone, Debug)]
pub enum FrontIndex {
    /// Fronts parallel to the surface.
    Grid(FrontGrid),
    /// Fronts in any direction; leaf `i` is the front with index `i`.
    Tree(Bvh),
}

impl FrontIndex {
    /// Creates the index of a surface with these targets.
    pub fn new(targets: &[Target]) -> Self {
        match FrontGrid::new(targets) {
            Some(grid) => Self::Grid(grid),
            None => Self::Tree(tree(targets)),
        }
    }

    /// Returns heights below and above all fronts, in the surface's frame, in metres.
    pub fn heights(&self) -> [f32; 2] {
        match self {
            Self::Grid(grid) => grid.heights(),
            Self::Tree(bvh) => {
                let fronts = bvh.root_aabb();
                [fronts.mins.z, fronts.maxs.z]
            }
        }
    }

    /// Calls `visit` with each front that a fingertip with these centers at the start and end of a step may enter; in the
    /// surface's frame, in metres.
    #[inline]
    pub fn for_each_entered(&self, centers: [Vec3; 2], radius: f32, visit: impl FnMut(u32)) {
        let [from, to] = centers;
        match self {
            Self::Grid(grid) => {
                let to_pad = Vec3::Z * radius;
                grid.for_each_entered(from - to_pad, to - to_pad, visit);
            }
            Self::Tree(bvh) => {
                let extent = Vec3::splat(radius);
                let swept = Aabb::new(from.min(to) - extent, from.max(to) + extent);
                // Most fingers are far from every target most of the time; this test costs a third of a traversal.
                if bvh.root_aabb().intersects(&swept) {
                    bvh.intersect_aabb(&swept).for_each(visit);
                }
            }
        }
    }

    /// Calls `visit` with each front that a fingertip may be behind, at most `depth` metres.
    pub fn for_each_before(&self, center: Vec3, radius: f32, depth: f32, visit: impl FnMut(u32)) {
        match self {
            Self::Grid(grid) => grid.for_each_at(center - Vec3::Z * radius, visit),
            Self::Tree(bvh) => {
                let extent = Vec3::splat(radius + depth);
                let near = Aabb::new(center - extent, center + extent);
                bvh.intersect_aabb(&near).for_each(visit);
            }
        }
    }

    /// Calls `visit` with each front whose bounding box is within `distance` metres of a position along each axis of the
    /// index; in the surface's frame, in metres.
    pub fn for_each_near(&self, position: Vec3, distance: f32, visit: impl FnMut(u32)) {
        match self {
            Self::Grid(grid) => grid.for_each_near(position, distance, visit),
            Self::Tree(bvh) => {
                let extent = Vec3::splat(distance);
                let near = Aabb::new(position - extent, position + extent);
                // A traversal of the tree costs three times as much as the test of its root.
                if bvh.root_aabb().intersects(&near) {
                    bvh.intersect_aabb(&near).for_each(visit);
                }
            }
        }
    }
}

fn tree(targets: &[Target]) -> Bvh {
    let boxes: Vec<Aabb> = targets.iter().map(front_aabb).collect();
    Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes)
}

/// Returns the padded bounding box of a target's front at rest, including its share of the gaps, in the surface's frame.
fn front_aabb(target: &Target) -> Aabb {
    let (shift, half) = target.entrance();
    let axes = Mat3::from_quat(target.surface_from_target.rotation);
    let extent = axes.x_axis.abs() * half.x + axes.y_axis.abs() * half.y + AABB_PADDING;
    let center =
        target.surface_from_target.translation + axes.x_axis * shift.x + axes.y_axis * shift.y;
    Aabb::new(center - extent, center + extent)
}

#[cfg(test)]
mod tests {
    use parry3d::math::{Pose, Rotation, Vec2};

    use super::*;
    use crate::contact::target::{Shape, test_target};

    fn key(surface_from_target: Pose) -> Target {
        test_target(Shape::Box(Vec2::splat(0.008)), surface_from_target)
    }

    fn board(columns: u32, rows: u32) -> Vec<Target> {
        let center = |number| Vec3::new((number % columns) as f32, (number / columns) as f32, 0.0);
        let keys = (0..columns * rows).map(center);
        keys.map(|point| key(Pose::from_translation(point * 0.019)))
            .collect()
    }

    fn is_grid(targets: &[Target]) -> bool {
        matches!(FrontIndex::new(targets), FrontIndex::Grid(_))
    }

    #[test]
    fn a_grid_holds_parallel_fronts_and_a_tree_all_others() {
        for (columns, rows) in [(1, 1), (12, 5), (100, 100), (10_000, 1), (1, 10_000)] {
            assert!(is_grid(&board(columns, rows)), "{columns} × {rows}");
        }
        let turned = |(index, target): (usize, Target)| {
            let rotation = Rotation::from_rotation_z(index as f32);
            key(Pose::from_parts(
                target.surface_from_target.translation,
                rotation,
            ))
        };
        let turned: Vec<Target> = board(12, 5).into_iter().enumerate().map(turned).collect();
        assert!(is_grid(&turned));

        assert!(!is_grid(&[]));
        for rotation in [
            Rotation::from_rotation_x(0.001),
            Rotation::from_rotation_x(std::f32::consts::PI),
        ] {
            let mut tilted = board(12, 5);
            tilted[7].surface_from_target.rotation = rotation;
            assert!(!is_grid(&tilted), "{rotation}");
        }
        let crowded = vec![key(Pose::IDENTITY); 100];
        assert!(!is_grid(&crowded));
        let mut far_apart = board(30, 30);
        far_apart.push(key(Pose::from_translation(Vec3::splat(100.0))));
        assert!(!is_grid(&far_apart), "all keys but one are in one cell");
        let mut invalid = board(12, 5);
        invalid[3].surface_from_target.translation.x = f32::NAN;
        assert!(!is_grid(&invalid));
    }

    #[test]
    fn the_tree_of_a_large_board_is_shallow() {
        for (columns, rows) in [(100, 100), (142, 71), (1000, 10), (10_000, 1)] {
            let depth = tree(&board(columns, rows)).subtree_depth(0);
            assert!(depth <= 24, "{columns} × {rows}: {depth} levels");
        }
    }
}
