//! A simulated person who types a text with the index finger and wears a flex-sensor glove.

use std::time::Duration;

use arrayvec::ArrayVec;
use parry3d::math::Vec3;

use super::plan::{PlanError, Tap};
use super::typing_hand::{KeyStroke, TypingHand};
use crate::capture::{
    Capture, CaptureError, Channels, Counts, MAX_CHANNELS, Reading, Sample, Source,
};
use crate::contact::TargetId;
use crate::contact::surface::Scene;
use crate::estimate::ChannelMap;
use crate::kinematics::{ArmModel, MAX_CONTROLS};
use crate::time::Timestamp;

/// The hand is shown off all keys for so long at the start, and again at the end.
const SHOW: Duration = Duration::from_millis(600);

/// Who types, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct TypistSettings {
    /// What the source is called.
    pub name: String,
    /// The time between two packets of the glove.
    pub frame_period: Duration,
    /// Standard deviation of the noise on every channel, in counts; 0 for none.
    pub noise_counts: f64,
    /// Where the noise starts.
    pub seed: u64,
}

/// Why the simulated person cannot type.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TypistError {
    /// The text does not go with the layout.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// A key is too far away.
    #[error("target {} is {:.0} mm out of reach of the simulated hand", .key.0, .metres * 1e3)]
    OutOfReach {
        /// The key's target.
        key: TargetId,
        /// How far the fingertip stays away, in metres.
        metres: f64,
    },
}

/// A simulated person at the keyboard, as a [`Source`] of glove readings.
pub struct Typist {
    name: String,
    map: ChannelMap,
    hand: TypingHand,
    values: ArrayVec<f64, MAX_CONTROLS>,
    moves: Vec<Move>,
    period: Duration,
    noise_counts: f64,
    random: fastrand::Rng,
    current: usize,
    frame_of_move: u32,
    frame: u64,
}

/// A minimum-jerk movement of the fingertip, or a rest where both ends are the same.
#[derive(Clone, Copy, Debug)]
struct Move {
    from: Vec3,
    to: Vec3,
    frames: u32,
}

impl Typist {
    /// Plans these taps of keys in `scene` for this arm and glove.
    pub fn new(
        settings: &TypistSettings,
        taps: &[Tap],
        scene: &Scene,
        arm: &ArmModel,
        map: &ChannelMap,
    ) -> Result<Self, TypistError> {
        let hand = TypingHand::new(arm, map);
        let mut typist = Self {
            name: settings.name.clone(),
            map: map.clone(),
            values: hand.rest(),
            hand,
            moves: Vec::new(),
            period: settings.frame_period,
            noise_counts: settings.noise_counts,
            random: fastrand::Rng::with_seed(settings.seed),
            current: 0,
            frame_of_move: 0,
            frame: 0,
        };
        typist.plan(scene, taps)?;
        Ok(typist)
    }

    /// The counts of the glove in the next frame, or `None` when all is typed.
    pub fn next_counts(&mut self) -> Option<ArrayVec<u16, MAX_CHANNELS>> {
        let step = *self.moves.get(self.current)?;
        self.frame_of_move += 1;
        let share = self.frame_of_move as f32 / step.frames as f32;
        if self.frame_of_move == step.frames {
            self.current += 1;
            self.frame_of_move = 0;
        }
        self.frame += 1;
        let tip = step.from.lerp(step.to, minimum_jerk(share));
        self.values = self.hand.reach(tip, &self.values).values;
        Some(self.counts())
    }

    /// What the glove's converters make of the posture.
    fn counts(&mut self) -> ArrayVec<u16, MAX_CHANNELS> {
        let angles = self.hand.angles(&self.values);
        let full_scale = self.map.full_scale();
        // A channel that nothing is wired to floats; half way keeps it out of the headers' way.
        let mut counts: ArrayVec<u16, MAX_CHANNELS> =
            (0..MAX_CHANNELS).map(|_| full_scale / 2).collect();
        for place in (0..self.map.rows().len()).rev() {
            let row = &self.map.rows()[place];
            let (channel, exact) = (row.channel, row.line.reading(angles.get(row.dof)));
            counts[channel] = self.convert(exact, full_scale);
        }
        counts
    }

    /// A converter: noise, rounding, and never quite the end of the range, which means a broken wire.
    fn convert(&mut self, exact: f64, full_scale: u16) -> u16 {
        let noise = match self.noise_counts > 0.0 {
            true => self.noise_counts * gaussian(&mut self.random),
            false => 0.0,
        };
        (exact + noise)
            .round()
            .clamp(1.0, f64::from(full_scale - 1)) as u16
    }

    fn plan(&mut self, scene: &Scene, taps: &[Tap]) -> Result<(), TypistError> {
        let mut place: Option<Vec3> = None;
        for tap in taps {
            let key = tap.target;
            let stroke = self.hand.stroke(scene, key);
            let KeyStroke { hover, bottom } =
                stroke.map_err(|metres| TypistError::OutOfReach { key, metres })?;
            match place {
                None => self.rest(hover, SHOW),
                Some(from) => self.go(from, hover, travel_time(from.distance(hover)), 5),
            }
            self.go(hover, bottom, Duration::from_millis(70), 3);
            self.rest(bottom, Duration::from_millis(70).max(3 * self.period));
            self.go(bottom, hover, Duration::from_millis(70), 3);
            place = Some(hover);
        }
        if let Some(place) = place {
            self.rest(place, SHOW);
        }
        Ok(())
    }

    /// A movement that takes `time`, and at least `fewest` frames, so that a slow line shows it.
    fn go(&mut self, from: Vec3, to: Vec3, time: Duration, fewest: u32) {
        let frames = (time.as_secs_f64() / self.period.as_secs_f64()).ceil() as u32;
        self.moves.push(Move {
            from,
            to,
            frames: frames.max(fewest),
        });
    }

    fn rest(&mut self, place: Vec3, time: Duration) {
        self.go(place, place, time, 1);
    }
}

impl Source for Typist {
    fn next(&mut self) -> Result<Capture, CaptureError> {
        let time = Timestamp(0) + self.period.mul_f64((self.frame + 1) as f64);
        let Some(counts) = self.next_counts() else {
            return Ok(Capture::End);
        };
        let sample = Sample::Channels(Channels {
            full_scale: self.map.full_scale(),
            counts,
        });
        Ok(Capture::Reading(Reading {
            time,
            side: None,
            sample,
        }))
    }

    fn name(&self) -> &str {
        &self.name
    }

    fn frame_period(&self) -> Option<Duration> {
        Some(self.period)
    }

    fn is_live(&self) -> bool {
        false
    }

    fn counts(&self) -> Counts {
        Counts {
            readings: self.frame,
            ..Counts::default()
        }
    }
}

/// x = 10 s³ − 15 s⁴ + 6 s⁵ (Flash & Hogan 1985).
fn minimum_jerk(share: f32) -> f32 {
    share.powi(3) * (10.0 + share * (-15.0 + 6.0 * share))
}

/// MT = a + b log₂(A/W + 1) with a = 60 ms, b = 85 ms, the middle of the published ranges for
/// fingertip taps, and W the width of a key, 19 mm.
fn travel_time(distance: f32) -> Duration {
    let difficulty = (f64::from(distance) / 0.019 + 1.0).log2();
    Duration::from_secs_f64(0.060 + 0.085 * difficulty)
}

/// Standard normal, by Box and Muller.
fn gaussian(random: &mut fastrand::Rng) -> f64 {
    let radius = (-2.0 * (1.0 - random.f64()).ln()).sqrt();
    radius * (std::f64::consts::TAU * random.f64()).cos()
}
