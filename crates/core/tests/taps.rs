//! Taps of a person with scatter, slips and a tracker that loses fingertips: the program may lose little beyond what
//! the nearest key to each intended tap loses.

mod motion;

use ademan_core::contact::surface::{Scene, Shape};
use ademan_core::contact::{ContactTracker, Phase, Presses, TargetId, Touch, Touches};
use ademan_core::device::{
    DeviceInput, DeviceOutput, EventKind, Events, KeyArbiter, TimedCommands, VirtualDevice,
};
use ademan_core::estimate::JointAngles;
use ademan_core::hand::{Finger, FingerSet, Joint, Side};
use ademan_core::kinematics::HandPose;
use ademan_core::layout::Layout;
use ademan_core::time::Timestamp;
use motion::minimum_jerk;
use parry3d::math::{Pose, Vec2, Vec3};

const RADIUS: f32 = 0.006;

/// A person who taps keys with the index finger, in strokes of minimum jerk.
struct Typist {
    /// Standard deviation of the place of a tap along each axis, in metres.
    scatter: f32,
    /// The longest slip sideways under pressure, in metres.
    slip: f32,
    /// The fraction of pictures without the fingertip.
    lost: f32,
    /// Standard deviation of each measured coordinate, in metres.
    noise: f32,
    /// Pictures a second.
    rate: f32,
}

const STEADY: Typist = Typist {
    scatter: 0.0,
    slip: 0.0,
    lost: 0.0,
    noise: 0.0,
    rate: 60.0,
};

/// The errors of a run, as fractions of the taps.
#[derive(Debug)]
struct Errors {
    /// Taps whose place has another nearest key.
    nearest: f32,
    /// Taps that pressed no key, another key, or more than one.
    program: f32,
}

struct Board {
    layout: Layout,
    scene: Scene,
    /// The keys that write letters: target, center and half extents on the board.
    letters: Vec<(TargetId, Vec2, Vec2)>,
    all: Vec<(TargetId, Vec2, Vec2)>,
}

impl Board {
    fn qwerty() -> Self {
        let shipped = Layout::shipped().expect("the shipped layouts are valid");
        let (_, layout) = shipped
            .into_iter()
            .find(|(name, _)| name.ends_with("qwerty-flat"))
            .expect("there is a flat board");
        let all: Vec<(TargetId, Vec2, Vec2)> = layout
            .keys
            .iter()
            .map(|key| {
                let Shape::Box(half) = key.face.outline.shape else {
                    panic!("all keys are boxes");
                };
                (key.face.target, key.face.outline.center, half)
            })
            .collect();
        let is_letter = |target: TargetId| {
            let face = layout.face(target).expect("a key has a face");
            face.name.len() == 1 && face.name.chars().all(char::is_alphabetic)
        };
        let letters: Vec<_> = all.iter().copied().filter(|key| is_letter(key.0)).collect();
        assert_eq!(letters.len(), 26);
        Self {
            scene: layout.scene.clone(),
            layout,
            letters,
            all,
        }
    }

    fn nearest(&self, point: Vec2) -> TargetId {
        let distance = |(_, center, half): &(TargetId, Vec2, Vec2)| {
            ((point - center).abs() - half).max(Vec2::ZERO).length()
        };
        let nearest = self
            .all
            .iter()
            .min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.expect("there are keys").0
    }

    /// A pose with the pad of the index finger at a point of the board.
    fn pose(&self, time: Timestamp, pad: Option<Vec3>) -> HandPose {
        let mut pose = HandPose::new(time, Side::Right, RADIUS);
        pose.set(Joint::Elbow, Pose::IDENTITY);
        let surface = &self.scene.surfaces()[0];
        let world_from_board = surface
            .world_from_surface(&pose)
            .expect("the elbow is known");
        if let Some(pad) = pad {
            let center = world_from_board * (pad + Vec3::Z * RADIUS);
            pose.set(Joint::tip(Finger::Index), Pose::from_translation(center));
        }
        pose
    }
}

struct Motion {
    random: fastrand::Rng,
    time: f32,
    at: Vec2,
}

impl Motion {
    fn normal(&mut self) -> f32 {
        motion::normal(&mut self.random)
    }
}

