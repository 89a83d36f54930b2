//! The last seconds of a session, for time plots.

use std::collections::VecDeque;
use std::fmt;

use ademan_core::contact::TargetId;
use ademan_core::device::{EventKind, KeyCode, OutputEvent};
use ademan_core::hand::{Dof, Finger, FingerSet, Side};
use ademan_core::snapshot::Snapshot;
use ademan_core::time::Timestamp;

/// Seconds that are kept.
pub const SECONDS: f64 = 30.0;

/// The most moments that are kept: 30 s at 400 readings per second, 2 MB.
const MAX_MOMENTS: usize = 12_000;

/// The most events that are kept: 30 s at the default limit of the rate of presses; and the most values.
const MAX_EVENTS: usize = 3_000;

/// The longest time between two values of a control that is still moved: together they are one entry.
const MAX_PAUSE_SECONDS: f64 = 0.3;

/// The plotted values of one step. A value that is not known is NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Time of the reading.
    pub time: Timestamp,
    /// The angles in degrees, in the order of [`Dof::ALL`].
    pub degrees: [f32; Dof::COUNT],
    /// Height of each fingertip over the first board in millimetres, by side and finger.
    pub heights_mm: [[f32; Finger::COUNT]; Side::COUNT],
    /// Fingers that press a target, by side.
    pub pressing: [FingerSet; Side::COUNT],
    /// Time from the arrival of the reading to the output in milliseconds.
    pub latency_ms: f32,
}

impl Moment {
    /// Returns the start of a time without usable readings: nothing is known, and everything is released.
    const fn gap(time: Timestamp) -> Self {
        Self {
            time,
            degrees: [f32::NAN; Dof::COUNT],
            heights_mm: [[f32::NAN; Finger::COUNT]; Side::COUNT],
            pressing: [FingerSet::NONE; Side::COUNT],
            latency_ms: f32::NAN,
        }
    }

    /// Returns `true` if nothing is known.
    pub fn is_gap(&self) -> bool {
        let heights = self.heights_mm.iter().flatten();
        heights.chain(&self.degrees).all(|value| value.is_nan())
    }
}

/// A press, a release or a character that was sent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SentEvent {
    /// Time of the event.
    pub time: Timestamp,
    /// The key or character.
    pub key: SentKey,
    /// `false` for a release.
    pub is_press: bool,
}

/// A key, or a character that is sent in place of one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SentKey {
    /// A key or button.
    Code(KeyCode),
    /// A character, independent of the keymap.
    Character(char),
}

impl SentEvent {
    /// Returns the press or release of an event, or `None` if it is neither.
    pub fn new(event: &OutputEvent) -> Option<Self> {
        let (key, is_press) = match event.kind {
            EventKind::KeyDown(code) => (SentKey::Code(code), true),
            EventKind::KeyUp(code) => (SentKey::Code(code), false),
            EventKind::Character(character) => (SentKey::Character(character), true),
            _ => return None,
        };
        Some(Self {
            time: event.time,
            key,
            is_press,
        })
    }
}

impl fmt::Display for SentKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Code(code) => f.write_str(code.name()),
            Self::Character(character) => write!(f, "{character}"),
        }
    }
}

/// The value at which a control was left, or at which it is while it is moved.
#[derive(Clone, Debug, PartialEq)]
pub struct SentValue {
    /// Time of the latest value.
    pub time: Timestamp,
    /// The control, or one of its values if it has several.
    pub target: TargetId,
    /// Its name.
    pub name: String,
    /// 0..=1, a number of turns, or 1 for on.
    pub value: f32,
}

impl fmt::Display for SentValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {:.2}", self.name, self.value)
    }
}

/// The moments, events and values of the last [`SECONDS`], oldest first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct History {
    moments: VecDeque<Moment>,
    events: VecDeque<SentEvent>,
    values: VecDeque<SentValue>,
}

impl History {
    /// Adds a moment and drops moments that are too old. If the clock went back, the history starts over.
    pub fn push(&mut self, moment: Moment) {
        if self.end().is_some_and(|last| moment.time < last) {
            *self = Self::default();
        }
        let is_old = |time: Timestamp| moment.time.since(time).as_secs_f64() > SECONDS;
        while let Some(first) = self.moments.front()
            && (self.moments.len() == MAX_MOMENTS || is_old(first.time))
        {
            self.moments.pop_front();
        }
        while self.events.front().is_some_and(|first| is_old(first.time)) {
            self.events.pop_front();
        }
        while self.values.front().is_some_and(|first| is_old(first.time)) {
            self.values.pop_front();
        }
        self.moments.push_back(moment);
    }

    /// Ends everything at a time, or at the latest moment if that is later. Does nothing before the first moment and within a gap.
    pub fn push_gap(&mut self, time: Timestamp) {
        if let Some(last) = self.moments.back().filter(|last| !last.is_gap()) {
            let gap = Moment::gap(time.max(last.time));
            self.push(gap);
        }
    }

    /// Adds an event, and drops the oldest one if there are too many.
    pub fn push_event(&mut self, event: SentEvent) {
        if self.events.len() == MAX_EVENTS {
            self.events.pop_front();
        }
        self.events.push_back(event);
    }

