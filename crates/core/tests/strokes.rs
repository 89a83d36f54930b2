//! Keys that strokes press: by the way of a fingertip below the plane of the keys, not by the point at which it passes the plane.

mod motion;
mod row;

use ademan_core::contact::surface::Target;
use ademan_core::contact::{Phase, Touch};
use ademan_core::hand::{Finger, FingerSet, Side};
use ademan_core::kinematics::HandPose;
use ademan_core::layout::Layout;
use ademan_core::time::Timestamp;
use motion::{minimum_jerk, normal};
use parry3d::math::Vec3;
use row::{RADIUS, Row, at};

impl Row {
    /// Moves fingers by minimum jerk from points to points in milliseconds.
    fn go(&mut self, ways: &[(Finger, Vec3, Vec3)], milliseconds: u64) {
        let steps = milliseconds * 1_000 / self.period;
        for step in 1..=steps {
            let t = step as f32 / steps as f32;
            let part = minimum_jerk(t);
            let at = |&(finger, from, to): &(Finger, Vec3, Vec3)| (finger, from.lerp(to, part));
            self.show(&ways.iter().map(at).collect::<Vec<_>>(), 0.0);
        }
    }

    /// Goes down to points and up again to above them.
    fn tap(&mut self, ways: &[(Finger, Vec3, Vec3)]) {
        self.go(ways, 60);
        let back = ways
            .iter()
            .map(|&(finger, from, to)| (finger, to, to.truncate().extend(from.z)));
        self.go(&back.collect::<Vec<_>>(), 60);
    }

    fn pressed(&self) -> Vec<(Finger, u32)> {
        let pressed = self
            .touches
            .iter()
            .filter(|touch| touch.phase == Phase::Pressed);
        pressed
            .map(|touch| (touch.finger, touch.target.0))
            .collect()
    }

    fn phases(&self) -> Vec<Phase> {
        let phases = self.touches.iter().map(|touch| touch.phase);
        phases.filter(|phase| *phase != Phase::Moved).collect()
    }
}

#[test]
fn the_way_below_the_plane_counts_and_not_the_point_at_the_plane() {
    // It passes the plane above key 1, 1 mm from the edge, and turns above key 2.
    let way = [(Finger::Index, at(1, 6.0, 15.0), at(2, -8.0, -9.0))];
    for (is_struck, key) in [(true, 2), (false, 1)] {
        let mut row = Row::new(is_struck);
        row.tap(&way);
        assert_eq!(row.pressed(), [(Finger::Index, key)], "{is_struck}");
    }
}

/// The thumb alone.
fn thumb() -> FingerSet {
    FingerSet::NONE.with(Finger::Thumb)
}

#[test]
fn a_thumb_strikes_on_a_board_that_other_fingers_press_by_planes() {
    // It passes the plane above key 1, and turns above key 2.
    for (finger, key) in [(Finger::Thumb, 2), (Finger::Index, 1), (Finger::Little, 1)] {
        let mut row = Row::struck_by(thumb());
        row.tap(&[(finger, at(1, 6.0, 15.0), at(2, -8.0, -9.0))]);
        assert_eq!(row.pressed(), [(finger, key)]);
    }
}

#[test]
fn beside_a_thumb_that_strikes_fingers_press_exactly_as_by_planes() {
    let touches = |struck_by, seed| {
        let mut random = fastrand::Rng::with_seed(seed);
        let mut row = Row::struck_by(struck_by);
        let mut pads = [Vec3::ZERO; Finger::COUNT];
        for (index, pad) in pads.iter_mut().enumerate() {
            *pad = at(index as u32, 0.0, 10.0);
        }
        for _ in 0..200 {
            // Each finger goes to another point, some of them together, between 15 mm above the keys and 8 mm below.
            let ways = Finger::ALL.iter().map(|&finger| {
                let pad = &mut pads[finger.index()];
                let from = *pad;
                if random.bool() {
                    let height = 15.0 - 23.0 * random.f32();
                    *pad = at(random.u32(..5), 20.0 * (random.f32() - 0.5), height);
                }
                (finger, from, *pad)
            });
            let ways: Vec<_> = ways.collect();
            row.go(&ways, 30 + random.u64(..90));
        }
        row.touches
    };
    let of_fingers = |all: &[Touch]| -> Vec<Touch> {
        let fingers = all.iter().filter(|it| it.finger != Finger::Thumb);
        fingers.copied().collect()
    };
    for seed in 0..10 {
        let (planes, strokes) = (touches(FingerSet::NONE, seed), touches(thumb(), seed));
        assert_ne!(planes, strokes, "the thumb strikes");
        let fingers = of_fingers(&planes);
        assert!(fingers.len() > 200, "{}", fingers.len());
        assert_eq!(fingers, of_fingers(&strokes));
    }
}

