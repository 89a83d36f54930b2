//! A simulated person with sensors on the hands, who moves the index fingers to targets.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use super::action::HandAction;
use super::action_error::ActionError;
use super::follower::Follower;
use super::layout_feed::LayoutFeed;
use super::live::{LiveTask, rewound};
use super::room::Room;
use super::sensed_hand::{SensedHand, assign_hands};
use super::sensor::Sensor;
use super::settings::TypistSettings;
use super::simulated_hand::{GloveCounts, Progress, SimulatedHand};
use super::task::{HandTask, TaskStep};
use super::text_plan::PlanError;
use crate::capture::{Reading, Sample};
use crate::contact::surface::Scene;
use crate::estimate::ChannelMap;
use crate::hand::Side;
use crate::kinematics::ArmModel;
use crate::layout::Layout;
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
pub struct SimulatedTypist {
    name: String,
    /// One or two hands.
    hands: Vec<SensedHand>,
    /// The room in which one hand carries a board of the other.
    room: Option<Room>,
    part: Part,
    follower: Option<Follower>,
    /// The hands that take over as soon as no fingertip presses.
    successors: Option<Vec<SensedHand>>,
    repeats: bool,
    period: Duration,
    packet: u64,
    readings: u64,
    /// Readings of the last packet that were not returned yet.
    pending: VecDeque<Reading>,
}

/// A part of the motion of the hands.
enum Part {
    /// A list of actions that was planned as a whole.
    Planned(Planned),
    /// A task that is planned step by step.
    Live(Box<LiveTask>),
}

