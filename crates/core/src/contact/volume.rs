//! Volumes in space: the entry of a moving point and its penetration depth.

use parry3d::bounding_volume::Aabb;
use parry3d::math::Vec3;
use parry3d::partitioning::{Bvh, BvhBuildStrategy};

/// The shape of a volume around its center, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum VolumeShape {
    /// A ball with this radius, more than 0.
    Ball(f32),
    /// A box with these half extents along the axes of its frame, each more than 0.
    Box(Vec3),
}

/// A volume in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Volume {
    /// The center, in metres.
    pub center: Vec3,
    /// The shape.
    pub shape: VolumeShape,
}

impl Volume {
    /// Returns the penetration depth of a point: 0 on the surface and outside, 1 at the center. In a box the distance
    /// to the nearest side counts.
    pub fn depth(&self, point: Vec3) -> f32 {
        let from_center = point - self.center;
        let outward = match self.shape {
            VolumeShape::Ball(radius) => from_center.length() / radius,
            VolumeShape::Box(half) => (from_center.abs() / half).max_element(),
        };
        (1.0 - outward).clamp(0.0, 1.0)
    }

    /// Returns the interval of `t`, within 0..=1, in which a segment is inside the volume enlarged by `margin` metres on
    /// every side. Returns `None` if the segment is outside or only touches the surface.
    pub fn intersect_segment(&self, segment: [Vec3; 2], margin: f32) -> Option<[f32; 2]> {
        let (origin, direction) = (segment[0] - self.center, segment[1] - segment[0]);
        let [enter, exit] = match self.shape {
            VolumeShape::Ball(radius) => intersect_ball(origin, direction, radius + margin),
            VolumeShape::Box(half) => intersect_box(origin, direction, half + margin),
        }?;
        let (enter, exit) = (enter.max(0.0), exit.min(1.0));
        // A segment without length that is inside has the interval 0..=1.
        (enter < exit).then_some([enter, exit])
    }

    fn aabb(&self) -> Aabb {
        let extent = match self.shape {
            VolumeShape::Ball(radius) => Vec3::splat(radius),
            VolumeShape::Box(half) => half,
        };
        Aabb::new(self.center - extent, self.center + extent)
    }
}

/// Intersects the line `origin + t · direction` with the ball around the origin.
fn intersect_ball(origin: Vec3, direction: Vec3, radius: f32) -> Option<[f32; 2]> {
    let (a, b) = (direction.length_squared(), origin.dot(direction));
    let c = origin.length_squared() - radius * radius;
    if a == 0.0 {
        return (c < 0.0).then_some([f32::NEG_INFINITY, f32::INFINITY]);
    }
    // NaN if the line misses the ball.
    let root = (b * b - a * c).sqrt();
    (root > 0.0).then_some([(-b - root) / a, (-b + root) / a])
}

/// Intersects the line with the box around the origin, by slabs (Kay & Kajiya 1986).
fn intersect_box(origin: Vec3, direction: Vec3, half: Vec3) -> Option<[f32; 2]> {
    let (mut enter, mut exit) = (f32::NEG_INFINITY, f32::INFINITY);
    for axis in 0..3 {
        if direction[axis] == 0.0 {
            if origin[axis].abs() >= half[axis] {
                return None;
            }
            continue;
        }
        let sides = [-half[axis], half[axis]].map(|side| (side - origin[axis]) / direction[axis]);
        enter = enter.max(sides[0].min(sides[1]));
        exit = exit.min(sides[0].max(sides[1]));
    }
    (enter < exit).then_some([enter, exit])
}

/// A set of volumes in one frame, with a search tree.
#[derive(Clone, Debug)]
pub struct VolumeSet {
    volumes: Vec<Volume>,
    bvh: Bvh,
}

/// The point at which a segment enters a volume, or its start if it is inside already.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumeEntry {
    /// The index of the volume.
    pub index: usize,
    /// The position along the segment, 0..=1.
    pub t: f32,
    /// The distance of the point from the center of the volume, in metres.
    pub center_distance: f32,
}

impl VolumeEntry {
    /// Returns `true` if this entry takes precedence over `other`: the earlier one; on a tie, the one nearer to its
    /// center.
    pub fn precedes(&self, other: &Self) -> bool {
        (self.t, self.center_distance) < (other.t, other.center_distance)
    }
}

