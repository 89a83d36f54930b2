//! The hands of the page: a simulated person, a pointer, or the lines of a sensor.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

#[cfg(feature = "recordings")]
use ademan_core::capture::protocol::bvh;
use ademan_core::capture::protocol::{Decoder, Packet, Protocol, hand_landmarks, joint_sets};
use ademan_core::capture::{RESTART_PAUSE, Reading, StreamFormat};
use ademan_core::kinematics::ArmModel;
use ademan_core::layout::{Layout, Person};
use ademan_core::time::Timestamp;
use ademan_lab::sim::{
    HandTask, JointSensor, LayoutFeed, PointerHand, Sensor, SimulatedTypist, TypingKeys,
    TypistError, TypistSettings,
};
use serde::Serialize;

/// Time between two readings of a simulated hand and of a pointer.
pub const PERIOD: Duration = Duration::from_millis(10);

/// The protocols of headsets and webcams, which a browser reads, and of motion capture files, which the page opens with the module
/// for recordings. The others would double the size of the module.
const PROTOCOLS: &[&Protocol] = &[
    #[cfg(feature = "recordings")]
    &bvh::PROTOCOL,
    &joint_sets::WEBXR,
    &joint_sets::OPENXR,
    &hand_landmarks::PROTOCOL,
];

/// Longest wait for one reading of a recording, as in `ademan replay`: a device may have been lost for hours.
pub const MAX_GAP: Duration = Duration::from_secs(2);

/// Most readings of a recording that wait.
const MAX_WAITING: usize = 200_000;

/// The longest delay that readings of a sensor that measures now keep, in microseconds: pages draw at 60 Hz.
const MAX_DELAY_US: i64 = 100_000;

/// Returns the format of a name such as `hand-landmarks?mirrored=yes&view_deg=70`.
fn format_of(text: &str) -> Result<StreamFormat, String> {
    let (name, options) = text.split_once('?').unwrap_or((text, ""));
    let known = PROTOCOLS.iter().find(|it| it.name == name);
    let known =
        known.ok_or("this page reads `webxr`, `openxr`, `hand-landmarks` and `bvh` only")?;
    let mut format = StreamFormat::new(known);
    for pair in options.split('&').filter(|it| !it.is_empty()) {
        let (option, value) = pair.split_once('=').unwrap_or((pair, ""));
        let found = known.option(option);
        let found = found.ok_or_else(|| format!("`{name}` has no such option"))?;
        format.options.set(found, value)?;
    }
    Ok(format)
}

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
    /// The readings of a recording that wait for their time.
    Recorded(VecDeque<Reading>),
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
    /// The protocol, with its options if they are not the defaults.
    format: String,
    decoder: Box<dyn Decoder>,
    waiting: VecDeque<Reading>,
    /// The time of the page minus the time of the sensor, in microseconds.
    offset: Option<i64>,
    /// The time of the latest bytes of a sensor that measures now; `None` for a recording.
    live: Option<Timestamp>,
}