#[test]
fn a_layout_whose_thumb_strikes_has_the_gaps_of_planes() {
    let targets = |press: &str| -> (Vec<Target>, bool) {
        let text = format!(
            "Layout(name: \"Row\", boards: [(pose: (anchor: elbow), press: {press}, \
             rows: [(at_mm: (0, 0), keys: \"A B C\")])])"
        );
        let layout = Layout::parse(&text, "row.ron").expect("a valid layout");
        let [board] = layout.scene.surfaces() else {
            panic!("one board");
        };
        let targets = board.targets().map(|(_, target)| *target);
        (targets.collect(), board.has_struck_targets())
    };
    let (planes, has_struck_targets) = targets("Plane");
    assert!(!has_struck_targets);
    assert_eq!(targets("ThumbStroke"), (planes.clone(), true));
    assert_ne!(targets("Stroke"), (planes, true));
}

#[test]
fn a_finger_that_slips_under_pressure_presses_the_key_that_it_came_down_on() {
    let mut row = Row::new(true);
    // It slips by 2.5 mm along the board, once it has felt the key.
    for step in 0..=24 {
        let t = step as f32 / 12.0;
        let height = 15.0 - 24.0 * minimum_jerk(1.0 - (t - 1.0).abs());
        let slip = 2.5 * minimum_jerk((t - 0.6) / 0.4);
        row.show(&[(Finger::Index, at(1, 8.0 + slip, height))], 0.0);
    }
    assert_eq!(row.pressed(), [(Finger::Index, 1)]);
}

#[test]
fn a_thumb_that_glides_at_its_lowest_point_presses_the_key_that_it_reaches() {
    let mut row = Row::new(true);
    let (above, lowest, reached) = (at(1, 4.0, 15.0), at(1, 6.0, -9.0), at(2, -5.0, -8.7));
    for (from, to) in [(above, lowest), (lowest, reached)] {
        for step in 1..=8 {
            row.show(&[(Finger::Thumb, from.lerp(to, step as f32 / 8.0))], 0.0);
        }
    }
    row.go(&[(Finger::Thumb, reached, reached)], 60);
    assert_eq!(row.pressed(), [(Finger::Thumb, 2)]);
}

#[test]
fn a_stroke_that_means_one_key_presses_at_the_press_depth() {
    let time = |is_struck| {
        let mut row = Row::new(is_struck);
        row.tap(&[(Finger::Index, at(1, 0.0, 15.0), at(1, 2.0, -8.0))]);
        let phases = [Phase::Touched, Phase::Pressed, Phase::Released, Phase::Left];
        assert_eq!(row.phases(), phases);
        let pressed = row
            .touches
            .iter()
            .find(|touch| touch.phase == Phase::Pressed);
        let released = row
            .touches
            .iter()
            .find(|touch| touch.phase == Phase::Released);
        (pressed.unwrap().time, released.unwrap().time)
    };
    assert_eq!(time(true), time(false));
}

#[test]
fn a_thumb_presses_the_key_at_the_end_of_its_arc() {
    // It goes down above key 1, and is drawn towards key 2 the more, the deeper it is.
    for (finger, key) in [(Finger::Thumb, 2), (Finger::Index, 1)] {
        let mut row = Row::new(true);
        for step in 0..=32 {
            let t = 1.0 - (step as f32 / 16.0 - 1.0).abs();
            let part = minimum_jerk(t);
            let arc = at(1, -4.0 + 16.0 * part * part * part, 15.0 - 27.0 * part);
            row.show(&[(finger, arc)], 0.0);
        }
        assert_eq!(row.pressed(), [(finger, key)]);
    }
}