impl VolumeSet {
    /// Creates a set; the index of a volume is its index in `volumes`.
    pub fn new(volumes: Vec<Volume>) -> Self {
        let boxes: Vec<Aabb> = volumes.iter().map(Volume::aabb).collect();
        Self {
            bvh: Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes),
            volumes,
        }
    }

    /// Returns the volume with this index.
    pub fn get(&self, index: usize) -> Option<&Volume> {
        self.volumes.get(index)
    }

    /// Iterates over the volumes.
    pub fn iter(&self) -> impl Iterator<Item = &Volume> {
        self.volumes.iter()
    }

    /// Returns the number of volumes.
    pub fn len(&self) -> usize {
        self.volumes.len()
    }

    /// Returns `true` if there are no volumes.
    pub fn is_empty(&self) -> bool {
        self.volumes.is_empty()
    }

    /// Returns the first volume that a segment is inside at or after `since` (0..=1). Volumes that it leaves at or before
    /// `since` do not count. If it is inside several at `since`, the one with the nearest center takes precedence.
    ///
    /// Does not allocate: the iterator of parry keeps its open branches, at most one for each level of the tree, inline up
    /// to 32.
    pub fn first_entry(&self, segment: [Vec3; 2], since: f32) -> Option<VolumeEntry> {
        let mut first: Option<VolumeEntry> = None;
        let [from, to] = segment;
        let swept = Aabb::new(from.min(to), from.max(to));
        for leaf in self.bvh.intersect_aabb(&swept) {
            let index = leaf as usize;
            let Some(volume) = self.volumes.get(index) else {
                continue;
            };
            let Some([enter, exit]) = volume.intersect_segment(segment, 0.0) else {
                continue;
            };
            if exit <= since && since > 0.0 {
                continue;
            }
            let t = enter.max(since);
            let entry = VolumeEntry {
                index,
                t,
                center_distance: from.lerp(to, t).distance(volume.center),
            };
            if first.is_none_or(|other| entry.precedes(&other)) {
                first = Some(entry);
            }
        }
        first
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ball(x: f32, radius: f32) -> Volume {
        Volume {
            center: Vec3::X * x,
            shape: VolumeShape::Ball(radius),
        }
    }

    fn cube(x: f32, half: f32) -> Volume {
        Volume {
            center: Vec3::X * x,
            shape: VolumeShape::Box(Vec3::splat(half)),
        }
    }

    #[test]
    fn depth_is_0_on_the_surface_and_1_at_the_center() {
        for volume in [ball(1.0, 0.5), cube(1.0, 0.5)] {
            let depths = [1.0, 1.25, 1.5, 9.0].map(|x| volume.depth(Vec3::X * x));
            assert_eq!(depths, [1.0, 0.5, 0.0, 0.0]);
        }
    }

    #[test]
    fn a_segment_through_a_volume_is_inside_during_an_interval() {
        let through = [Vec3::ZERO, Vec3::X * 4.0];
        for volume in [ball(1.0, 0.5), cube(1.0, 0.5)] {
            let interval = |segment, margin| volume.intersect_segment(segment, margin);
            assert_eq!(interval(through, 0.0), Some([0.125, 0.375]));
            assert_eq!(interval(through, 0.5), Some([0.0, 0.5]));
            assert_eq!(interval([Vec3::ZERO, Vec3::X], 0.0), Some([0.5, 1.0]));
            assert_eq!(interval([Vec3::X; 2], 0.0), Some([0.0, 1.0]), "at rest");
            assert_eq!(interval([Vec3::ZERO; 2], 0.0), None);
            let beside = through.map(|point| point + Vec3::Y);
            assert_eq!(interval(beside, 0.0), None);
            let tangent = through.map(|point| point + Vec3::Y * 0.5);
            assert_eq!(interval(tangent, 0.0), None);
        }
    }

    #[test]
    fn the_first_volume_wins_and_the_nearest_center_where_they_overlap() {
        let volumes = VolumeSet::new(vec![ball(3.0, 0.5), cube(1.0, 0.5), ball(1.4, 0.5)]);
        let index = |segment, since| volumes.first_entry(segment, since).map(|entry| entry.index);
        let through = [Vec3::ZERO, Vec3::X * 4.0];
        assert_eq!(index(through, 0.0), Some(1));
        assert_eq!(index(through, 0.4), Some(2), "the point has left the cube");
        assert_eq!(index(through, 0.6), Some(0));
        assert_eq!(index(through, 0.9), None);
        assert_eq!(index([Vec3::X * 1.1; 2], 0.0), Some(1));
        assert_eq!(index([Vec3::X * 1.3; 2], 0.0), Some(2));
    }

    #[test]
    fn the_tree_of_many_volumes_is_shallow_and_agrees_with_a_linear_search() {
        let center = |number: usize| {
            let (layer, rest) = (number / 625, number % 625);
            Vec3::new((rest % 25) as f32, (rest / 25) as f32, layer as f32)
        };
        let volume = |number| Volume {
            center: center(number),
            shape: match number % 2 {
                0 => VolumeShape::Ball(0.6),
                _ => VolumeShape::Box(Vec3::splat(0.4)),
            },
        };
        let volumes = VolumeSet::new((0..10_000).map(volume).collect());
        let depth = volumes.bvh.subtree_depth(0);
        assert!(depth <= 24, "{depth} levels");
        for number in 0..500 {
            let from = center(number * 19) + Vec3::new(0.31, 0.23, 0.47);
            let to = from + Vec3::new(0.9, -1.3, (number % 7) as f32 * 0.3);
            let entries = volumes.iter().enumerate().filter_map(|(index, candidate)| {
                let [t, _] = candidate.intersect_segment([from, to], 0.0)?;
                let center_distance = from.lerp(to, t).distance(candidate.center);
                Some(VolumeEntry {
                    index,
                    t,
                    center_distance,
                })
            });
            let first = entries.reduce(|one, other| if other.precedes(&one) { other } else { one });
            assert_eq!(volumes.first_entry([from, to], 0.0), first, "{number}");
        }
    }
}