#[derive(Clone)]
struct Planned {
    /// Index of the hand that performs each action.
    hand_of_action: Vec<usize>,
    /// Number of actions that may be performed so far, including the present one.
    permitted: usize,
    /// The hands before the first action, if the list is repeated.
    start: Option<Vec<SensedHand>>,
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
        let hands: Result<Vec<SensedHand>, TypistError> =
            hands.iter().enumerate().map(sense).collect();
        let hands = hands?;
        Ok(Self {
            name: settings.name.clone(),
            room: Room::new(scene, &hands),
            hands,
            part: Part::Planned(Planned {
                hand_of_action,
                permitted: 1,
                start: None,
            }),
            follower: None,
            successors: None,
            repeats: false,
            period: settings.packet_period,
            packet: 0,
            readings: 0,
            pending: VecDeque::new(),
        })
    }

    /// Creates a person who plans a task while performing it: steps that the layout does not permit are skipped, with a message to
    /// the receiver of `feed`. Follows the layout as [`following`](Self::following) does.
    ///
    /// # Panics
    /// If there is no hand.
    pub fn live(
        settings: &TypistSettings,
        task: HandTask,
        layout: Arc<Layout>,
        feed: &LayoutFeed,
        hands: &[(&ArmModel, Sensor)],
    ) -> Result<Self, TypistError> {
        let mut typist = Self::with_hands(settings, &[], &layout.scene, hands)?;
        let live = LiveTask::start(
            task.clone(),
            Arc::clone(&layout),
            &mut typist.hands,
            typist.period,
        );
        typist.part = Part::Live(Box::new(live));
        typist.follower = Some(Follower::new(task, layout, feed));
        Ok(typist)
    }

    /// Follows the changes of the layout: lifts before each and does the rest of its task on the new layout. `task` on `layout`
    /// gave the actions of this person.
    #[must_use]
    pub fn following(self, task: HandTask, layout: Arc<Layout>, feed: &LayoutFeed) -> Self {
        Self {
            follower: Some(Follower::new(task, layout, feed)),
            ..self
        }
    }

    /// Becomes another person, or one with other noise, at the end of the present step, or of the press to which that belongs. The
    /// hands continue from where they are. `hands` are as at the start. Only for a person who plans while performing.
    pub fn change(
        &mut self,
        settings: &TypistSettings,
        hands: &[(&ArmModel, Sensor)],
    ) -> Result<(), TypistError> {
        if let Part::Live(live) = &self.part {
            let changed = Self::with_hands(settings, &[], live.scene(), hands)?;
            self.successors = Some(changed.hands);
        }
        Ok(())
    }

    /// Lets the hands take over that wait for it.
    fn succeed(&mut self) {
        let Part::Live(live) = &mut self.part else {
            return;
        };
        let present = &self.hands;
        let successors = self.successors.take_if(|_| live.is_between_steps(present));
        let Some(mut hands) = successors else {
            return;
        };
        let mut pairs = hands.iter_mut().zip(present);
        if pairs.all(|(new, old)| new.hand.continue_from(&old.hand)) {
            live.set_hands(&hands);
            self.hands = hands;
        }
    }

    /// Starts again at the end, without end. Only for a person who has not begun.
    #[must_use]
    pub fn repeated(mut self) -> Self {
        self.repeats = true;
        if let Part::Planned(planned) = &mut self.part {
            planned.start = Some(self.hands.clone());
        }
        self
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

    /// Returns the number of packets until the end; 0 if the person plans step by step.
    pub fn count_packets(&self) -> u64 {
        let Part::Planned(planned) = &self.part else {
            return 0;
        };
        let (mut planned, mut hands) = (planned.clone(), self.hands.clone());
        let mut packets = 0;
        while planned.advance(&mut hands) {
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
        self.follow();
        self.succeed();
        if !self.is_lifted() && !self.advance() {
            // A change of the layout does not wait for a hand that has ended.
            self.follower = None;
            return None;
        }
        self.packet += 1;
        let seconds = self.period.as_secs_f64() * self.packet as f64;
        let room = self.room;
        let sample = |SensedHand { side, hand }: &mut SensedHand| {
            let mut sample = hand.sample();
            if let Some(room) = room {
                room.place(*side, seconds, &mut sample);
            }
            (*side, sample)
        };
        Some(self.hands.iter_mut().map(sample).collect())
    }

    /// Moves the hands by one packet. Returns `false` at the end.
    fn advance(&mut self) -> bool {
        match &mut self.part {
            Part::Live(live) => {
                let is_moved = live.advance(&mut self.hands, self.repeats);
                let messages = live.take_messages();
                if let Some(follower) = &self.follower {
                    messages.into_iter().for_each(|it| follower.say(it));
                }
                is_moved
            }
            Part::Planned(planned) => {
                if planned.advance(&mut self.hands) {
                    return true;
                }
                let Some(start) = &planned.start else {
                    return false;
                };
                self.hands.clone_from(start);
                planned.permitted = 1;
                planned.advance(&mut self.hands)
            }
        }
    }

    /// Returns `true` if the hands keep still, clear of all targets, because the layout is about to change.
    fn is_lifted(&self) -> bool {
        let follower = self.follower.as_ref();
        follower.is_some_and(Follower::is_lifted)
    }

    /// Lifts before a change of the layout, and continues after it.
    fn follow(&mut self) {
        let Some(follower) = &mut self.follower else {
            return;
        };
        let is_down = self.hands.iter().any(|hand| hand.hand.is_down());
        let Some(layout) = follower.update(is_down) else {
            return;
        };
        let task = follower.task();
        self.room = Room::new(&layout.scene, &self.hands);
        let part = std::mem::replace(&mut self.part, Part::Planned(Planned::default()));
        let live = match part {
            Part::Live(live) => live.set_layout(layout, &mut self.hands),
            Part::Planned(planned) => {
                let steps = task.resolve(follower.first_layout());
                let steps = steps.steps(follower.first_layout());
                let next = planned.next_step(&steps, &self.hands);
                let is_same = task
                    .resolve(&layout)
                    .is_same(&task.resolve(follower.first_layout()));
                let next = if is_same { next } else { 0 };
                LiveTask::resume(task.clone(), layout, next, &mut self.hands, self.period)
            }
        };
        self.part = Part::Live(Box::new(live));
    }

    /// Returns `true` if the first `actions` actions are done and no hand is moving.
    pub fn has_finished(&self, actions: usize) -> bool {
        match &self.part {
            Part::Planned(planned) => planned.has_finished(actions, &self.hands),
            Part::Live(_) => false,
        }
    }
}

impl Planned {
    /// Moves the hands by one packet. Returns `false` at the end.
    fn advance(&mut self, hands: &mut [SensedHand]) -> bool {
        let is_last = self.permitted >= self.hand_of_action.len();
        let mut is_finished = true;
        for (index, hand) in hands.iter_mut().enumerate() {
            let permitted = if is_last {
                usize::MAX
            } else {
                self.own_actions(index, self.permitted)
            };
            is_finished &= hand.hand.advance(permitted) == Progress::Finished;
        }
        if is_finished && is_last {
            return false;
        }
        if !is_last && self.has_finished(self.permitted, hands) {
            self.permitted += 1;
        }
        true
    }

    /// Returns `true` if the first `actions` actions are done and no hand is moving.
    fn has_finished(&self, actions: usize, hands: &[SensedHand]) -> bool {
        let mut hands = hands.iter().enumerate();
        hands.all(|(index, hand)| hand.hand.has_finished(self.own_actions(index, actions)))
    }

    /// Returns how many of the first `actions` actions a hand performs.
    fn own_actions(&self, hand: usize, actions: usize) -> usize {
        let first = self.hand_of_action.iter().take(actions);
        first.filter(|&&other| other == hand).count()
    }

    /// Returns the index of the first step that is not complete; `steps` gave the actions.
    fn next_step(&self, steps: &[TaskStep], hands: &[SensedHand]) -> usize {
        let mut all = hands.iter().enumerate();
        let is_done = hands.iter().any(|hand| hand.hand.is_lifting())
            || all.all(|(index, hand)| hand.hand.has_done(self.own_actions(index, self.permitted)));
        let done = if is_done {
            self.permitted
        } else {
            self.permitted - 1
        };
        let mut actions = 0;
        let complete = steps.iter().take_while(|step| {
            actions += step.actions.len();
            actions <= done
        });
        rewound(steps, complete.count(), hands)
    }
}

impl Default for Planned {
    fn default() -> Self {
        Self {
            hand_of_action: Vec::new(),
            permitted: 1,
            start: None,
        }
    }
}
