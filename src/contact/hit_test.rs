//! Which targets a fingertip meets: at one moment, and on its way from one frame to the next.

use parry3d::bounding_volume::{Aabb, BoundingVolume};
use parry3d::math::Vec3;

use super::surface::{Surface, Target};
use super::sweep::{Stroke, is_inside, pad};

/// Two fronts that are crossed closer together than this share of a frame's way count as crossed
/// at once; `f32` cannot tell coplanar fronts apart any finer.
const TIE: f32 = 1e-5;

/// Metres behind a front up to which a fingertip counts as in it. A finger is at most about 70 mm
/// long (palmar length of the middle finger, doi 10.5115/acb.23.310); what is further behind did
/// not poke through, and on a board that bends round the hand it may be in front of other targets.
const BEHIND_REACH: f32 = 0.1;

/// How far `pad` (metres, target's frame) is behind the front, more than 0 and at most the travel;
/// `None` in front of it, on it and outside the outline.
///
/// A pad beyond the travel stays at the full travel: poking through does not let go.
pub fn depth(target: &Target, pad: Vec3) -> Option<f32> {
    let is_on = pad.z < 0.0 && is_inside(target.shape, pad.truncate(), 0.0);
    is_on.then(|| (-pad.z).min(target.travel))
}

/// Which pad pushes a target in, and how far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressedBy {
    /// The place of the deepest pad in the list; the lowest on a tie.
    pub pad: usize,
    /// How far the target is pushed in, in metres: more than 0, at most the travel.
    pub depth: f32,
    /// The depth as a share of the travel.
    pub pressure: f32,
}

/// The pad that pushes `target` in the most; `pads` in the surface's frame, in metres.
///
/// Looks at this moment only, so one pad may push several overlapping targets in.
pub fn pressed_by(target: &Target, pads: &[Vec3]) -> Option<PressedBy> {
    let mut deepest: Option<PressedBy> = None;
    for (place, &point) in pads.iter().enumerate() {
        let Some(depth) = depth(target, pad(target, point, 0.0)) else {
            continue;
        };
        if deepest.is_none_or(|other| depth > other.depth) {
            deepest = Some(PressedBy {
                pad: place,
                depth,
                pressure: depth / target.travel,
            });
        }
    }
    deepest
}

/// Where a fingertip comes in through the front of a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The target's place on its surface.
    pub place: u32,
    /// The share of the frame's way at which it happens.
    pub share: f32,
    /// The square of the distance from the middle of the front, in square metres.
    off_centre: f32,
}

impl Crossing {
    /// Whether this one wins against `other`: the earlier, on a tie the one nearer to its middle.
    pub fn beats(&self, other: &Self) -> bool {
        if (self.share - other.share).abs() > TIE {
            return self.share < other.share;
        }
        self.off_centre < other.off_centre
    }
}

/// The first front of `surface` that a fingertip comes in through at or after the share `since`
/// of its way; centres and radius in the surface's frame (metres).
///
/// Does not allocate: parry's iterator keeps its open branches, at most one for each level of the
/// tree, in place up to 32; a tree over 10 000 fronts has half as many levels.
pub fn first_crossing(
    surface: &Surface,
    centres: [Vec3; 2],
    radius: f32,
    since: f32,
) -> Option<Crossing> {
    let mut first: Option<Crossing> = None;
    let reach = Vec3::splat(radius);
    let [from, to] = centres;
    let swept = Aabb::new(from.min(to) - reach, from.max(to) + reach);
    // Most fingers are nowhere near most of the time: a third less than opening the tree.
    if !surface.front_bvh().root_aabb().intersects(&swept) {
        return None;
    }
    for place in surface.front_bvh().intersect_aabb(&swept) {
        let Some(target) = surface.target(surface.target_id(place)) else {
            continue;
        };
        let stroke = Stroke::of(target, centres, radius);
        let Some(share) = stroke.enters(target.shape).filter(|&share| share >= since) else {
            continue;
        };
        let crossing = Crossing {
            place,
            share,
            off_centre: stroke.at(share).truncate().length_squared(),
        };
        if first.is_none_or(|other| crossing.beats(&other)) {
            first = Some(crossing);
        }
    }
    first
}

