//! The switch of a trigger: thresholds, the time for which it is held, and the cool-down.

use std::time::Duration;

use super::Trigger;
use crate::time::Timestamp;

/// The longest gap between two measurements of a trigger that is held: what was not seen was not held.
const MAX_GAP: Duration = Duration::from_millis(250);

/// The state of a trigger of one hand.
#[derive(Clone, Copy, Debug)]
pub(super) struct Switch {
    state: State,
    /// The time of the last measurement.
    last: Timestamp,
    /// The time at which it was on last.
    was_on: Option<Timestamp>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// Not seen off since its measurement was unknown.
    Unknown,
    Off,
    /// Seen beyond its threshold during the cool-down: it has to be seen off first.
    Blocked,
    /// Beyond its threshold since this time, and not on yet.
    Held(Timestamp),
    On,
}

/// The result of a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Change {
    None,
    /// The switch was unknown and is off.
    Known,
    /// The switch is due to be switched on; the caller confirms it with [`Switch::switch_on`].
    Due,
    /// The switch was on and is off.
    Off,
}

impl Switch {
    pub(super) const fn new() -> Self {
        Self {
            state: State::Unknown,
            last: Timestamp(0),
            was_on: None,
        }
    }

    pub(super) fn is_on(&self) -> bool {
        self.state == State::On
    }

    pub(super) fn is_unknown(&self) -> bool {
        self.state == State::Unknown
    }

    /// Sets the state to unknown. Returns `true` if it was known.
    pub(super) fn forget(&mut self, time: Timestamp) -> bool {
        if self.is_on() {
            self.was_on = Some(time);
        }
        std::mem::replace(&mut self.state, State::Unknown) != State::Unknown
    }

    /// Switches on.
    pub(super) fn switch_on(&mut self, time: Timestamp) {
        self.state = State::On;
        self.was_on = Some(time);
    }

    /// Processes a measurement. While `is_blocked`, it does not switch on.
    pub(super) fn update(
        &mut self,
        trigger: &Trigger,
        measurement: f32,
        is_blocked: bool,
        time: Timestamp,
    ) -> Change {
        let Trigger { on, off, .. } = *trigger;
        let is_past = |limit: f32| (measurement - limit) * (on - off).signum() >= 0.0;
        let is_back = measurement == off || !is_past(off);
        let gap = time.since(self.last);
        self.last = time;
        let (state, change) = match self.state {
            State::Unknown if is_back => (State::Off, Change::Known),
            State::On if is_back => {
                self.was_on = Some(time);
                (State::Off, Change::Off)
            }
            State::Unknown | State::On => (self.state, Change::None),
            _ if is_back => (State::Off, Change::None),
            State::Blocked => (State::Blocked, Change::None),
            State::Off if !is_past(on) => (State::Off, Change::None),
            _ if is_blocked || self.is_cooling(trigger.cool_down, time) => {
                (State::Blocked, Change::None)
            }
            State::Off => (State::Held(time), due(trigger, Duration::ZERO)),
            State::Held(_) if gap > MAX_GAP => (State::Held(time), Change::None),
            // Between the two thresholds it is still held, but only a hand beyond the first one switches it on.
            State::Held(since) if is_past(on) => (self.state, due(trigger, time.since(since))),
            State::Held(_) => (self.state, Change::None),
        };
        self.state = state;
        change
    }

    fn is_cooling(&self, cool_down: Duration, time: Timestamp) -> bool {
        let was_on = self.was_on;
        was_on.is_some_and(|was_on| time.since(was_on) < cool_down)
    }
}

fn due(trigger: &Trigger, held: Duration) -> Change {
    if held >= trigger.hold {
        Change::Due
    } else {
        Change::None
    }
}
