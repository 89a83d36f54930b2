//! A simulated person who moves the index fingers to targets and wears flex-sensor gloves.

use std::collections::VecDeque;
use std::time::Duration;

use super::one_hand::{Did, GloveCounts, OneHand};
use super::order::Order;
use super::plan::PlanError;
use super::refusal::Refusal;
use crate::capture::{Capture, CaptureError, Channels, Counts, Reading, Sample, Source};
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

impl TypistError {
    /// The same with the order's place in a longer list, of which `places` were taken.
    fn renumbered(self, places: &[usize]) -> Self {
        match self {
            Self::Refused(refusal) => Self::Refused(Refusal {
                order: places[refusal.order],
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
pub struct Typist {
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
    hand: OneHand,
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
        Self::with_hands(settings, orders, scene, &[(arm, map)])
    }

    /// Plans these orders in `scene` for one or two arms and their gloves. What is there for neither in
    /// particular is done by the first.
    ///
    /// # Panics
    /// Without any hand.
    pub fn with_hands(
        settings: &TypistSettings,
        orders: &[Order],
        scene: &Scene,
        hands: &[(&ArmModel, &ChannelMap)],
    ) -> Result<Self, TypistError> {
        assert!(!hands.is_empty(), "somebody has to play");
        let sides: Vec<Side> = hands.iter().map(|(arm, _)| arm.side()).collect();
        let turns = turns(orders, scene, &sides);
        let worn = |(place, &(arm, map)): (usize, &(&ArmModel, &ChannelMap))| {
            let own = (0..orders.len()).filter(|&order| turns[order] == place);
            let own: Vec<usize> = own.collect();
            let of_hand: Vec<Order> = own.iter().map(|&order| orders[order].clone()).collect();
            let hand = OneHand::new(settings, &of_hand, scene, arm, map);
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
            period: settings.frame_period,
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
        self.next_frame().map(|mut frame| frame.swap_remove(0))
    }

    /// The counts of every glove in the next frame, or `None` when all is played.
    pub fn next_frame(&mut self) -> Option<Vec<GloveCounts>> {
        let is_last = self.turn >= self.turns.len();
        let mut is_over = true;
        for place in 0..self.hands.len() {
            let allowed = match is_last {
                true => usize::MAX,
                false => self.own_orders(place),
            };
            is_over &= self.hands[place].hand.go_on(allowed) == Did::Nothing;
        }
        if is_over && is_last {
            return None;
        }
        let done = |place: usize| self.hands[place].hand.has_done(self.own_orders(place));
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
    pub fn has_done(&self, orders: usize) -> bool {
        let is_done = |place: usize| self.hands[place].hand.has_done(self.own(place, orders));
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
fn turns(orders: &[Order], scene: &Scene, sides: &[Side]) -> Vec<usize> {
    let mut hand = 0;
    let turn = |order: &Order| {
        if let Some(spot) = order.spot() {
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

impl Source for Typist {
    fn next(&mut self) -> Result<Capture, CaptureError> {
        if self.told_next.is_empty()
            && let Some(frame) = self.next_frame()
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
            return Ok(Capture::End);
        };
        self.readings += 1;
        Ok(Capture::Reading(reading))
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
            readings: self.readings,
            ..Counts::default()
        }
    }
}
