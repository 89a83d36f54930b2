//! A simulated person who moves the index fingers to targets and wears flex-sensor gloves.

use std::collections::VecDeque;
use std::time::Duration;

use super::action::HandAction;
use super::action_error::ActionError;
use super::simulated_hand::{GloveCounts, Progress, SimulatedHand};
use super::text_plan::PlanError;
use crate::capture::{CaptureError, Channels, Reading, Sample, Source, SourceEvent, SourceStats};
use crate::contact::surface::Scene;
use crate::estimate::ChannelMap;
use crate::hand::Side;
use crate::kinematics::ArmModel;
use crate::time::Timestamp;

/// Who plays, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct TypistSettings {
    /// What the source is called.
    pub name: String,
    /// The time between two packets of the glove.
    pub packet_period: Duration,
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
    CannotType(#[from] PlanError),
    /// An order cannot be carried out.
    #[error(transparent)]
    Action(#[from] ActionError),
}

impl TypistError {
    /// The same with the order's place in a longer list, of which `places` were taken.
    fn renumbered(self, places: &[usize]) -> Self {
        match self {
            Self::Action(refusal) => Self::Action(ActionError {
                index: places[refusal.index],
                ..refusal
            }),
            other => other,
        }
    }
}

/// A simulated person at the controls, as a [`Source`] of glove readings.
///
/// Every text and every script is played by it: a list of [`Order`]s, carried out one after the other,
/// by one hand or by whichever of two a board is there for. The hands are off all targets for 600 ms at
/// the start and at the end.
pub struct SimulatedTypist {
    name: String,
    /// One or two.
    hands: Vec<Worn>,
    /// For each order the place of the hand that carries it out.
    turns: Vec<usize>,
    /// How many orders may be played so far, the one that is played included.
    turn: usize,
    period: Duration,
    frame: u64,
    readings: u64,
    /// Readings of a frame that are still to be told.
    told_next: VecDeque<Reading>,
}

struct Worn {
    side: Side,
    hand: SimulatedHand,
}

impl SimulatedTypist {
    /// Plans these orders in `scene` for this arm and glove.
    pub fn new(
        settings: &TypistSettings,
        orders: &[HandAction],
        scene: &Scene,
        arm: &ArmModel,
        map: &ChannelMap,
    ) -> Result<Self, TypistError> {
        Self::with_hands(settings, orders, scene, &[(arm, map)])
    }

    /// Plans these orders in `scene` for one or two arms and their gloves. What is there for neither in
    /// particular is done by the first.
    ///
    /// # Panics
    /// Without any hand.
    pub fn with_hands(
        settings: &TypistSettings,
        orders: &[HandAction],
        scene: &Scene,
        hands: &[(&ArmModel, &ChannelMap)],
    ) -> Result<Self, TypistError> {
        assert!(!hands.is_empty(), "somebody has to play");
        let sides: Vec<Side> = hands.iter().map(|(arm, _)| arm.side()).collect();
        let turns = turns(orders, scene, &sides);
        let worn = |(place, &(arm, map)): (usize, &(&ArmModel, &ChannelMap))| {
            let own = (0..orders.len()).filter(|&order| turns[order] == place);
            let own: Vec<usize> = own.collect();
            let of_hand: Vec<HandAction> = own.iter().map(|&order| orders[order].clone()).collect();
            let hand = SimulatedHand::new(settings, &of_hand, scene, arm, map);
            let hand = hand.map_err(|error| error.renumbered(&own))?;
            Ok(Worn {
                side: arm.side(),
                hand,
            })
        };
        Ok(Self {
            name: settings.name.clone(),
            hands: hands
                .iter()
                .enumerate()
                .map(worn)
                .collect::<Result<_, TypistError>>()?,
            turns,
            turn: 1,
            period: settings.packet_period,
            frame: 0,
            readings: 0,
            told_next: VecDeque::new(),
        })
    }

    /// How many hands play.
    pub fn hands(&self) -> usize {
        self.hands.len()
    }

    /// The counts of the first glove in the next frame, or `None` when all is played.
    pub fn next_counts(&mut self) -> Option<GloveCounts> {
        self.next_packets().map(|mut frame| frame.swap_remove(0))
    }

    /// The counts of every glove in the next frame, or `None` when all is played.
    pub fn next_packets(&mut self) -> Option<Vec<GloveCounts>> {
        let is_last = self.turn >= self.turns.len();
        let mut is_over = true;
        for place in 0..self.hands.len() {
            let allowed = match is_last {
                true => usize::MAX,
                false => self.own_orders(place),
            };
            is_over &= self.hands[place].hand.advance(allowed) == Progress::Finished;
        }
        if is_over && is_last {
            return None;
        }
        let done = |place: usize| self.hands[place].hand.has_finished(self.own_orders(place));
        if !is_last && (0..self.hands.len()).all(done) {
            self.turn += 1;
        }
        self.frame += 1;
        Some(
            self.hands
                .iter_mut()
                .map(|worn| worn.hand.counts())
                .collect(),
        )
    }

    /// Whether the first `orders` orders are carried out and no hand is on its way; of 0 orders that is so
    /// before the first frame.
    pub fn has_finished(&self, orders: usize) -> bool {
        let is_done = |place: usize| self.hands[place].hand.has_finished(self.own(place, orders));
        (0..self.hands.len()).all(is_done)
    }

    /// How many of the orders that may be played so far are those of one hand.
    fn own_orders(&self, place: usize) -> usize {
        self.own(place, self.turn)
    }

    /// How many of the first `orders` orders are those of one hand.
    fn own(&self, place: usize, orders: usize) -> usize {
        let first = self.turns.iter().take(orders);
        first.filter(|&&hand| hand == place).count()
    }
}

/// The hand that carries out each order: that for which the board of its target is there, else the first;
/// an order without a target is for the hand of the one before.
fn turns(orders: &[HandAction], scene: &Scene, sides: &[Side]) -> Vec<usize> {
    let mut hand = 0;
    let turn = |order: &HandAction| {
        if let Some(spot) = order.target_point() {
            let side = scene
                .target(spot.target)
                .and_then(|(surface, _)| surface.side());
            let found = side.and_then(|side| sides.iter().position(|other| *other == side));
            hand = found.unwrap_or(0);
        }
        hand
    };
    orders.iter().map(turn).collect()
}

impl Source for SimulatedTypist {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        if self.told_next.is_empty()
            && let Some(frame) = self.next_packets()
        {
            let time = Timestamp(0) + self.period.mul_f64(self.frame as f64);
            let is_one = self.hands.len() == 1;
            for (worn, counts) in self.hands.iter().zip(frame) {
                let full_scale = worn.hand.full_scale();
                self.told_next.push_back(Reading {
                    time,
                    side: (!is_one).then_some(worn.side),
                    sample: Sample::Channels(Channels { full_scale, counts }),
                });
            }
        }
        let Some(reading) = self.told_next.pop_front() else {
            return Ok(SourceEvent::End);
        };
        self.readings += 1;
        Ok(SourceEvent::Reading(reading))
    }

    fn name(&self) -> &str {
        &self.name
    }

    fn packet_period(&self) -> Option<Duration> {
        Some(self.period)
    }

    fn is_live(&self) -> bool {
        false
    }

    fn stats(&self) -> SourceStats {
        SourceStats {
            readings: self.readings,
            ..SourceStats::default()
        }
    }
}
