//! What is down, and what goes out.

use arrayvec::ArrayVec;
use parry3d::math::Vec2;

use super::{OutputRules, PointerBounds, Violation};
use crate::device::{Axis, Capability, EventKind, KeyCode, OutputEvent};
use crate::snapshot::PipelineState;
use crate::time::Timestamp;

/// More than the presses that a switchboard holds and the modifiers around them.
const MAX_PRESSED: usize = 64;

/// Places on the screen are whole pixels divided by its size.
const ROUNDING: f32 = 0.01;

/// The account of all that went out.
#[derive(Clone, Debug, Default)]
pub(super) struct OutputCheck {
    down: ArrayVec<KeyCode, MAX_PRESSED>,
    axes: [f32; Axis::COUNT],
    pointer: Option<Vec2>,
    time: Timestamp,
}

impl OutputCheck {
    /// The pointer may be anywhere before its next place.
    pub(super) fn reset_pointer(&mut self) {
        self.pointer = None;
    }

    /// Whether nothing is down and every axis at rest.
    pub(super) fn check_all_released(&self, state: PipelineState) -> Result<(), Violation> {
        if let Some(&code) = self.down.first() {
            return Err(Violation::NotReleased(code, state));
        }
        match Axis::ALL.iter().find(|axis| self.axes[axis.index()] != 0.0) {
            Some(&axis) => Err(Violation::AxisNotCentered(axis, state)),
            None => Ok(()),
        }
    }

    /// Takes what went out in one step. Without a frame it only lets go; `is_sorted` says whether what
    /// comes up has to go before what goes down.
    pub(super) fn check(
        &mut self,
        events: &[OutputEvent],
        rules: &OutputRules,
        has_frame: bool,
        is_sorted: bool,
    ) -> Result<(), Violation> {
        let mut of_frame = StepTotals::default();
        for event in events {
            self.check_time(event)?;
            let action = event.kind;
            if !has_frame && !is_release(action) {
                return Err(Violation::WithoutReading(action));
            }
            if !is_in_range(action) {
                return Err(Violation::OutOfRange(action));
            }
            let need = Capability::required_by(action).filter(|need| !rules.needs.contains(*need));
            match need {
                // Of a layout that was in force before.
                Some(_) if is_release(action) => {}
                Some(need) => return Err(Violation::NotAllowed(need)),
                None => {}
            }
            self.check_event(action, &mut of_frame, is_sorted)?;
            self.check_motion(action, &mut of_frame, rules.pointer)?;
        }
        Ok(())
    }

    fn check_time(&mut self, event: &OutputEvent) -> Result<(), Violation> {
        if event.time < self.time {
            return Err(Violation::EventTimeWentBack(event.kind));
        }
        self.time = event.time;
        Ok(())
    }

    fn check_event(
        &mut self,
        action: EventKind,
        of_frame: &mut StepTotals,
        is_sorted: bool,
    ) -> Result<(), Violation> {
        match action {
            EventKind::KeyDown(code) if self.down.contains(&code) => {
                Err(Violation::PressedTwice(code))
            }
            EventKind::KeyDown(code) => {
                let push = self.down.try_push(code);
                push.map_err(|_| Violation::TooManyPressed(code))?;
                let _ = of_frame.pressed.try_push(code);
                Ok(())
            }
            EventKind::KeyUp(code) => {
                let place = self.down.iter().position(|other| *other == code);
                self.down
                    .remove(place.ok_or(Violation::ReleasedWithoutPress(code))?);
                let is_late = !of_frame.pressed.is_empty() && !of_frame.pressed.contains(&code);
                match is_sorted && is_late && !of_frame.has_asked {
                    true => Err(Violation::LateRelease(code)),
                    false => Ok(()),
                }
            }
            EventKind::Axis(axis, place) => {
                self.axes[axis.index()] = place;
                Ok(())
            }
            EventKind::Ask(_) => {
                // What is asked for may let go of all that was pressed before.
                of_frame.has_asked = true;
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn check_motion(
        &mut self,
        action: EventKind,
        of_frame: &mut StepTotals,
        bounds: Option<PointerBounds>,
    ) -> Result<(), Violation> {
        match action {
            EventKind::MoveBy(right, down) => {
                of_frame.moved += Vec2::new(right as f32, down as f32)
            }
            EventKind::MoveTo(right, down) => {
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
                Err(Violation::PointerTooFast(moved, bounds.max_step))
            }
            _ => Ok(()),
        }
    }
}

/// What went out so far in one frame.
#[derive(Default)]
struct StepTotals {
    pressed: ArrayVec<KeyCode, MAX_PRESSED>,
    moved: Vec2,
    has_asked: bool,
}

/// Whether an action is one of letting go, which needs no frame.
fn is_release(action: EventKind) -> bool {
    match action {
        EventKind::KeyUp(_) | EventKind::Unselect(_) | EventKind::Value(..) => true,
        EventKind::Axis(_, place) => place == 0.0,
        EventKind::Depth(_, depth) => depth == 0.0,
        _ => false,
    }
}

fn is_in_range(action: EventKind) -> bool {
    match action {
        EventKind::MoveTo(right, down) => {
            (0.0..=1.0).contains(&right) && (0.0..=1.0).contains(&down)
        }
        EventKind::Axis(axis, place) => {
            let lowest = if axis.is_trigger() { 0.0 } else { -1.0 };
            (lowest..=1.0).contains(&place)
        }
        EventKind::Depth(_, depth) => (0.0..=1.0).contains(&depth),
        EventKind::Value(_, value) => value.is_finite(),
        _ => true,
    }
}