/// Whether a fingertip is behind the front of any target of `surface`, inside its outline and at
/// most 0.1 m deep; centre and radius in the surface's frame (metres).
pub fn is_in_a_target(surface: &Surface, centre: Vec3, radius: f32) -> bool {
    let reach = Vec3::splat(radius + BEHIND_REACH);
    let near = Aabb::new(centre - reach, centre + reach);
    surface.front_bvh().intersect_aabb(&near).any(|place| {
        surface
            .target(surface.target_id(place))
            .is_some_and(|target| {
                let pad = pad(target, centre, radius);
                pad.z > -BEHIND_REACH && depth(target, pad).is_some()
            })
    })
}

/// Whether the pad of a fingertip may be within `reach` metres of a front of `surface`; centre and radius
/// in the surface's frame (metres). Looks at boxes around the fronts, so it says `true` rather too early.
pub fn is_near_a_target(surface: &Surface, centre: Vec3, radius: f32, reach: f32) -> bool {
    let reach = Vec3::splat(radius + reach);
    let near = Aabb::new(centre - reach, centre + reach);
    surface.front_bvh().root_aabb().intersects(&near)
        && surface.front_bvh().intersect_aabb(&near).next().is_some()
}

#[cfg(test)]
mod tests {
    use std::f32::consts::FRAC_PI_2;

    use parry3d::math::{Pose, Rotation, Vec2};

    use super::*;
    use crate::contact::surface::{Anchor, Scene, Shape, TREMOR_MARGIN};
    use crate::contact::sweep::tests::assert_close;

    const KEY: Shape = Shape::Box(Vec2::new(0.008, 0.006));
    fn target(shape: Shape, surface_from_target: Pose) -> Target {
        Target {
            shape,
            surface_from_target,
            travel: 0.004,
            press_at: 0.5,
            release_at: 0.25,
            margin: TREMOR_MARGIN,
        }
    }

    #[test]
    fn a_turned_target_is_pushed_along_its_own_normal() {
        // The front looks to the wearer (+Y of the surface is away), 0.1 m to the right.
        let pose = Pose::from_parts(
            Vec3::new(0.1, 0.0, 0.0),
            Rotation::from_rotation_x(FRAC_PI_2),
        );
        let turned = target(KEY, pose);
        let centres = [Vec3::new(0.1, -0.02, 0.0), Vec3::new(0.1, 0.0, 0.0)];
        let stroke = Stroke::of(&turned, centres, 0.005);
        assert_close(stroke.enters(KEY), Some(0.75), "along +Y");
        let wide = Vec3::new(0.107, -0.004, 0.0);
        let high = Vec3::new(0.1, -0.004, 0.007);
        assert_close(
            depth(&turned, pad(&turned, wide, 0.005)),
            Some(0.001),
            "wide",
        );
        assert_eq!(depth(&turned, pad(&turned, high, 0.005)), None);
    }

    #[test]
    fn the_first_front_on_the_way_wins_and_on_a_tie_the_nearest_middle() {
        let at = |x: f32, z: f32| target(KEY, Pose::from_translation(Vec3::new(x, 0.0, z) * 1e-3));
        let cross = |targets: Vec<Target>, x: f32| {
            let mut scene = Scene::new();
            scene.add_surface(Anchor::World, Pose::IDENTITY, targets);
            let centres = [
                Vec3::new(x, 0.0, 15.0) * 1e-3,
                Vec3::new(x, 0.0, -5.0) * 1e-3,
            ];
            first_crossing(&scene.surfaces()[0], centres, 0.005, 0.0).map(|found| found.place)
        };
        assert_eq!(cross(vec![at(0.0, 0.0), at(0.0, 2.0)], 0.0), Some(1));
        assert_eq!(cross(vec![at(0.0, 0.0), at(4.0, 0.0)], 3.0), Some(1));
        assert_eq!(cross(vec![at(0.0, 0.0), at(4.0, 0.0)], 1.0), Some(0));
        assert_eq!(cross(vec![at(0.0, 0.0), at(16.0, 0.0)], 8.0), None);
    }

