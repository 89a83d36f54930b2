//! From state to state.

use super::{Cause, Seen, Step, Violation};
use crate::contact::{Phase, Touch};
use crate::hand::Finger;
use crate::monitor::State;
use crate::pipeline::Arming;
use crate::time::Timestamp;

/// The way of an engine through its states.
#[derive(Clone, Debug)]
pub(super) struct Passage {
    arming: Arming,
    state: State,
    is_paused: bool,
    /// The latest time of any hand.
    time: Timestamp,
    /// Since when every frame showed a hand that touches nothing.
    clear_since: Option<Timestamp>,
}

impl Passage {
    pub(super) fn new(arming: Arming) -> Self {
        Self {
            arming,
            state: State::Starting,
            is_paused: false,
            time: Timestamp::default(),
            clear_since: None,
        }
    }

    /// The state after the last step, and whether somebody had asked for a pause.
    pub(super) fn state(&self) -> (State, bool) {
        (self.state, self.is_paused)
    }

    /// Takes the next step.
    pub(super) fn go_on(&mut self, step: &Step) -> Result<(), Violation> {
        let (before, after) = (self.state, step.state);
        if step.is_paused && !matches!(after, State::Paused | State::Stopped) {
            return Err(Violation::PauseNotKept(after));
        }
        if !may_follow(before, after) {
            return Err(Violation::Change(before, after));
        }
        let ends_pause = self.is_paused && !step.is_paused;
        if step.cause == Cause::LetGo || ends_pause || (before != after && after != State::Running)
        {
            self.clear_since = None;
        }
        if let Some(frame) = step.frame {
            self.take_frame(frame);
        }
        if before != State::Running && after == State::Running {
            self.arm(step, before)?;
        }
        if after == State::Running {
            self.clear_since = None;
        }
        (self.state, self.is_paused) = (after, step.is_paused);
        Ok(())
    }

    fn take_frame(&mut self, frame: Seen) {
        self.time = self.time.max(frame.pose.time);
        match touches_nothing(frame.touches) {
            true => self.clear_since = self.clear_since.or(Some(self.time)),
            false => self.clear_since = None,
        }
    }

    fn arm(&self, step: &Step, before: State) -> Result<(), Violation> {
        if step.frame.is_none() {
            return Err(Violation::ArmedUnseen);
        }
        if before == State::Starting && self.arming.at_once {
            return Ok(());
        }
        let clear_for = self.clear_since.map(|since| self.time.since(since));
        match clear_for.is_some_and(|clear_for| clear_for >= self.arming.neutral) {
            true => Ok(()),
            false => Err(Violation::ArmedTooSoon),
        }
    }
}

/// Whether the last that every fingertip did was to leave.
fn touches_nothing(touches: &[Touch]) -> bool {
    let is_off = |phase| matches!(phase, Phase::Left | Phase::Cancelled);
    let last_of = |finger| touches.iter().rfind(|touch| touch.finger == finger);
    let mut last = Finger::ALL.iter().filter_map(|&finger| last_of(finger));
    last.all(|touch| is_off(touch.phase))
}

fn may_follow(before: State, after: State) -> bool {
    match (before, after) {
        (State::Stopped, after) => after == State::Stopped,
        (_, State::Starting) => before == State::Starting,
        // An engine that never saw a hand has nothing to miss.
        (State::Starting, State::Stalled) => false,
        _ => true,
    }
}
