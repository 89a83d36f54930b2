//! Taps of a person with scatter, slips and a tracker that loses fingertips: the program may lose little beyond what
//! the nearest key to each intended tap loses.

use ademan_core::contact::surface::{Scene, Shape};
use ademan_core::contact::{ContactTracker, Phase, TargetId, Touches};
use ademan_core::hand::{Finger, Joint, Side};
use ademan_core::kinematics::HandPose;
use ademan_core::layout::Layout;
use ademan_core::time::Timestamp;
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

fn minimum_jerk(t: f32) -> f32 {
    let t = t.clamp(0.0, 1.0);
    t * t * t * (10.0 - 15.0 * t + 6.0 * t * t)
}

struct Board {
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
            scene: layout.scene,
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
        // The sum of twelve even numbers is nearly normal.
        (0..12).map(|_| self.random.f32()).sum::<f32>() - 6.0
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
