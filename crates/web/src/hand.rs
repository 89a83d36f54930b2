//! The hands of the page: a simulated person, a pointer, or the lines of a sensor.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use ademan_core::capture::protocol::{Decoder, Protocol, hand_landmarks, joint_sets};
use ademan_core::capture::{Reading, Sample, StreamFormat};
use ademan_core::hand::Side;
use ademan_core::kinematics::ArmModel;
use ademan_core::layout::{Layout, Person};
use ademan_core::time::Timestamp;
use ademan_lab::sim::{
    HandTask, JointSensor, LayoutFeed, Sensor, SimulatedTypist, TypingKeys, TypistError,
    TypistSettings,
};
use serde::Serialize;

use crate::pointer::PointerHand;

/// Time between two readings of a simulated hand and of a pointer.
pub const PERIOD: Duration = Duration::from_millis(10);

/// The protocols of headsets and webcams, which a browser reads. The others would double the size of the module.
const PROTOCOLS: [&Protocol; 3] = [
    &joint_sets::WEBXR,
    &joint_sets::OPENXR,
    &hand_landmarks::PROTOCOL,
];

/// Most readings of a recording that wait.
const MAX_WAITING: usize = 200_000;

/// The activity of the hands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum HandState {
    /// Nothing.
    Resting,
    /// A simulated person types or plays a script.
    Simulated,
    /// A pointer moves a hand.
    Pointing,
    /// Readings of a sensor or a recording move the hands.
    Followed,
}

/// The hands of the page.
pub enum Hand {
    /// None.
    Resting,
    /// A simulated person.
    Simulated(Box<SimulatedPerson>),
    /// A pointer.
    Pointing(Box<PointerHand>),
    /// The lines of a sensor.
    Followed(Box<FollowedHand>),
}

/// A simulated person, and the messages about what the layout does not permit.
pub struct SimulatedPerson {
    typist: SimulatedTypist,
    messages: Arc<Mutex<Vec<String>>>,
    /// The task, for another layout.
    pub task: HandTask,
}

/// A sensor that sends lines, and its readings that wait for their time.
pub struct FollowedHand {
    protocol: &'static str,
    decoder: Box<dyn Decoder>,
    waiting: VecDeque<(Timestamp, Option<Side>, Sample)>,
    /// The difference between the clock of the page and that of the sensor, in microseconds.
    offset: Option<u64>,
}

impl Hand {
    /// The state of the hands.
    pub fn state(&self) -> HandState {
        match self {
            Self::Resting => HandState::Resting,
            Self::Simulated(_) => HandState::Simulated,
            Self::Pointing(_) => HandState::Pointing,
            Self::Followed(_) => HandState::Followed,
        }
    }

    /// Returns the readings until a time, and whether the hand has ended.
    pub fn advance(&mut self, time: Timestamp, readings: &mut Vec<Reading>) -> bool {
        match self {
            Self::Resting => true,
            Self::Simulated(person) => match person.typist.next_samples() {
                Some(samples) => {
                    let reading = |(side, sample)| Reading::new(time, Some(side), sample);
                    readings.extend(samples.into_iter().map(reading));
                    false
                }
                None => true,
            },
            Self::Pointing(pointer) => {
                let (side, sample) = (pointer.side(), pointer.advance(PERIOD.as_secs_f32()));
                readings.push(Reading::new(time, Some(side), sample));
                false
            }
            Self::Followed(hand) => {
                hand.advance(time, readings);
                false
            }
        }
    }

    /// Removes the messages for the user.
    pub fn take_messages(&self) -> Vec<String> {
        match self {
            Self::Simulated(person) => {
                let messages = person.messages.lock();
                std::mem::take(&mut *messages.unwrap_or_else(PoisonError::into_inner))
            }
            _ => Vec::new(),
        }
    }
}

impl SimulatedPerson {
    /// Creates a person with one or both hands who does a task as far as the layout permits.
    pub fn new(
        task: HandTask,
        layout: &Arc<Layout>,
        arms: &[ArmModel],
        person: &Person,
    ) -> Result<Self, TypistError> {
        let settings = TypistSettings {
            name: "person".into(),
            packet_period: PERIOD,
            noise: 0.0,
            seed: 1,
            person: person.clone(),
            keys: TypingKeys::new(layout),
        };
        let messages = Arc::<Mutex<Vec<String>>>::default();
        let feed = LayoutFeed::default();
        let receiver = Arc::clone(&messages);
        feed.set_receiver(move |message| {
            let mut messages = receiver.lock().unwrap_or_else(PoisonError::into_inner);
            messages.push(message);
        });
        let sensor = Sensor::Joints(JointSensor::Positions);
        let hands: Vec<_> = arms.iter().map(|arm| (arm, sensor)).collect();
        let typist =
            SimulatedTypist::live(&settings, task.clone(), Arc::clone(layout), &feed, &hands)?;
        Ok(Self {
            typist,
            messages,
            task,
        })
    }
}

impl FollowedHand {
    /// Creates the hand of a sensor that speaks a protocol.
    pub fn new(protocol: &str) -> Result<Self, String> {
        let mut protocols = PROTOCOLS.into_iter();
        let known = protocols.find(|it| it.name == protocol);
        let known = known.ok_or("this page reads `webxr`, `openxr` and `hand-landmarks` only")?;
        Ok(Self {
            protocol: known.name,
            decoder: StreamFormat::new(known).decoder(),
            waiting: VecDeque::new(),
            offset: None,
        })
    }

    /// The protocol.
    pub fn protocol(&self) -> &'static str {
        self.protocol
    }

    /// Receives bytes. Returns the number of readings in them.
    pub fn push(&mut self, bytes: &[u8], now: Timestamp) -> usize {
        let before = self.waiting.len();
        let (waiting, offset) = (&mut self.waiting, &mut self.offset);
        self.decoder.push(bytes, &mut |packet| {
            let own = packet.time.or(packet.sent_at);
            let time = match own {
                Some(own) => {
                    let offset = *offset.get_or_insert(now.0.saturating_sub(own.0));
                    Timestamp(own.0.saturating_add(offset))
                }
                None => now,
            };
            if waiting.len() < MAX_WAITING {
                waiting.push_back((time, packet.side, packet.sample));
            }
        });
        self.waiting.len() - before
    }

    fn advance(&mut self, time: Timestamp, readings: &mut Vec<Reading>) {
        while let Some((due, ..)) = self.waiting.front()
            && *due <= time
            && let Some((due, side, sample)) = self.waiting.pop_front()
        {
            readings.push(Reading::new(due, side, sample));
        }
    }
}