#[test]
fn neighbors_that_follow_press_nothing_and_a_chord_presses_two() {
    let ways = |second: f32| {
        [
            (Finger::Index, at(1, 0.0, 15.0), at(1, 0.0, -8.0)),
            (Finger::Middle, at(2, 0.0, 4.0), at(2, 0.0, 4.0 - second)),
        ]
    };
    // 9 of 23 mm, and 20 mm.
    for (second, expected) in [(9.0, &[1][..]), (20.0, &[1, 2])] {
        let mut row = Row::new(true);
        row.go(&ways(second), 60);
        // The middle finger stays down longer.
        let [index, middle] = ways(second);
        row.go(
            &[
                (Finger::Index, index.2, index.1),
                (Finger::Middle, middle.2, middle.2),
            ],
            60,
        );
        row.go(&[(Finger::Middle, middle.2, middle.2)], 300);
        row.go(&[(Finger::Middle, middle.2, middle.1)], 60);
        let mut keys: Vec<u32> = row.pressed().into_iter().map(|(_, key)| key).collect();
        keys.sort_unstable();
        assert_eq!(keys, expected, "{second}");
    }
}

#[test]
fn a_chord_is_pressed_at_the_rates_of_cameras() {
    // Near the edges of their keys, so that both wait for their turn.
    let ends = |depth: f32| {
        [
            (Finger::Index, at(1, -8.0, depth)),
            (Finger::Middle, at(3, 8.0, depth)),
        ]
    };
    for period in [33_333, 16_667] {
        for late in (0..30_000).step_by(3_000) {
            let mut row = Row::new(true);
            for step in 0..12 {
                let ms = (step * period + late) as f32 * 1e-3 - 60.0;
                // 50 ms down by 12 mm, and 50 ms up.
                let part = minimum_jerk(1.0 - (ms - 50.0).abs() / 50.0);
                row.time = step * period;
                row.show(&ends(4.0 - 12.0 * part), 0.0);
            }
            let mut keys: Vec<u32> = row.pressed().into_iter().map(|(_, key)| key).collect();
            keys.sort_unstable();
            assert_eq!(keys, [1, 3], "{period} µs, {late} µs late");
        }
    }
}

#[test]
fn a_resting_finger_presses_nothing() {
    let mut row = Row::new(true);
    let (start, deep) = (at(1, 0.0, 2.0), at(1, 0.0, -3.0));
    row.go(&[(Finger::Index, start, deep)], 2_000);
    row.go(&[(Finger::Index, deep, start)], 500);
    assert_eq!(row.pressed(), []);
    // It presses once it taps.
    row.tap(&[(Finger::Index, start, at(1, 0.0, -6.0))]);
    assert_eq!(row.pressed(), [(Finger::Index, 1)]);
}

#[test]
fn a_hand_that_passes_below_the_plane_presses_nothing() {
    let mut row = Row::new(true);
    row.go(&[(Finger::Index, at(0, -5.0, 8.0), at(2, 0.0, -3.0))], 60);
    row.go(&[(Finger::Index, at(2, 0.0, -3.0), at(4, 5.0, 8.0))], 60);
    assert_eq!(row.pressed(), []);
}

#[test]
fn a_stroke_that_does_not_turn_presses_within_70_ms() {
    let mut row = Row::new(true);
    // Towards the edge, at 60 mm a second.
    let way = [(Finger::Index, at(1, 9.0, 6.0), at(1, 9.4, -30.0))];
    row.go(&[(way[0].0, way[0].1, way[0].1)], 20);
    let (from, to) = (way[0].1, way[0].2);
    for step in 1..=120 {
        row.show(&[(Finger::Index, from.lerp(to, step as f32 / 120.0))], 0.0);
    }
    let touched = row
        .touches
        .iter()
        .find(|touch| touch.phase == Phase::Pressed);
    // 8 mm to the press depth take 133 ms.
    let passed = 20_000 + row.period + 8 * 1_000_000 / 60;
    let waited = touched.expect("a press").time.0.saturating_sub(passed);
    assert!((30_000..70_000).contains(&waited), "{waited} µs");
}