    #[test]
    fn the_tree_finds_what_a_look_at_every_turned_target_finds() {
        let mut state = 7_u64;
        let mut between = |low: f32, high: f32| {
            // Knuth's MMIX generator; its high bits are the good ones.
            state = state.wrapping_mul(6_364_136_223_846_793_005);
            state = state.wrapping_add(1_442_695_040_888_963_407);
            low + (high - low) * (state >> 40) as f32 / (1 << 24) as f32
        };
        let mut place = |reach: f32| {
            let mut along = || between(-reach, reach);
            Vec3::new(along(), along(), along())
        };
        let shapes = [KEY, Shape::Disc(0.01)].into_iter().cycle();
        let targets = shapes.take(400).map(|shape| {
            let pose = Pose::from_parts(place(0.1), Rotation::from_scaled_axis(place(3.0)));
            target(shape, pose)
        });
        let mut scene = Scene::new();
        scene.add_surface(Anchor::World, Pose::IDENTITY, targets.collect());
        let surface = &scene.surfaces()[0];
        let mut found = 0;
        for _ in 0..2_000 {
            let centres = [place(0.12), place(0.12)];
            let mut first: Option<Crossing> = None;
            for (id, target) in surface.targets() {
                let stroke = Stroke::of(target, centres, 0.006);
                let Some(share) = stroke.enters(target.shape) else {
                    continue;
                };
                let crossing = Crossing {
                    place: id.0,
                    share,
                    off_centre: stroke.at(share).truncate().length_squared(),
                };
                if first.is_none_or(|other| crossing.beats(&other)) {
                    first = Some(crossing);
                }
            }
            assert_eq!(first_crossing(surface, centres, 0.006, 0.0), first);
            found += u32::from(first.is_some());
        }
        assert!(found > 500, "only {found}");
    }

    #[test]
    fn the_four_button_pad_comes_out_as_in_the_vectors() {
        let path = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/tests/vectors/keypad_press.json"
        );
        let text = std::fs::read_to_string(path).expect("the vectors are in the repository");
        let file: serde_json::Value = serde_json::from_str(&text).unwrap();
        let number = |value: &serde_json::Value| value.as_f64().unwrap() as f32;
        let mut checked = 0;
        for case in file["cases"].as_array().unwrap() {
            let (half, height) = (number(&case["half_extent"]), number(&case["height"]));
            for sample in case["samples"].as_array().unwrap() {
                // The pad's height above its base is our +Z; the front at rest is at `height`.
                let tips = sample["tips"].as_array().unwrap().iter();
                let tips: Vec<Vec3> = tips
                    .map(|tip| Vec3::new(number(&tip[0]), number(&tip[2]), number(&tip[1])))
                    .collect();
                let rows = sample.get("clamped").unwrap_or(&sample["as_coded"]);
                let rows = rows.as_array().unwrap().iter();
                for (button, row) in case["buttons_xz"].as_array().unwrap().iter().zip(rows) {
                    let middle = Vec3::new(number(&button[0]), number(&button[1]), height);
                    let button = Target {
                        travel: height,
                        ..target(
                            Shape::Box(Vec2::splat(half)),
                            Pose::from_translation(middle),
                        )
                    };
                    let found = pressed_by(&button, &tips);
                    let expected = row[0].as_bool().unwrap().then(|| row[1].as_u64().unwrap());
                    assert_eq!(found.map(|by| by.pad as u64), expected, "{}", case["name"]);
                    let depth = found.map_or(0.0, |by| by.depth);
                    let pressure = found.map_or(0.0, |by| by.pressure);
                    assert!((depth - number(&row[3])).abs() < 1e-6, "{row}: {depth}");
                    assert!(
                        (pressure - number(&row[4])).abs() < 1e-6,
                        "{row}: {pressure}"
                    );
                    checked += 1;
                }
            }
        }
        assert!(checked > 400, "only {checked} rows");
    }
}