impl Hand {
    /// Returns the state of the hands.
    pub fn state(&self) -> HandState {
        match self {
            Self::Resting => HandState::Resting,
            Self::Simulated(_) => HandState::Simulated,
            Self::Pointing(_) => HandState::Pointing,
            Self::Followed(_) | Self::Recorded(_) => HandState::Followed,
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
                take_due(&mut hand.waiting, time, readings);
                false
            }
            Self::Recorded(waiting) => {
                take_due(waiting, time, readings);
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
            let mut received = receiver.lock().unwrap_or_else(PoisonError::into_inner);
            received.push(message);
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
    /// Creates the hand of a recording: its readings come at their own times.
    pub fn new(format: &str) -> Result<Self, String> {
        Ok(Self {
            format: format.to_owned(),
            decoder: format_of(format)?.decoder(),
            waiting: VecDeque::new(),
            offset: None,
            live: None,
        })
    }

    /// Creates the hand of a recording with the bytes of its whole file, and returns it with the error in what was left out. Its first
    /// reading is due now. The error says why there is no reading.
    pub fn of_file(
        format: &str,
        bytes: &[u8],
        now: Timestamp,
    ) -> Result<(Self, Option<String>), String> {
        let mut hand = Self::new(format)?;
        let count = hand.decode(bytes, true, now);
        let error = hand.decoder.take_error().or_else(|| hand.last_error());
        match count {
            0 => Err(error.unwrap_or_else(|| "the file shows no hand".to_owned())),
            _ => Ok((hand, error)),
        }
    }

    /// Returns the number of readings that wait.
    pub fn waiting(&self) -> usize {
        self.waiting.len()
    }

    /// Creates the hand of a sensor that measures now, at a time of the page.
    pub fn live(format: &str, now: Timestamp) -> Result<Self, String> {
        Ok(Self {
            live: Some(now),
            ..Self::new(format)?
        })
    }

    /// Returns `true` if it is the hand of this format, of a recording or of a sensor that measures now.
    pub fn is_of(&self, format: &str, is_live: bool) -> bool {
        self.format == format && self.live.is_some() == is_live
    }

    /// Returns the time since the latest bytes of a sensor that measures now; `None` for a recording.
    pub fn silence(&self, now: Timestamp) -> Option<Duration> {
        self.live.map(|last| now.since(last))
    }

    /// Returns the error in the latest line, if it was refused.
    pub fn last_error(&self) -> Option<String> {
        self.decoder.last_error().map(ToString::to_string)
    }

    /// Receives bytes. Returns the number of readings in them.
    pub fn push(&mut self, bytes: &[u8], now: Timestamp) -> usize {
        self.decode(bytes, false, now)
    }

    /// Decodes bytes, which may be the last ones. Returns the number of readings in them.
    fn decode(&mut self, bytes: &[u8], is_end: bool, now: Timestamp) -> usize {
        let before = self.waiting.len();
        let (waiting, offset) = (&mut self.waiting, &mut self.offset);
        let is_live = self.live.is_some();
        if is_live {
            self.live = Some(now);
        }
        let mut receive = |packet: Packet| {
            let own = packet.time.or(packet.sent_at);
            let time = match own {
                Some(own) => {
                    let arrival = now.0.cast_signed().wrapping_sub(own.0.cast_signed());
                    let mut shift = offset.unwrap_or(arrival);
                    // The clock of the page stands still in the background, and a reading of now must not wait.
                    if is_live && !(arrival.saturating_sub(MAX_DELAY_US)..=arrival).contains(&shift)
                    {
                        shift = arrival;
                    }
                    let due = Timestamp(own.0.saturating_add_signed(shift));
                    let is_of_file = !is_live && packet.sent_at.is_some();
                    let shifted = match waiting.back() {
                        // Its readings would all be due at once.
                        Some(last) if is_of_file && due < last.time => last.time + RESTART_PAUSE,
                        Some(last) if !is_live && due.since(last.time) > MAX_GAP => {
                            last.time + MAX_GAP
                        }
                        _ => due,
                    };
                    if shifted != due {
                        shift = shifted.0.cast_signed().wrapping_sub(own.0.cast_signed());
                    }
                    *offset = Some(shift);
                    shifted
                }
                None => now,
            };
            if waiting.len() < MAX_WAITING {
                waiting.push_back(Reading::new(time, packet.side, packet.sample));
            }
        };
        self.decoder.push(bytes, &mut receive);
        if is_end {
            self.decoder.finish(&mut receive);
        }
        self.waiting.len() - before
    }
}

/// Moves the readings that are due at a time.
fn take_due(waiting: &mut VecDeque<Reading>, time: Timestamp, readings: &mut Vec<Reading>) {
    while let Some(reading) = waiting.pop_front_if(|it| it.time <= time) {
        readings.push(reading);
    }
}
