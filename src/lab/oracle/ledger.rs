//! What is down, and what goes out.

use arrayvec::ArrayVec;
use parry3d::math::Vec2;

use super::{Bounds, Rules, Violation};
use crate::device::{Action, Axis, KeyCode, Need, OutputEvent};
use crate::monitor::State;
use crate::time::Timestamp;

/// More than the presses that a switchboard holds and the modifiers around them.
const MOST_DOWN: usize = 64;

/// Places on the screen are whole pixels divided by its size.
const ROUNDING: f32 = 0.01;

/// The account of all that went out.
#[derive(Clone, Debug, Default)]
pub(super) struct Ledger {
    down: ArrayVec<KeyCode, MOST_DOWN>,
    axes: [f32; Axis::COUNT],
    pointer: Option<Vec2>,
    time: Timestamp,
}

impl Ledger {
    /// The pointer may be anywhere before its next place.
    pub(super) fn forget_the_pointer(&mut self) {
        self.pointer = None;
    }

    /// Whether nothing is down and every axis at rest.
    pub(super) fn is_at_rest(&self, state: State) -> Result<(), Violation> {
        if let Some(&code) = self.down.first() {
            return Err(Violation::StillDown(code, state));
        }
        match Axis::ALL.iter().find(|axis| self.axes[axis.index()] != 0.0) {
            Some(&axis) => Err(Violation::StillOff(axis, state)),
            None => Ok(()),
        }
    }

    /// Takes what went out in one step. Without a frame it only lets go; `is_sorted` says whether what
    /// comes up has to go before what goes down.
    pub(super) fn take(
        &mut self,
        events: &[OutputEvent],
        rules: &Rules,
        has_frame: bool,
        is_sorted: bool,
    ) -> Result<(), Violation> {
        let mut of_frame = OfFrame::default();
        for event in events {
            self.take_time(event)?;
            let action = event.action;
            if !has_frame && !lets_go(action) {
                return Err(Violation::WithoutFrame(action));
            }
            if !is_in_range(action) {
                return Err(Violation::OutOfRange(action));
            }
            let need = Need::of(action).filter(|need| !rules.needs.has(*need));
            match need {
                // Of a layout that was in force before.
                Some(_) if lets_go(action) => {}
                Some(need) => return Err(Violation::NotAllowed(need)),
                None => {}
            }
            self.take_action(action, &mut of_frame, is_sorted)?;
            self.take_motion(action, &mut of_frame, rules.pointer)?;
        }
        Ok(())
    }

    fn take_time(&mut self, event: &OutputEvent) -> Result<(), Violation> {
        if event.time < self.time {
            return Err(Violation::EventWentBack(event.action));
        }
        self.time = event.time;
        Ok(())
    }

    fn take_action(
        &mut self,
        action: Action,
        of_frame: &mut OfFrame,
        is_sorted: bool,
    ) -> Result<(), Violation> {
        match action {
            Action::KeyDown(code) if self.down.contains(&code) => Err(Violation::DownTwice(code)),
            Action::KeyDown(code) => {
                let push = self.down.try_push(code);
                push.map_err(|_| Violation::TooManyDown(code))?;
                let _ = of_frame.pressed.try_push(code);
                Ok(())
            }
            Action::KeyUp(code) => {
                let place = self.down.iter().position(|other| *other == code);
                self.down.remove(place.ok_or(Violation::UpUnasked(code))?);
                let is_late = !of_frame.pressed.is_empty() && !of_frame.pressed.contains(&code);
                match is_sorted && is_late && !of_frame.has_asked {
                    true => Err(Violation::LateRelease(code)),
                    false => Ok(()),
                }
            }
            Action::Axis(axis, place) => {
                self.axes[axis.index()] = place;
                Ok(())
            }
            Action::Ask(_) => {
                // What is asked for may let go of all that was pressed before.
                of_frame.has_asked = true;
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn take_motion(
        &mut self,
        action: Action,
        of_frame: &mut OfFrame,
        bounds: Option<Bounds>,
    ) -> Result<(), Violation> {
        match action {
            Action::MoveBy(right, down) => of_frame.moved += Vec2::new(right as f32, down as f32),
            Action::MoveTo(right, down) => {
                let place = Vec2::new(right, down);
                let before = self.pointer.replace(place).unwrap_or(place);
                let screen = bounds.map_or(Vec2::ONE, |bounds| bounds.screen);
                of_frame.moved += (place - before) * screen;
            }
            _ => return Ok(()),
        }
        let moved = of_frame.moved.length();
        match bounds {
            Some(bounds) if moved > bounds.max_step + ROUNDING => {
                Err(Violation::LongStep(moved, bounds.max_step))
            }
            _ => Ok(()),
        }
    }
}

/// What went out so far in one frame.
#[derive(Default)]
struct OfFrame {
    pressed: ArrayVec<KeyCode, MOST_DOWN>,
    moved: Vec2,
    has_asked: bool,
}

/// Whether an action is one of letting go, which needs no frame.
fn lets_go(action: Action) -> bool {
    match action {
        Action::KeyUp(_) | Action::Unselect(_) | Action::Value(..) => true,
        Action::Axis(_, place) => place == 0.0,
        Action::Depth(_, depth) => depth == 0.0,
        _ => false,
    }
}

fn is_in_range(action: Action) -> bool {
    match action {
        Action::MoveTo(right, down) => (0.0..=1.0).contains(&right) && (0.0..=1.0).contains(&down),
        Action::Axis(axis, place) => {
            let lowest = if axis.is_trigger() { 0.0 } else { -1.0 };
            (lowest..=1.0).contains(&place)
        }
        Action::Depth(_, depth) => (0.0..=1.0).contains(&depth),
        Action::Value(_, value) => value.is_finite(),
        _ => true,
    }
}
