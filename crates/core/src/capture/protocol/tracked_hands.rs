//! Lines with the hands that a tracker sees at one instant: common to hand landmarks and joint sets.

use std::fmt;

use serde::de::{Error, SeqAccess, Unexpected, Visitor};
use serde::{Deserialize, Deserializer};

use super::line_times::LineTimes;
use super::space;
use super::{InvalidPacket, Packet, PacketError, ProtocolOption};
use crate::capture::Sample;
use crate::hand::{JointPositions, Side};
use crate::time::Timestamp;

/// The most hands in a line: two people have four.
pub(super) const MAX_HANDS: usize = 4;

/// The lowest confidence of a hand that is used.
pub(super) const MIN_SCORE: ProtocolOption = ProtocolOption {
    name: "min_score",
    default: "0.5",
    summary: "lowest score of a hand that counts as seen, 0 to 1",
    check: |value| match value.parse::<f64>() {
        Ok(score) if (0.0..=1.0).contains(&score) => Ok(()),
        _ => Err(format!("`{value}` is not a score from 0 to 1")),
    },
};

/// Returns the score of a hand in a line that states none.
pub(super) fn certain() -> f64 {
    1.0
}

/// Lines per second of a file without times.
pub(super) const RATE: ProtocolOption = ProtocolOption {
    name: "rate_hz",
    default: "30",
    summary: "lines per second of a file without times, 0.1 to 10000",
    check: |value| space::check_range(value, 0.1..=10_000.0, "lines per second"),
};

/// Checks an option that is `yes` or `no`.
pub(super) fn check_yes_or_no(value: &str) -> Result<(), String> {
    match value {
        "yes" | "no" => Ok(()),
        _ => Err(format!("write `yes` or `no` instead of `{value}`")),
    }
}

/// Name of a hand in a line: `Left` or `right`, in any case.
#[derive(Clone, Copy, Debug)]
pub(super) struct Label(pub Side);

impl<'de> Deserialize<'de> for Label {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct LabelVisitor;

        impl Visitor<'_> for LabelVisitor {
            type Value = Label;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("`left` or `right`")
            }

            fn visit_str<E: Error>(self, text: &str) -> Result<Label, E> {
                let mut sides = Side::ALL.iter().copied();
                sides
                    .find(|side| text.eq_ignore_ascii_case(side.name()))
                    .map(Label)
                    .ok_or_else(|| E::invalid_value(Unexpected::Str(text), &self))
            }
        }

        deserializer.deserialize_str(LabelVisitor)
    }
}

/// A position, of which further numbers in the list, such as a rotation and a radius, do not count.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Position(pub [f64; 3]);

/// A position that may be unknown: `null`, or a list with `null` in place of a coordinate. WebXR gives NaN for a joint that is not
/// followed (`fillPoses`), and JavaScript writes NaN as `null`.
#[derive(Clone, Copy, Debug)]
pub(super) struct TrackedPosition(pub Option<[f64; 3]>);

/// The first three numbers of a list; `None` if one of them is `null`.
struct Coordinates(Option<[f64; 3]>);

/// Numbers of a joint of OpenXR: a position, a quaternion and a radius.
const MAX_NUMBERS: usize = 8;

impl<'de> Deserialize<'de> for Coordinates {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct CoordinatesVisitor;

        impl<'de> Visitor<'de> for CoordinatesVisitor {
            type Value = Coordinates;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                write!(f, "a list of three to {MAX_NUMBERS} numbers")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Coordinates, A::Error> {
                let (mut numbers, mut count) = ([None; 3], 0);
                while let Some(number) = list.next_element::<Option<f64>>()? {
                    if let Some(slot) = numbers.get_mut(count) {
                        *slot = number;
                    }
                    count += 1;
                }
                match (count, numbers) {
                    (3..=MAX_NUMBERS, [Some(x), Some(y), Some(z)]) => {
                        Ok(Coordinates(Some([x, y, z])))
                    }
                    (3..=MAX_NUMBERS, _) => Ok(Coordinates(None)),
                    _ => Err(A::Error::invalid_length(count, &self)),
                }
            }
        }