fn type_letters(board: &Board, typist: &Typist, taps: usize, seed: u64) -> Errors {
    let mut motion = Motion {
        random: fastrand::Rng::with_seed(seed),
        time: 0.0,
        at: Vec2::ZERO,
    };
    let mut tracker = ContactTracker::new(&board.scene);
    let mut touches = Touches::new();
    let (mut nearest, mut program) = (0, 0);
    for _ in 0..taps {
        let (target, center, _) = board.letters[motion.random.usize(..board.letters.len())];
        let scatter = Vec2::new(motion.normal(), motion.normal()) * typist.scatter;
        let tap = center + scatter;
        nearest += u32::from(board.nearest(tap) != target);
        let direction = Vec2::from_angle(motion.random.f32() * std::f32::consts::TAU);
        let slip = direction * (typist.slip * motion.random.f32());
        let depth = 0.003 + 0.002 * motion.random.f32();
        let from = std::mem::replace(&mut motion.at, tap + slip);
        let mut pressed = Vec::new();
        // 100 ms to the key, 60 ms down, 60 ms up.
        let start = motion.time;
        while motion.time < start + 0.22 {
            let t = motion.time - start;
            let way = from.lerp(tap, minimum_jerk(t / 0.1));
            let down = minimum_jerk((t - 0.1) / 0.06) - minimum_jerk((t - 0.16) / 0.06);
            // The finger slips from the moment at which it feels the key.
            let slipped = slip * minimum_jerk((t - 0.135) / 0.05);
            let height = 0.012 - (0.012 + depth) * down;
            let noise = Vec3::new(motion.normal(), motion.normal(), motion.normal());
            let pad = (way + slipped).extend(height) + noise * typist.noise;
            let is_lost = motion.random.f32() < typist.lost;
            let time = Timestamp((motion.time * 1e6) as u64 + 1);
            touches.clear();
            tracker.update(
                &board.scene,
                &board.pose(time, (!is_lost).then_some(pad)),
                &mut touches,
            );
            let presses = touches.iter().filter(|touch| touch.phase == Phase::Pressed);
            pressed.extend(presses.map(|touch| touch.target));
            motion.time += 1.0 / typist.rate;
        }
        program += u32::from(pressed != [target]);
    }
    Errors {
        nearest: nearest as f32 / taps as f32,
        program: program as f32 / taps as f32,
    }
}

#[test]
fn taps_lose_no_more_than_the_nearest_key() {
    let board = Board::qwerty();
    for (scatter, slip, rate) in [
        (0.003, 0.0, 175.0),
        (0.003, 0.004, 175.0),
        (0.005, 0.0, 60.0),
        (0.005, 0.004, 60.0),
        (0.008, 0.004, 60.0),
        (0.010, 0.004, 175.0),
    ] {
        let typist = Typist {
            scatter,
            slip,
            rate,
            ..STEADY
        };
        let errors = type_letters(&board, &typist, 4_000, 11);
        println!("{scatter} {slip} {rate}: {errors:?}");
        // With more scatter, taps land further beyond the edge of the board than its keys reach.
        let allowed = if scatter < 0.006 { 0.003 } else { 0.005 };
        assert!(errors.program <= errors.nearest + allowed, "{errors:?}");
    }
}

#[test]
fn a_fingertip_that_a_tracker_loses_for_one_picture_types_on() {
    let board = Board::qwerty();
    // At 30 pictures a second many a tap is seen in one picture only.
    for rate in [60.0, 175.0] {
        let typist = Typist {
            lost: 0.01,
            rate,
            ..STEADY
        };
        let errors = type_letters(&board, &typist, 4_000, 12);
        println!("{rate}: {errors:?}");
        assert!(errors.program <= 0.003, "{rate}: {errors:?}");
    }
}

/// The keys that taps press.
#[derive(Debug, Default)]
struct Counted {
    /// Presses beyond the first one of each tap, as contact reports them.
    repeated: usize,
    /// Key events beyond the first one of each tap.
    inserted: usize,
    /// Taps without a key event.
    missed: usize,
}

/// The keyboards of a board, without a decoder and an output.
struct Keyboards {
    devices: Vec<Box<dyn VirtualDevice>>,
    arbiter: KeyArbiter,
}

