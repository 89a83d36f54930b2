//! Five fingers that move at random over a keyboard, with losses, jumps and invalid numbers: invariants hold.

use std::collections::BTreeMap;

use ademan::contact::{Phase, TargetId, Touch, Touches};
use ademan::device::{EventKind, Events, KeyCode};
use ademan::hand::{Finger, FingerSet, Joint, Side};
use ademan::kinematics::HandPose;
use ademan::time::Timestamp;
use fastrand::Rng;
use parry3d::math::{Pose, Vec3};

use super::between;
use crate::rig::Rig;
use crate::rig::board::{PITCH, world_from_board};
use crate::rig::fingers::TIP_RADIUS;

const BOARD: &str = "q w e r t y u i o p|1 / a s d f g ~h j k l *shift / \
                     z x c v b n m *layer1 shift layer1 / 1 2 3 4 5 6 7 *ctrl 9 q";

const OPTIONS: &str = "q w>shift ^e r%300 t y>layer1 u i>x o p|1 / a s ^d|2 f g ~h j>ctrl k l !shift / \
                       z x c v b n m !layer1 shift layer1 / 1 2 ^3 4>q 5 6%200 7 *ctrl 9 q";

/// The pads of the fingers over the board, in metres. Each moves from goal to goal.
struct RandomFingers {
    pads: [Vec3; Finger::COUNT],
    goals: [Vec3; Finger::COUNT],
}

impl RandomFingers {
    fn new(random: &mut Rng) -> Self {
        let mut fingers = Self {
            pads: [Vec3::ZERO; Finger::COUNT],
            goals: [Vec3::ZERO; Finger::COUNT],
        };
        for finger in 0..Finger::COUNT {
            fingers.pads[finger] = random_position(random);
            fingers.goals[finger] = random_position(random);
        }
        fingers
    }

    fn step(&mut self, random: &mut Rng) {
        for (pad, goal) in self.pads.iter_mut().zip(&mut self.goals) {
            if random.u32(..2) == 0 {
                // Straight up or down, as in typing, or to another position.
                let position = random_position(random);
                let stays = random.u32(..8) != 0;
                *goal = if stays {
                    goal.with_z(position.z)
                } else {
                    position
                };
            }
            let fraction = between(random, 0.3, 1.0) as f32;
            let tremor = |generator: &mut Rng| between(generator, -3e-4, 3e-4) as f32;
            *pad = pad.lerp(*goal, fraction);
            *pad += Vec3::new(tremor(random), tremor(random), tremor(random));
        }
    }
}

fn random_position(random: &mut Rng) -> Vec3 {
    Vec3::new(
        between(random, -1.0, 10.0) as f32 * PITCH,
        between(random, -4.0, 1.0) as f32 * PITCH,
        between(random, -0.012, 0.015) as f32,
    )
}

/// Checks the order of the phases of each finger.
#[derive(Default)]
struct PhaseCheck {
    fingers: [Option<(TargetId, bool)>; Finger::COUNT],
}

impl PhaseCheck {
    fn check(&mut self, touch: &Touch) {
        let state = &mut self.fingers[touch.finger.index()];
        let before = *state;
        let on = |is_pressed: bool| Some((touch.target, is_pressed));
        *state = match touch.phase {
            Phase::Touched if before.is_none() => on(false),
            Phase::Pressed if before == on(false) => on(true),
            Phase::Released if before == on(true) => on(false),
            Phase::Moved if before == on(true) || before == on(false) => before,
            Phase::Left if before == on(false) => None,
            Phase::Cancelled if before == on(true) || before == on(false) => None,
            _ => panic!("{touch:?} when the finger was at {before:?}"),
        };
        assert!((0.0..=1.0).contains(&touch.depth), "{touch:?}");
    }
}

/// Checks that presses and releases of each key alternate (I2), and that earlier keys are released first (I4).
#[derive(Default)]
struct KeyCheck {
    down: Vec<KeyCode>,
    time: Timestamp,
    counts: BTreeMap<KeyCode, u32>,
}

impl KeyCheck {
    fn check(&mut self, events: &Events) {
        let mut old = self.down.clone();
        let mut has_pressed = false;
        for event in events {
            assert!(event.time >= self.time, "time went back in {events:?}");
            self.time = event.time;
            match event.kind {
                EventKind::KeyDown(code) => {
                    assert!(!self.down.contains(&code), "{code} was pressed twice");
                    self.down.push(code);
                    *self.counts.entry(code).or_default() += 1;
                    has_pressed |= !code.is_modifier();
                }
                EventKind::KeyUp(code) => {
                    let index = self.down.iter().position(|other| *other == code);
                    self.down
                        .remove(index.expect("only a pressed key is released"));
                    let is_old = old.contains(&code) && !code.is_modifier();
                    assert!(
                        !(is_old && has_pressed),
                        "{code} was released late: {events:?}"
                    );
                    old.retain(|other| *other != code);
                }
                _ => {}
            }
        }
    }
}

#[test]
fn presses_and_releases_alternate_for_random_fingers() {
    for (seed, board) in (0..8).flat_map(|seed| [(seed, BOARD), (seed, OPTIONS)]) {
        let mut random = Rng::with_seed(seed);
        let mut rig = Rig::with_keys(board);
        let mut fingers = RandomFingers::new(&mut random);
        let (mut phases, mut keys) = (PhaseCheck::default(), KeyCheck::default());
        let mut touches = Touches::new();
        let mut time = 0;
        for _ in 0..10_000 {
            time += random.u64(..70_000);
            fingers.step(&mut random);
            let pose = pose(&fingers, Timestamp(time), &mut random);
            let mut events = Events::new();
            touches.clear();
            if random.u32(..500) == 0 {
                rig.tracker().reset(pose.time, &mut touches);
            }
            if random.u32(..500) == 0 {
                rig.release_all(pose.time, &mut events);
                keys.check(&events);
                assert_eq!(keys.down, []);
                events.clear();
            }
            rig.track(&pose, &mut touches);
            assert!(touches.len() <= 25, "{touches:?}");
            touches.iter().for_each(|touch| phases.check(touch));
            rig.update(&pose, &touches, &mut events);
            keys.check(&events);
        }
        let mut events = Events::new();
        rig.release_all(Timestamp(time), &mut events);
        keys.check(&events);
        assert_eq!(keys.down, [], "seed {seed} on {board}");
        let presses: u32 = keys.counts.values().sum();
        assert!(presses > 1_000, "only {presses} presses");
        assert!(keys.counts.len() > 30, "only {:?}", keys.counts);
    }
}

fn pose(fingers: &RandomFingers, time: Timestamp, random: &mut Rng) -> HandPose {
    let mut pose = HandPose::new(time, Side::Right, TIP_RADIUS);
    pose.jumped = random.u32(..200) == 0;
    for (&finger, pad) in Finger::ALL.iter().zip(fingers.pads) {
        if random.u32(..100) == 0 {
            continue;
        }
        if random.u32(..100) == 0 {
            pose.untrusted = pose.untrusted.union(FingerSet::NONE.with(finger));
        }
        let mut center = world_from_board().transform_point(pad + Vec3::Z * TIP_RADIUS);
        if random.u32(..300) == 0 {
            center.y = f32::NAN;
        }
        pose.set(Joint::tip(finger), Pose::from_translation(center));
    }
    pose
}