    /// Adds the values of a snapshot. A control that is moved has one entry until it rests, and not one for each reading.
    pub fn push_values(&mut self, snapshot: &Snapshot) {
        for event in &snapshot.events {
            if let EventKind::Value(target, value) = event.kind {
                let name = snapshot.target_names.get(target);
                self.push_value(SentValue {
                    time: event.time,
                    target,
                    name: name.to_string(),
                    value,
                });
            }
        }
    }

    /// Adds a value. It replaces the previous value while the control is still being moved.
    pub fn push_value(&mut self, sent: SentValue) {
        let is_moved = |last: &SentValue| {
            sent.time.since(last.time).as_secs_f64() <= MAX_PAUSE_SECONDS
                && last.target == sent.target
        };
        // A control with two values sends both.
        let last = self.values.iter().rev().take(2).position(is_moved);
        if let Some(index) = last {
            self.values.remove(self.values.len() - 1 - index);
        }
        if self.values.len() == MAX_EVENTS {
            self.values.pop_front();
        }
        self.values.push_back(sent);
    }

    /// Returns the time of the latest moment.
    pub fn end(&self) -> Option<Timestamp> {
        self.moments.back().map(|last| last.time)
    }

    /// Returns the latest moment with values.
    pub fn last_known(&self) -> Option<&Moment> {
        self.moments.iter().rev().find(|moment| !moment.is_gap())
    }

    /// Iterates over the moments, oldest first.
    pub fn moments(&self) -> impl DoubleEndedIterator<Item = &Moment> + Clone {
        self.moments.iter()
    }

    /// Iterates over the events, oldest first.
    pub fn events(&self) -> impl Iterator<Item = &SentEvent> {
        self.events.iter()
    }

    /// Iterates over the values of controls, oldest first.
    pub fn values(&self) -> impl Iterator<Item = &SentValue> {
        self.values.iter()
    }

    /// Returns the latest moment at or before a time, or the first one.
    pub fn at(&self, time: Timestamp) -> Option<&Moment> {
        let after = self.moments.partition_point(|moment| moment.time <= time);
        self.moments.get(after.saturating_sub(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moment(seconds: u64) -> Moment {
        Moment {
            time: Timestamp(seconds * 1_000_000),
            degrees: [0.0; Dof::COUNT],
            heights_mm: Default::default(),
            pressing: Default::default(),
            latency_ms: 0.0,
        }
    }

    fn press(seconds: u64) -> SentEvent {
        SentEvent {
            time: Timestamp(seconds * 1_000_000),
            key: SentKey::Character('ñ'),
            is_press: true,
        }
    }

    #[test]
    fn moments_and_events_of_the_last_thirty_seconds_are_kept() {
        let mut history = History::default();
        for second in 0..100 {
            history.push(moment(second));
            history.push_event(press(second));
        }
        let times: Vec<f64> = history.moments().map(|m| m.time.seconds()).collect();
        assert_eq!((times.len(), times[0], times[30]), (31, 69.0, 99.0));
        assert_eq!(history.events().count(), 31);
    }

    #[test]
    fn events_are_bounded_without_moments() {
        let mut history = History::default();
        (0..2 * MAX_EVENTS as u64).for_each(|second| history.push_event(press(second)));
        assert_eq!(history.events().count(), MAX_EVENTS);
    }

    fn value(seconds: f64, target: u32, value: f32) -> SentValue {
        SentValue {
            time: Timestamp::from_seconds(seconds),
            target: TargetId(target),
            name: format!("Fader {target}"),
            value,
        }
    }

    #[test]
    fn a_control_that_is_moved_has_one_entry_with_its_last_value() {
        let mut history = History::default();
        for step in 0..100_u16 {
            let seconds = f64::from(step) / 100.0;
            let part = f32::from(step) / 100.0;
            history.push_value(value(seconds, 1, part));
            history.push_value(value(seconds, 2, 1.0 - part));
        }
        history.push_value(value(2.0, 1, 0.5));
        let shown: Vec<String> = history.values().map(ToString::to_string).collect();
        assert_eq!(shown, ["Fader 1 0.99", "Fader 2 0.01", "Fader 1 0.50"]);
        (3..40).for_each(|second| history.push(moment(second)));
        assert_eq!(history.values().count(), 0, "they are older than 30 s");
    }

    #[test]
    fn a_clock_that_goes_back_starts_anew() {
        let mut history = History::default();
        history.push(moment(50));
        history.push_event(press(50));
        history.push(moment(1));
        let counts = (history.moments().count(), history.events().count());
        assert_eq!(counts, (1, 0));
    }

    #[test]
    fn the_moment_at_a_time_is_the_latest_one_before() {
        let mut history = History::default();
        (2..5).for_each(|second| history.push(moment(second)));
        let at = |us| history.at(Timestamp(us)).unwrap().time.seconds();
        assert_eq!([at(0), at(3_900_000), at(9_000_000)], [2.0, 3.0, 4.0]);
    }
}
