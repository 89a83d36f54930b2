//! Volumes in space that a point can be in: which of them it enters on its way, and how deep it is.

use parry3d::bounding_volume::Aabb;
use parry3d::math::Vec3;
use parry3d::partitioning::{Bvh, BvhBuildStrategy};

/// What a volume looks like about its middle, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum VolumeShape {
    /// A ball of this radius, more than 0.
    Ball(f32),
    /// A box with these half extents along the axes of its space, each more than 0.
    Box(Vec3),
}

/// A volume in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Volume {
    /// Its middle in the frame of its space, in metres.
    pub center: Vec3,
    /// What it looks like.
    pub shape: VolumeShape,
}

impl Volume {
    /// How deep a point is in it: 0 on its surface and outside, 1 in its middle. In a box the nearest
    /// side counts.
    pub fn depth(&self, point: Vec3) -> f32 {
        let from_middle = point - self.center;
        let outward = match self.shape {
            VolumeShape::Ball(radius) => from_middle.length() / radius,
            VolumeShape::Box(half) => (from_middle.abs() / half).max_element(),
        };
        (1.0 - outward).clamp(0.0, 1.0)
    }

    /// From which share of a straight way to which a point is in it, both within 0..=1; the volume is
    /// `margin` metres larger on every side. `None` where the way does not meet it, and where it only
    /// grazes the surface.
    pub fn intersect_segment(&self, way: [Vec3; 2], margin: f32) -> Option<[f32; 2]> {
        let (from, step) = (way[0] - self.center, way[1] - way[0]);
        let [enters, leaves] = match self.shape {
            VolumeShape::Ball(radius) => line_in_ball(from, step, radius + margin),
            VolumeShape::Box(half) => line_in_box(from, step, half + margin),
        }?;
        let (enters, leaves) = (enters.max(0.0), leaves.min(1.0));
        // One point that stays has a way of no length: in it from 0 to 1.
        (enters < leaves).then_some([enters, leaves])
    }

    fn around(&self) -> Aabb {
        let reach = match self.shape {
            VolumeShape::Ball(radius) => Vec3::splat(radius),
            VolumeShape::Box(half) => half,
        };
        Aabb::new(self.center - reach, self.center + reach)
    }
}

/// Where on the line `from + share · step` the ball about the origin begins and ends.
fn line_in_ball(from: Vec3, step: Vec3, radius: f32) -> Option<[f32; 2]> {
    let (a, b) = (step.length_squared(), from.dot(step));
    let c = from.length_squared() - radius * radius;
    if a == 0.0 {
        return (c < 0.0).then_some([f32::NEG_INFINITY, f32::INFINITY]);
    }
    let root = (b * b - a * c).sqrt();
    // Not a number where the line passes it by.
    (root > 0.0).then_some([(-b - root) / a, (-b + root) / a])
}

/// The same for the box about the origin, by slabs (Kay & Kajiya 1986).
fn line_in_box(from: Vec3, step: Vec3, half: Vec3) -> Option<[f32; 2]> {
    let (mut enters, mut leaves) = (f32::NEG_INFINITY, f32::INFINITY);
    for axis in 0..3 {
        if step[axis] == 0.0 {
            if from[axis].abs() >= half[axis] {
                return None;
            }
            continue;
        }
        let sides = [-half[axis], half[axis]].map(|side| (side - from[axis]) / step[axis]);
        enters = enters.max(sides[0].min(sides[1]));
        leaves = leaves.min(sides[0].max(sides[1]));
    }
    (enters < leaves).then_some([enters, leaves])
}

/// Volumes that share a frame.
#[derive(Clone, Debug)]
pub struct VolumeSet {
    volumes: Vec<Volume>,
    tree: Bvh,
}

/// Where a point comes into a volume, or is in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumeEntry {
    /// The place of the volume.
    pub index: usize,
    /// The share of the way.
    pub t: f32,
    /// How far the point is from the middle there, in metres.
    pub center_distance: f32,
}

impl VolumeEntry {
    /// Whether this one wins against `other`: the earlier, on a tie the one nearer to its middle.
    pub fn precedes(&self, other: &Self) -> bool {
        (self.t, self.center_distance) < (other.t, other.center_distance)
    }
}