#[test]
fn a_finger_that_is_lost_above_the_press_depth_presses_nothing() {
    let mut row = Row::new(true);
    // At the edge, so that it waits for its turn.
    let way = [(Finger::Index, at(1, 9.0, 15.0), at(1, 9.4, -9.0))];
    row.go(&way, 60);
    assert_eq!(row.pressed(), [(Finger::Index, 1)], "it turns");
    let mut straight = Row::new(true);
    for step in 1..=8 {
        straight.show(
            &[(Finger::Index, at(1, 9.4, 15.0 - 2.0 * step as f32))],
            0.0,
        );
    }
    assert!(straight.touches.is_empty(), "{:?}", straight.touches);
    for _ in 0..20 {
        straight.time += straight.period;
        straight.update(&HandPose::new(
            Timestamp(straight.time),
            Side::Right,
            RADIUS,
        ));
    }
    straight.show(&[(Finger::Index, at(1, 0.0, 15.0))], 0.0);
    assert!(straight.touches.is_empty(), "{:?}", straight.touches);
}

#[test]
fn a_hand_that_is_lost_releases_what_a_stroke_pressed() {
    let mut row = Row::new(true);
    row.go(&[(Finger::Index, at(1, 0.0, 15.0), at(1, 0.0, -8.0))], 60);
    assert_eq!(row.pressed().len(), 1);
    for _ in 0..20 {
        row.time += row.period;
        row.update(&HandPose::new(Timestamp(row.time), Side::Right, RADIUS));
    }
    assert_eq!(row.phases().last(), Some(&Phase::Cancelled));
    assert!(row.tracker.is_idle());
}

/// Shares of the bend of a finger (row) by which the others follow it: the upper ends of the bands of Zatsiorsky, Li & Latash (1998)
/// as the lab has them.
const SHARES: [[f32; Finger::COUNT]; Finger::COUNT] = [
    [1.0, 0.05, 0.05, 0.05, 0.05],
    [0.05, 1.0, 0.20, 0.10, 0.07],
    [0.05, 0.15, 1.0, 0.30, 0.12],
    [0.05, 0.08, 0.30, 1.0, 0.40],
    [0.05, 0.07, 0.15, 0.45, 1.0],
];

/// Taps of fingers that rest 1 mm above keys of their own, with neighbors that follow 15 ms later by their shares times a scale.
/// Returns F1 of the presses, and the presses that nobody meant by tap.
fn detection(is_struck: bool, scale: f32, noise: f32) -> (f32, f32) {
    const TAPS: usize = 1_500;
    let mut random = fastrand::Rng::with_seed(5);
    let mut row = Row::new(is_struck);
    let (mut hits, mut phantoms) = (0, 0);
    for _ in 0..TAPS {
        let master = random.usize(..Finger::COUNT);
        let depth = 5.0 + 5.0 * random.f32();
        // 40 ms up by 5 mm, 60 ms down, 30 ms there, 60 ms up to where it rests.
        let height = |ms: f32| {
            let part = |from: f32, time: f32| minimum_jerk((ms - from) / time);
            5.0 * part(0.0, 40.0) - (6.0 + depth) * part(40.0, 60.0)
                + (1.0 + depth) * part(130.0, 60.0)
        };
        row.touches.clear();
        for step in 0..52 {
            let ms = step as f32 * 5.0;
            let pads = Finger::ALL.iter().map(|&finger| {
                let share = if finger.index() == master {
                    height(ms)
                } else {
                    scale * SHARES[master][finger.index()] * height(ms - 15.0)
                };
                let mut shake = || noise * normal(&mut random);
                let shake = Vec3::new(shake(), shake(), shake());
                (finger, at(finger.index() as u32, 0.0, 1.0 + share) + shake)
            });
            let pads: Vec<(Finger, Vec3)> = pads.collect();
            row.show(&pads, 0.0);
        }
        let own = row
            .pressed()
            .iter()
            .filter(|(_, key)| *key as usize == master)
            .count();
        hits += own.min(1);
        phantoms += row.pressed().len() - own.min(1);
    }
    let f1 = 2.0 * hits as f32 / (TAPS + hits + phantoms) as f32;
    (f1, phantoms as f32 / TAPS as f32)
}

#[test]
fn taps_of_resting_hands_are_told_from_fingers_that_follow() {
    for (scale, noise, least) in [(0.3, 1e-4, 0.999), (0.6, 1e-4, 0.995), (1.0, 1e-4, 0.98)] {
        let (plane, stroke) = (
            detection(false, scale, noise),
            detection(true, scale, noise),
        );
        println!(
            "scale {scale}, noise {noise} m: plane {plane:.4?}, stroke {stroke:.4?} (F1, phantom presses by tap)"
        );
        assert!(
            stroke.0 >= least && stroke.0 >= plane.0,
            "{plane:?} {stroke:?}"
        );
    }
}
