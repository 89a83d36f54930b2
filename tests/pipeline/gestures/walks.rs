//! Five fingers wander over a board, with everything that can go wrong; what must hold, holds.

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

/// The fingers' pads over the board (metres); each hurries from place to place.
struct Wanderer {
    pads: [Vec3; Finger::COUNT],
    goals: [Vec3; Finger::COUNT],
}

impl Wanderer {
    fn new(random: &mut Rng) -> Self {
        let mut wanderer = Self {
            pads: [Vec3::ZERO; Finger::COUNT],
            goals: [Vec3::ZERO; Finger::COUNT],
        };
        for finger in 0..Finger::COUNT {
            wanderer.pads[finger] = anywhere(random);
            wanderer.goals[finger] = anywhere(random);
        }
        wanderer
    }

    fn step(&mut self, random: &mut Rng) {
        for (pad, goal) in self.pads.iter_mut().zip(&mut self.goals) {
            if random.u32(..2) == 0 {
                // Straight up or down, as in typing, or off to another place.
                let place = anywhere(random);
                let stays = random.u32(..8) != 0;
                *goal = if stays { goal.with_z(place.z) } else { place };
            }
            let share = between(random, 0.3, 1.0) as f32;
            let tremble = |random: &mut Rng| between(random, -3e-4, 3e-4) as f32;
            *pad = pad.lerp(*goal, share);
            *pad += Vec3::new(tremble(random), tremble(random), tremble(random));
        }
    }
}

fn anywhere(random: &mut Rng) -> Vec3 {
    Vec3::new(
        between(random, -1.0, 10.0) as f32 * PITCH,
        between(random, -4.0, 1.0) as f32 * PITCH,
        between(random, -0.012, 0.015) as f32,
    )
}

/// What a tracker may tell of each finger.
#[derive(Default)]
struct Latches {
    fingers: [Option<(TargetId, bool)>; Finger::COUNT],
}

impl Latches {
    fn take(&mut self, touch: &Touch) {
        let latch = &mut self.fingers[touch.finger.index()];
        let before = *latch;
        let on = |is_pressed: bool| Some((touch.target, is_pressed));
        *latch = match touch.phase {
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

/// Presses and releases alternate for each code (I2); releases of what was down go first (I4).
#[derive(Default)]
struct Held {
    down: Vec<KeyCode>,
    time: Timestamp,
    counts: BTreeMap<KeyCode, u32>,
}

impl Held {
    fn take(&mut self, events: &Events) {
        let mut old = self.down.clone();
        let mut has_pressed = false;
        for event in events {
            assert!(event.time >= self.time, "time went back in {events:?}");
            self.time = event.time;
            match event.kind {
                EventKind::KeyDown(code) => {
                    assert!(!self.down.contains(&code), "{code} down twice");
                    self.down.push(code);
                    *self.counts.entry(code).or_default() += 1;
                    has_pressed |= !code.is_modifier();
                }
                EventKind::KeyUp(code) => {
                    let place = self.down.iter().position(|other| *other == code);
                    self.down.remove(place.expect("only what is down comes up"));
                    let is_old = old.contains(&code) && !code.is_modifier();
                    assert!(!(is_old && has_pressed), "{code} came up late: {events:?}");
                    old.retain(|other| *other != code);
                }
                _ => {}
            }
        }
    }
}

#[test]
fn presses_and_releases_alternate_whatever_the_fingers_do() {
    for (seed, board) in (0..8).flat_map(|seed| [(seed, BOARD), (seed, OPTIONS)]) {
        let mut random = Rng::with_seed(seed);
        let mut rig = Rig::with_keys(board);
        let mut wanderer = Wanderer::new(&mut random);
        let (mut latches, mut held) = (Latches::default(), Held::default());
        let mut touches = Touches::new();
        let mut time = 0;
        for _ in 0..10_000 {
            time += random.u64(..70_000);
            wanderer.step(&mut random);
            let pose = pose(&wanderer, Timestamp(time), &mut random);
            let mut events = Events::new();
            touches.clear();
            if random.u32(..500) == 0 {
                rig.tracker().reset(pose.time, &mut touches);
            }
            if random.u32(..500) == 0 {
                rig.release_all(pose.time, &mut events);
                held.take(&events);
                assert_eq!(held.down, []);
                events.clear();
            }
            rig.track(&pose, &mut touches);
            assert!(touches.len() <= 25, "{touches:?}");
            touches.iter().for_each(|touch| latches.take(touch));
            rig.update(&pose, &touches, &mut events);
            held.take(&events);
        }
        let mut events = Events::new();
        rig.release_all(Timestamp(time), &mut events);
        held.take(&events);
        assert_eq!(held.down, [], "seed {seed} on {board}");
        let presses: u32 = held.counts.values().sum();
        assert!(presses > 1_000, "only {presses} presses");
        assert!(held.counts.len() > 30, "only {:?}", held.counts);
    }
}

fn pose(wanderer: &Wanderer, time: Timestamp, random: &mut Rng) -> HandPose {
    let mut pose = HandPose::new(time, Side::Right, TIP_RADIUS);
    pose.jumped = random.u32(..200) == 0;
    for (&finger, pad) in Finger::ALL.iter().zip(wanderer.pads) {
        if random.u32(..100) == 0 {
            continue;
        }
        if random.u32(..100) == 0 {
            pose.untrusted = pose.untrusted.union(FingerSet::NONE.with(finger));
        }
        let mut centre = world_from_board().transform_point(pad + Vec3::Z * TIP_RADIUS);
        if random.u32(..300) == 0 {
            centre.y = f32::NAN;
        }
        pose.set(Joint::tip(finger), Pose::from_translation(centre));
    }
    pose
}
