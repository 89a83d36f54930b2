//! The intention of a simulated person: the finger for a target, the pace of movements, and the errors of strokes.

use std::time::Duration;

use parry3d::math::{Vec2, Vec3};

use super::noise::gaussian;
use crate::contact::TargetId;
use crate::contact::surface::{Shape, Target};
use crate::device::{KeyAction, KeyCode};
use crate::hand::{Finger, FingerSet, Side};
use crate::layout::{Key, Layout, Motion, Person};

/// Separates the errors of the strokes from the noise of the sensors with the same seed.
const STROKES: u64 = 0x5712_0ce5;

/// The keys of a layout by which the fingers of a typist find theirs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TypingKeys {
    /// The keys that write a space, which a thumb presses.
    pub space: Vec<TargetId>,
    /// The keys F and J, above which the index fingers rest.
    pub home: Vec<TargetId>,
}

/// The motor control of a hand: its motion to targets, and the fingers that it uses.
#[derive(Clone, Debug)]
pub(super) struct Motor {
    motion: Motion,
    /// The fingers that press; empty if the layout decides.
    pub(super) fingers: FingerSet,
    /// The fingers that rest beside the others.
    pub(super) resting: FingerSet,
    /// The keys by which the fingers find theirs.
    pub(super) keys: TypingKeys,
    random: fastrand::Rng,
}

impl Motor {
    /// Creates the motor of the hand of `side`.
    pub(super) fn new(person: &Person, side: Side, keys: &TypingKeys, seed: u64) -> Self {
        let own_seed = (seed ^ STROKES).wrapping_add(side.index() as u64);
        Self {
            motion: person.motion,
            fingers: person.fingers,
            resting: person.resting,
            keys: keys.clone(),
            random: fastrand::Rng::with_seed(own_seed),
        }
    }

    /// Returns the time of a movement that usually takes `time`.
    pub(super) fn paced(&self, time: Duration) -> Duration {
        if self.motion.speed == 1.0 {
            time
        } else {
            time.div_f64(self.motion.speed)
        }
    }

    /// Returns the error of the end point of the next stroke, along the axes of the target in metres.
    pub(super) fn stroke_error(&mut self, finger: Finger, target: &Target) -> Vec3 {
        let size = match target.shape {
            Shape::Box(half) => half * 2.0,
            Shape::Disc(radius) => Vec2::splat(radius * 2.0),
        };
        let deviation = self.motion.scatter.deviation_at(size);
        let mut error = self.motion.offsets[finger.index()].extend(0.0);
        if deviation != Vec3::ZERO {
            let mut sample = || gaussian(&mut self.random) as f32;
            error += deviation * Vec3::new(sample(), sample(), sample());
        }
        error
    }
}

impl TypingKeys {
    /// Finds the keys of a layout.
    pub fn new(layout: &Layout) -> Self {
        let targets = |codes: &[KeyCode]| {
            let is_one = |key: &&Key| match key.actions.first().copied().flatten() {
                Some(KeyAction::Key(code)) => codes.contains(&code),
                _ => false,
            };
            let keys = layout.keys.iter().filter(is_one);
            keys.map(|key| key.face.target).collect()
        };
        let codes = |character| KeyCode::for_us_character(character).map(|(code, _)| code);
        Self {
            space: targets(&codes(' ').collect::<Vec<_>>()),
            home: targets(&codes('f').chain(codes('j')).collect::<Vec<_>>()),
        }
    }
}