        deserializer.deserialize_seq(CoordinatesVisitor)
    }
}

impl<'de> Deserialize<'de> for Position {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let Coordinates(position) = Coordinates::deserialize(deserializer)?;
        let error = || D::Error::invalid_type(Unexpected::Unit, &"a number");
        position.map(Self).ok_or_else(error)
    }
}

impl<'de> Deserialize<'de> for TrackedPosition {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let list = Option::<Coordinates>::deserialize(deserializer)?;
        Ok(Self(list.and_then(|Coordinates(position)| position)))
    }
}

/// The hands of a tracker over time. Gives a packet for each hand in each line, without joints for one that is not seen.
#[derive(Clone, Debug)]
pub(super) struct TrackedHands {
    times: LineTimes,
    rate_hz: f64,
    lines: u64,
    /// `true` for each side whose hand was seen since the start.
    was_seen: [bool; Side::COUNT],
}

impl TrackedHands {
    /// Creates the state at the start of a stream with this nominal rate.
    pub fn new(rate_hz: f64) -> Self {
        Self {
            times: LineTimes::default(),
            rate_hz,
            lines: 0,
            was_seen: [false; Side::COUNT],
        }
    }

    /// Returns the times of the next line, which states `time_us`.
    pub fn start_line(&mut self, time_us: Option<u64>) -> Result<LineTime, PacketError> {
        let stated = self.times.check(time_us)?;
        self.lines += 1;
        let nominal = Timestamp::from_seconds(self.lines as f64 / self.rate_hz);
        Ok(LineTime {
            time: stated.unwrap_or(nominal),
            stated,
        })
    }

    /// Passes the hands of a line, by side, to `emit`.
    pub fn emit(
        &mut self,
        line: LineTime,
        hands: &[Option<JointPositions>; Side::COUNT],
        emit: &mut dyn FnMut(Packet),
    ) {
        for &side in Side::ALL {
            let was_seen = &mut self.was_seen[side.index()];
            *was_seen |= hands[side.index()].is_some();
            if *was_seen {
                let positions = hands[side.index()].unwrap_or_default();
                emit(Packet {
                    time: Some(line.time),
                    sent_at: line.stated,
                    side: Some(side),
                    ..Packet::new(Sample::Joints { positions }, 0)
                });
            }
        }
    }

    /// Forgets the hands, after a stream broke off.
    pub fn reset(&mut self) {
        self.times = LineTimes::default();
        self.was_seen = [false; Side::COUNT];
    }
}

/// The times of a line.
#[derive(Clone, Copy, Debug)]
pub(super) struct LineTime {
    /// The time that the line states, or the time that follows from its number.
    pub time: Timestamp,
    /// The time that the line states.
    pub stated: Option<Timestamp>,
}

/// Two hands of the same side in one line: the one with the higher score counts.
pub(super) struct BestHands {
    hands: [Option<JointPositions>; Side::COUNT],
    scores: [f64; Side::COUNT],
}

impl BestHands {
    /// Creates the choice among hands with at least `min_score`.
    pub fn new(min_score: f64) -> Self {
        Self {
            hands: [None; Side::COUNT],
            scores: [min_score.next_down(); Side::COUNT],
        }
    }

    /// Returns `true` if a hand with this score would be chosen.
    pub fn admits(&self, side: Side, score: f64) -> bool {
        score > self.scores[side.index()]
    }

    /// Adds a hand.
    pub fn add(&mut self, side: Side, score: f64, positions: JointPositions) {
        if self.admits(side, score) {
            self.scores[side.index()] = score;
            self.hands[side.index()] = Some(positions);
        }
    }

    /// Returns the hands by side.
    pub fn hands(&self) -> &[Option<JointPositions>; Side::COUNT] {
        &self.hands
    }
}

/// Refuses a score outside 0..=1.
pub(super) fn check_score(score: f64) -> Result<(), PacketError> {
    if (0.0..=1.0).contains(&score) {
        Ok(())
    } else {
        Err(PacketError::new(
            InvalidPacket::NotFinite,
            "the score of a hand is not from 0 to 1",
        ))
    }
}
