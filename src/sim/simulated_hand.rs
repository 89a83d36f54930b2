//! One hand of the simulated person, in a flex-sensor glove.

use arrayvec::ArrayVec;

use super::action::HandAction;
use super::movement::{Motion, Movement};
use super::planner;
use super::typing_hand::TypingHand;
use super::typist::{TypistError, TypistSettings};
use crate::capture::MAX_CHANNELS;
use crate::contact::surface::Scene;
use crate::estimate::ChannelMap;
use crate::kinematics::ArmModel;

/// What the channels of a glove count.
pub type GloveCounts = ArrayVec<u16, MAX_CHANNELS>;

/// A hand that carries out its own orders, as far as it is its turn.
pub(super) struct SimulatedHand {
    full_scale: u16,
    hand: TypingHand,
    values: Vec<f64>,
    movements: std::vec::IntoIter<Movement>,
    /// Movements up to the end of each order.
    ends: Vec<usize>,
    /// Movements that have begun.
    begun: usize,
    motion: Option<Motion>,
    frame_of_motion: u32,
    noise_counts: f64,
    random: fastrand::Rng,
}

/// What a hand did in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Progress {
    /// It moved, or showed itself.
    Moved,
    /// It has done what it may do so far, and keeps its posture.
    Waiting,
    /// It has done everything.
    Finished,
}

impl SimulatedHand {
    /// Plans these orders in `scene` for this arm and glove.
    pub(super) fn new(
        settings: &TypistSettings,
        orders: &[HandAction],
        scene: &Scene,
        arm: &ArmModel,
        map: &ChannelMap,
    ) -> Result<Self, TypistError> {
        let hand = TypingHand::new(arm, map);
        let plan = planner::plan(orders, hand, scene, settings.packet_period)?;
        Ok(Self {
            full_scale: map.full_scale(),
            hand: plan.hand,
            values: plan.start,
            movements: plan.movements.into_iter(),
            ends: plan.ends,
            begun: 0,
            motion: None,
            frame_of_motion: 0,
            noise_counts: settings.noise_counts,
            random: fastrand::Rng::with_seed(settings.seed),
        })
    }

    /// The largest count of its glove.
    pub(super) fn full_scale(&self) -> u16 {
        self.full_scale
    }

    /// Goes on by a frame, but not beyond its first `orders` orders; all of them let it finish.
    pub(super) fn advance(&mut self, orders: usize) -> Progress {
        if self.motion.is_none() {
            if self.movements.len() == 0 {
                return Progress::Finished;
            }
            let is_last = orders >= self.ends.len();
            // Before the first order there is the show at the start.
            let end = orders
                .checked_sub(1)
                .map_or(1, |last| self.ends[last.min(self.ends.len() - 1)]);
            if !is_last && self.begun >= end {
                return Progress::Waiting;
            }
            self.begin();
        }
        let Some(motion) = &self.motion else {
            return Progress::Finished;
        };
        self.frame_of_motion += 1;
        let share = self.frame_of_motion as f32 / motion.frames() as f32;
        motion.step(share, &self.hand, &mut self.values);
        if self.frame_of_motion == motion.frames() {
            self.motion = None;
            self.frame_of_motion = 0;
        }
        Progress::Moved
    }

    fn begin(&mut self) {
        self.begun += 1;
        let movement = self.movements.next();
        self.motion =
            movement.map(|movement| Motion::begin(movement, &mut self.hand, &self.values));
    }

    /// Whether the first `orders` orders are carried out.
    pub(super) fn has_finished(&self, orders: usize) -> bool {
        let end = orders.checked_sub(1).and_then(|last| self.ends.get(last));
        self.motion.is_none() && end.is_none_or(|&end| self.begun >= end)
    }

    /// What the glove's converters make of the posture.
    pub(super) fn counts(&mut self) -> GloveCounts {
        // A channel that nothing is wired to floats; half way keeps it out of the headers' way.
        let mut counts: GloveCounts = (0..MAX_CHANNELS).map(|_| self.full_scale / 2).collect();
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

/// Standard normal, by Box and Muller.
fn gaussian(random: &mut fastrand::Rng) -> f64 {
    let radius = (-2.0 * (1.0 - random.f64()).ln()).sqrt();
    radius * (std::f64::consts::TAU * random.f64()).cos()
}
