//! A simulated person who moves the index finger to targets and wears a flex-sensor glove.

use std::time::Duration;

use arrayvec::ArrayVec;

use super::movement::{Motion, Movement};
use super::order::Order;
use super::plan::PlanError;
use super::planner;
use super::refusal::Refusal;
use super::typing_hand::TypingHand;
use crate::capture::{
    Capture, CaptureError, Channels, Counts, MAX_CHANNELS, Reading, Sample, Source,
};
use crate::contact::surface::Scene;
use crate::estimate::ChannelMap;
use crate::kinematics::ArmModel;
use crate::time::Timestamp;

/// Who plays, and how.
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

/// Why the simulated person cannot do what is asked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TypistError {
    /// The text does not go with the layout.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// An order cannot be carried out.
    #[error(transparent)]
    Refused(#[from] Refusal),
}

/// A simulated person at the controls, as a [`Source`] of glove readings.
///
/// Every text and every script is played by it: a list of [`Order`]s, carried out one after the other.
/// The hand is off all targets for 600 ms at the start and at the end.
pub struct Typist {
    name: String,
    full_scale: u16,
    hand: TypingHand,
    values: Vec<f64>,
    movements: std::vec::IntoIter<Movement>,
    motion: Option<Motion>,
    period: Duration,
    noise_counts: f64,
    random: fastrand::Rng,
    frame_of_motion: u32,
    frame: u64,
}

impl Typist {
    /// Plans these orders in `scene` for this arm and glove.
    pub fn new(
        settings: &TypistSettings,
        orders: &[Order],
        scene: &Scene,
        arm: &ArmModel,
        map: &ChannelMap,
    ) -> Result<Self, TypistError> {
        let hand = TypingHand::new(arm, map);
        let plan = planner::plan(orders, hand, scene, settings.frame_period)?;
        Ok(Self {
            name: settings.name.clone(),
            full_scale: map.full_scale(),
            hand: plan.hand,
            values: plan.start,
            movements: plan.movements.into_iter(),
            motion: None,
            period: settings.frame_period,
            noise_counts: settings.noise_counts,
            random: fastrand::Rng::with_seed(settings.seed),
            frame_of_motion: 0,
            frame: 0,
        })
    }

    /// The counts of the glove in the next frame, or `None` when all is played.
    pub fn next_counts(&mut self) -> Option<ArrayVec<u16, MAX_CHANNELS>> {
        if self.motion.is_none() {
            let movement = self.movements.next()?;
            self.motion = Some(Motion::begin(movement, &mut self.hand, &self.values));
        }
        let motion = self.motion.as_ref()?;
        self.frame += 1;
        self.frame_of_motion += 1;
        let share = self.frame_of_motion as f32 / motion.frames() as f32;
        motion.step(share, &self.hand, &mut self.values);
        if self.frame_of_motion == motion.frames() {
            self.motion = None;
            self.frame_of_motion = 0;
        }
        Some(self.counts())
    }

    /// What the glove's converters make of the posture.
    fn counts(&mut self) -> ArrayVec<u16, MAX_CHANNELS> {
        // A channel that nothing is wired to floats; half way keeps it out of the headers' way.
        let mut counts: ArrayVec<u16, MAX_CHANNELS> =
            (0..MAX_CHANNELS).map(|_| self.full_scale / 2).collect();
        for place in 0..self.values.len() {
            counts[self.hand.channels()[place]] = self.convert(self.values[place]);
        }
        counts
    }

    /// A converter: noise, rounding, and never quite the end of the range, which means a broken wire.
    fn convert(&mut self, exact: f64) -> u16 {
        let noise = match self.noise_counts > 0.0 {
            true => self.noise_counts * gaussian(&mut self.random),
            false => 0.0,
        };
        (exact + noise)
            .round()
            .clamp(1.0, f64::from(self.full_scale - 1)) as u16
    }
}

impl Source for Typist {
    fn next(&mut self) -> Result<Capture, CaptureError> {
        let time = Timestamp(0) + self.period.mul_f64((self.frame + 1) as f64);
        let Some(counts) = self.next_counts() else {
            return Ok(Capture::End);
        };
        let sample = Sample::Channels(Channels {
            full_scale: self.full_scale,
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

/// Standard normal, by Box and Muller.
fn gaussian(random: &mut fastrand::Rng) -> f64 {
    let radius = (-2.0 * (1.0 - random.f64()).ln()).sqrt();
    radius * (std::f64::consts::TAU * random.f64()).cos()
}
