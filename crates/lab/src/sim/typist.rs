//! A simulated person with sensors on the hands, who moves the index fingers to targets.

use std::collections::VecDeque;
use std::time::Duration;

use super::action::HandAction;
use super::action_error::ActionError;
use super::sensor::Sensor;
use super::settings::TypistSettings;
use super::simulated_hand::{GloveCounts, Progress, SimulatedHand};
use super::text_plan::PlanError;
use crate::capture::{Reading, Sample};
use crate::contact::surface::Scene;
use crate::estimate::ChannelMap;
use crate::hand::Side;
use crate::kinematics::ArmModel;
use crate::time::Timestamp;

/// Reason why a simulated person cannot play a text or a script.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TypistError {
    /// The layout cannot type the text.
    #[error(transparent)]
    CannotType(#[from] PlanError),
    /// An action cannot be performed.
    #[error(transparent)]
    Action(#[from] ActionError),
}

impl TypistError {
    /// Translates the index of an action to the index in a longer list, from which `indices` were taken.
    fn with_index_in(self, indices: &[usize]) -> Self {
        match self {
            Self::Action(error) => Self::Action(ActionError {
                index: indices[error.index],
                ..error
            }),
            other => other,
        }
    }
}

/// A simulated person with one or two hands in front of a layout.
///
/// Performs a list of [`HandAction`]s one after the other, each with the hand for which the board of its target is
/// made. The hands are clear of all targets for 600 ms at the start and at the end.
#[derive(Clone)]
pub struct SimulatedTypist {
    name: String,
    /// One or two hands.
    hands: Vec<SensedHand>,
    /// Index of the hand that performs each action.
    hand_of_action: Vec<usize>,
    /// Number of actions that may be performed so far, including the present one.
    permitted: usize,
    period: Duration,
    packet: u64,
    readings: u64,
    /// Readings of the last packet that were not returned yet.
    pending: VecDeque<Reading>,
}

#[derive(Clone)]
struct SensedHand {
    side: Side,
    hand: SimulatedHand,
}

impl SimulatedTypist {
    /// Plans actions in a scene for an arm that wears a glove.
    pub fn new(
        settings: &TypistSettings,
        actions: &[HandAction],
        scene: &Scene,
        arm: &ArmModel,
        map: &ChannelMap,
    ) -> Result<Self, TypistError> {
        Self::with_hands(settings, actions, scene, &[(arm, Sensor::Glove(map))])
    }

    /// Plans actions in a scene for one or two arms with their sensors. The first hand performs actions that are made
    /// for neither hand in particular.
    ///
    /// # Panics
    /// If there is no hand.
    pub fn with_hands(
        settings: &TypistSettings,
        actions: &[HandAction],
        scene: &Scene,
        hands: &[(&ArmModel, Sensor)],
    ) -> Result<Self, TypistError> {
        assert!(!hands.is_empty(), "a simulated person needs a hand");
        let sides: Vec<Side> = hands.iter().map(|(arm, _)| arm.side()).collect();
        let hand_of_action = assign_hands(actions, scene, &sides);
        let sense = |(hand_index, &(arm, sensor)): (usize, &(&ArmModel, Sensor))| {
            let own = (0..actions.len()).filter(|&action| hand_of_action[action] == hand_index);
            let own: Vec<usize> = own.collect();
            let own_actions: Vec<_> = own.iter().map(|&action| actions[action].clone()).collect();
            let hand = SimulatedHand::new(settings, &own_actions, scene, arm, sensor);
            let hand = hand.map_err(|error| TypistError::from(error).with_index_in(&own))?;
            Ok(SensedHand {
                side: arm.side(),
                hand,
            })
        };
        let hands: Result<_, TypistError> = hands.iter().enumerate().map(sense).collect();
        Ok(Self {
            name: settings.name.clone(),
            hands: hands?,
            hand_of_action,
            permitted: 1,
            period: settings.packet_period,
            packet: 0,
            readings: 0,
            pending: VecDeque::new(),
        })
    }

    /// Starts again as `start` did; the time goes on.
    pub fn repeat(&mut self, start: &Self) {
        let (packet, readings) = (self.packet, self.readings);
        *self = Self {
            packet,
            readings,
            ..start.clone()
        };
    }

    /// Returns the name for messages.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the time between two packets.
    pub fn packet_period(&self) -> Duration {
        self.period
    }

    /// Returns the number of readings so far.
    pub fn reading_count(&self) -> u64 {
        self.readings
    }

    /// Returns the next reading, or `None` at the end. Readings of two hands have their sides.
    pub fn next_reading(&mut self) -> Option<Reading> {
        if self.pending.is_empty()
            && let Some(samples) = self.next_samples()
        {
            let time = Timestamp(0) + self.period.mul_f64(self.packet as f64);
            let is_one = self.hands.len() == 1;
            let reading = |(side, sample)| Reading::new(time, (!is_one).then_some(side), sample);
            self.pending.extend(samples.into_iter().map(reading));
        }
        let reading = self.pending.pop_front()?;
        self.readings += 1;
        Some(reading)
    }

    /// Returns the number of hands.
    pub fn hand_count(&self) -> usize {
        self.hands.len()
    }

    /// Returns the sides of the hands.
    pub fn sides(&self) -> impl Iterator<Item = Side> {
        self.hands.iter().map(|hand| hand.side)
    }

    /// Returns the number of packets until the end.
    pub fn count_packets(&self) -> u64 {
        let mut rest = self.clone();
        let mut packets = 0;
        while rest.advance() {
            packets += 1;
        }
        packets
    }

    /// Returns the counts of the first glove in the next packet, or `None` at the end.
    pub fn next_counts(&mut self) -> Option<GloveCounts> {
        self.next_packets()
            .map(|mut packets| packets.swap_remove(0))
    }

    /// Returns the counts of all gloves in the next packet, or `None` at the end. A hand without a glove has none.
    pub fn next_packets(&mut self) -> Option<Vec<GloveCounts>> {
        let counts = |(_, sample)| match sample {
            Sample::Channels(channels) => channels.counts,
            _ => GloveCounts::new(),
        };
        let samples = self.next_samples()?;
        Some(samples.into_iter().map(counts).collect())
    }

    /// Returns what the sensor of each hand measures in the next packet, or `None` at the end.
    pub fn next_samples(&mut self) -> Option<Vec<(Side, Sample)>> {
        if !self.advance() {
            return None;
        }
        self.packet += 1;
        let samples = self.hands.iter_mut();
        Some(
            samples
                .map(|hand| (hand.side, hand.hand.sample()))
                .collect(),
        )
    }

    /// Moves the hands by one packet. Returns `false` at the end.
    fn advance(&mut self) -> bool {
        let is_last = self.permitted >= self.hand_of_action.len();
        let mut is_finished = true;
        for hand in 0..self.hands.len() {
            let permitted = match is_last {
                true => usize::MAX,
                false => self.own_actions(hand, self.permitted),
            };
            is_finished &= self.hands[hand].hand.advance(permitted) == Progress::Finished;
        }
        if is_finished && is_last {
            return false;
        }
        if !is_last && self.has_finished(self.permitted) {
            self.permitted += 1;
        }
        true
    }

    /// Returns whether the first `actions` actions are done and no hand is moving.
    pub fn has_finished(&self, actions: usize) -> bool {
        let mut hands = self.hands.iter().enumerate();
        hands.all(|(index, hand)| hand.hand.has_finished(self.own_actions(index, actions)))
    }

    /// Returns how many of the first `actions` actions a hand performs.
    fn own_actions(&self, hand: usize, actions: usize) -> usize {
        let first = self.hand_of_action.iter().take(actions);
        first.filter(|&&other| other == hand).count()
    }
}

/// Assigns each action to the hand for which the board of its target is made, otherwise to the first hand. An action
/// without a target goes to the hand of the action before it.
fn assign_hands(actions: &[HandAction], scene: &Scene, sides: &[Side]) -> Vec<usize> {
    let mut hand = 0;
    let assign = |action: &HandAction| {
        if let Some(target) = action.target() {
            let found = scene.target(target);
            let side = found.and_then(|(surface, _)| surface.side());
            let index = side.and_then(|side| sides.iter().position(|other| *other == side));
            hand = index.unwrap_or(0);
        }
        hand
    };
    actions.iter().map(assign).collect()
}