impl VolumeSet {
    /// Volume `i` is `volumes[i]`.
    pub fn new(volumes: Vec<Volume>) -> Self {
        let boxes: Vec<Aabb> = volumes.iter().map(Volume::around).collect();
        Self {
            tree: Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes),
            volumes,
        }
    }

    /// The volume at a place.
    pub fn get(&self, place: usize) -> Option<&Volume> {
        self.volumes.get(place)
    }

    /// All of them, in order of their places.
    pub fn iter(&self) -> impl Iterator<Item = &Volume> {
        self.volumes.iter()
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.volumes.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.volumes.is_empty()
    }

    /// The first volume that a point is in at or after the share `since` of its straight way, and not
    /// only up to there. Of several that it is in at `since` the one whose middle is nearest.
    ///
    /// Does not allocate, see [`first_crossing`](super::hit_test::first_crossing).
    pub fn first_entry(&self, way: [Vec3; 2], since: f32) -> Option<VolumeEntry> {
        let mut first: Option<VolumeEntry> = None;
        let [from, to] = way;
        let swept = Aabb::new(from.min(to), from.max(to));
        for leaf in self.tree.intersect_aabb(&swept) {
            let place = leaf as usize;
            let Some(volume) = self.volumes.get(place) else {
                continue;
            };
            let Some([enters, leaves]) = volume.intersect_segment(way, 0.0) else {
                continue;
            };
            if leaves <= since && since > 0.0 {
                continue;
            }
            let share = enters.max(since);
            let entry = VolumeEntry {
                index: place,
                t: share,
                center_distance: from.lerp(to, share).distance(volume.center),
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
    fn depth_is_0_on_the_surface_and_1_in_the_middle() {
        for volume in [ball(1.0, 0.5), cube(1.0, 0.5)] {
            let depths = [1.0, 1.25, 1.5, 9.0].map(|x| volume.depth(Vec3::X * x));
            assert_eq!(depths, [1.0, 0.5, 0.0, 0.0]);
        }
    }

    #[test]
    fn a_way_through_a_volume_is_in_it_between_two_shares() {
        let through = [Vec3::ZERO, Vec3::X * 4.0];
        for volume in [ball(1.0, 0.5), cube(1.0, 0.5)] {
            assert_eq!(volume.intersect_segment(through, 0.0), Some([0.125, 0.375]));
            assert_eq!(volume.intersect_segment(through, 0.5), Some([0.0, 0.5]));
            let ends_inside = [Vec3::ZERO, Vec3::X];
            assert_eq!(volume.intersect_segment(ends_inside, 0.0), Some([0.5, 1.0]));
            assert_eq!(
                volume.intersect_segment([Vec3::X; 2], 0.0),
                Some([0.0, 1.0]),
                "stays"
            );
            assert_eq!(volume.intersect_segment([Vec3::ZERO; 2], 0.0), None);
            let beside = through.map(|point| point + Vec3::Y);
            assert_eq!(volume.intersect_segment(beside, 0.0), None);
            let grazing = through.map(|point| point + Vec3::Y * 0.5);
            assert_eq!(volume.intersect_segment(grazing, 0.0), None);
        }
    }

    #[test]
    fn the_first_on_the_way_wins_and_where_they_overlap_the_nearest_middle() {
        let volumes = VolumeSet::new(vec![ball(3.0, 0.5), cube(1.0, 0.5), ball(1.4, 0.5)]);
        let place = |way, since| {
            volumes
                .first_entry(way, since)
                .map(|entry: VolumeEntry| entry.index)
        };
        let through = [Vec3::ZERO, Vec3::X * 4.0];
        assert_eq!(place(through, 0.0), Some(1));
        assert_eq!(place(through, 0.4), Some(2), "the cube is left behind");
        assert_eq!(place(through, 0.6), Some(0));
        assert_eq!(place(through, 0.9), None);
        assert_eq!(place([Vec3::X * 1.1; 2], 0.0), Some(1));
        assert_eq!(place([Vec3::X * 1.3; 2], 0.0), Some(2));
    }

    #[test]
    fn the_tree_over_many_volumes_stays_shallow_and_finds_what_a_look_at_each_finds() {
        let place = |number: usize| {
            let (layer, rest) = (number / 625, number % 625);
            Vec3::new((rest % 25) as f32, (rest / 25) as f32, layer as f32)
        };
        let volume = |number| Volume {
            center: place(number),
            shape: match number % 2 {
                0 => VolumeShape::Ball(0.6),
                _ => VolumeShape::Box(Vec3::splat(0.4)),
            },
        };
        let volumes = VolumeSet::new((0..10_000).map(volume).collect());
        let depth = volumes.tree.subtree_depth(0);
        assert!(depth <= 24, "{depth} levels");
        for number in 0..500 {
            let from = place(number * 19) + Vec3::new(0.31, 0.23, 0.47);
            let to = from + Vec3::new(0.9, -1.3, (number % 7) as f32 * 0.3);
            let each = volumes.iter().enumerate().filter_map(|(place, volume)| {
                let [share, _] = volume.intersect_segment([from, to], 0.0)?;
                let off_middle = from.lerp(to, share).distance(volume.center);
                Some(VolumeEntry {
                    index: place,
                    t: share,
                    center_distance: off_middle,
                })
            });
            let first = each.reduce(|one, other| if other.precedes(&one) { other } else { one });
            assert_eq!(volumes.first_entry([from, to], 0.0), first, "{number}");
        }
    }
}