impl Keyboards {
    /// Returns the number of keys that the touches of a step press.
    fn presses(&mut self, scene: &Scene, pose: &HandPose, touches: &[Touch]) -> usize {
        let input = DeviceInput {
            scene,
            angles: &JointAngles::default(),
            bends: &Default::default(),
            inputs: &Default::default(),
            pose,
            touches,
            presses: &Presses::new(),
        };
        let mut events = Events::new();
        let mut output = DeviceOutput {
            arbiter: &mut self.arbiter,
            events: &mut events,
            commands: &mut TimedCommands::new(),
        };
        for device in &mut self.devices {
            device.update(&input, &mut output);
        }
        let is_press = |kind: &EventKind| matches!(kind, EventKind::KeyDown(_));
        events.iter().filter(|event| is_press(&event.kind)).count()
    }
}

/// Taps the middle of letters 3 to 7 mm deep, for 40 to 120 ms.
fn tap_letters(board: &Board, typist: &Typist, taps: usize, seed: u64) -> Counted {
    let mut motion = Motion {
        random: fastrand::Rng::with_seed(seed),
        time: 0.0,
        at: Vec2::ZERO,
    };
    let mut keyboards = Keyboards {
        devices: board.layout.devices(),
        arbiter: KeyArbiter::new(board.layout.texts.clone()),
    };
    let mut tracker = ContactTracker::new(&board.scene);
    let mut touches = Touches::new();
    let mut counted = Counted::default();
    for _ in 0..taps {
        let (_, center, _) = board.letters[motion.random.usize(..board.letters.len())];
        let depth = 0.003 + 0.004 * motion.random.f32();
        let dwell = 0.04 + 0.08 * motion.random.f32();
        let from = std::mem::replace(&mut motion.at, center);
        let (mut presses, mut keys) = (0, 0);
        let start = motion.time;
        while motion.time < start + dwell + 0.3 {
            let t = motion.time - start;
            let way = from.lerp(center, minimum_jerk(t / 0.1));
            let down = minimum_jerk((t - 0.1) / 0.08) - minimum_jerk((t - 0.18 - dwell) / 0.08);
            let pad = way.extend(0.015 - (0.015 + depth) * down);
            let noise = Vec3::new(motion.normal(), motion.normal(), motion.normal());
            let time = Timestamp((motion.time * 1e6) as u64 + 1);
            let pose = board.pose(time, Some(pad + noise * typist.noise));
            touches.clear();
            tracker.update(&board.scene, &pose, &mut touches);
            let is_press = |touch: &&Touch| touch.phase == Phase::Pressed;
            presses += touches.iter().filter(is_press).count();
            keys += keyboards.presses(&board.scene, &pose, &touches);
            motion.time += 1.0 / typist.rate;
        }
        counted.repeated += presses.saturating_sub(1);
        counted.inserted += keys.saturating_sub(1);
        counted.missed += usize::from(keys == 0);
    }
    counted
}

#[test]
fn the_noise_of_a_tracker_types_hardly_any_letter_twice_and_misses_hardly_any() {
    let plane = Board::qwerty();
    let mut struck = Board::qwerty();
    for &(target, ..) in &struck.all {
        struck.scene.set_struck(target, FingerSet::ALL);
    }
    // The limits of strokes, inserted and missed: the first reading above the front ends a stroke, so that noise inserts more letters than
    // with the plane; and two points of a tap that are noisy by 2 mm are now and then as far apart as half the pitch, as if the hand passed
    // by.
    for (noise, rate, max_inserted, max_of_strokes) in [
        (0.001, 60.0, 0, [5, 0]),
        (0.001, 175.0, 0, [5, 0]),
        (0.002, 60.0, 10, [30, 10]),
        (0.002, 90.0, 10, [30, 10]),
        (0.002, 175.0, 10, [30, 10]),
    ] {
        let typist = Typist {
            noise,
            rate,
            ..STEADY
        };
        for (press, board, [inserted, missed]) in [
            ("plane", &plane, [max_inserted, 0]),
            ("stroke", &struck, max_of_strokes),
        ] {
            let counted = tap_letters(board, &typist, 2_000, 13);
            let case = format!("{press} {noise} {rate}: {counted:?}");
            println!("{case}");
            assert!(counted.repeated > 0, "contact alone repeats them: {case}");
            assert!(counted.inserted <= inserted, "{case}");
            assert!(counted.missed <= missed, "{case}");
        }
    }
}
