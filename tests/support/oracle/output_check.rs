//! Invariants I1 to I5 of events: the keys that are pressed, the axes, the pointer.

use ademan::device::{Axis, Capability, EventKind, KeyCode, OutputEvent};
use ademan::pipeline::PipelineState;
use ademan::time::Timestamp;
use arrayvec::ArrayVec;
use parry3d::math::Vec2;

use super::{OutputRules, PointerBounds, Violation};

/// More than the key arbiter can press, modifiers included.
const MAX_PRESSED: usize = 64;

/// Tolerance of pointer distances in pixels: a position is a whole pixel divided by the size of the screen.
const ROUNDING: f32 = 0.01;

/// The output that all events so far lead to.
#[derive(Clone, Debug, Default)]
pub(super) struct OutputCheck {
    /// `true` if no system chord may be down.
    forbids_system_keys: bool,
    pressed: ArrayVec<KeyCode, MAX_PRESSED>,
    axes: [f32; Axis::COUNT],
    pointer: Option<Vec2>,
    time: Timestamp,
}

impl OutputCheck {
    pub(super) fn new(forbids_system_keys: bool) -> Self {
        Self {
            forbids_system_keys,
            ..Self::default()
        }
    }

    /// Accepts any position as the next one of the pointer.
    pub(super) fn reset_pointer(&mut self) {
        self.pointer = None;
    }

    /// Checks that all keys are released and all axes are centered.
    pub(super) fn check_all_released(&self, state: PipelineState) -> Result<(), Violation> {
        if let Some(&code) = self.pressed.first() {
            return Err(Violation::NotReleased(code, state));
        }
        match Axis::ALL.iter().find(|axis| self.axes[axis.index()] != 0.0) {
            Some(&axis) => Err(Violation::AxisNotCentered(axis, state)),
            None => Ok(()),
        }
    }

    /// Checks the events of one step. Without an accepted reading (`has_step`) they may only release. With
    /// `is_sorted`, releases have to precede presses.
    pub(super) fn check(
        &mut self,
        events: &[OutputEvent],
        rules: &OutputRules,
        has_step: bool,
        is_sorted: bool,
    ) -> Result<(), Violation> {
        let mut totals = StepTotals::default();
        for event in events {
            self.check_time(event)?;
            let kind = event.kind;
            if !has_step && !is_release(kind) {
                return Err(Violation::WithoutReading(kind));
            }
            if !is_in_range(kind) {
                return Err(Violation::OutOfRange(kind));
            }
            let missing = Capability::required_by(kind)
                .filter(|needed| !rules.capabilities.contains(*needed));
            match missing {
                // The previous layout may have pressed it.
                Some(_) if is_release(kind) => {}
                Some(missing) => return Err(Violation::NotAllowed(missing)),
                None => {}
            }
            self.check_event(kind, &mut totals, is_sorted)?;
            self.check_motion(kind, &mut totals, rules.pointer)?;
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
        kind: EventKind,
        totals: &mut StepTotals,
        is_sorted: bool,
    ) -> Result<(), Violation> {
        match kind {
            EventKind::KeyDown(code) if self.pressed.contains(&code) => {
                Err(Violation::PressedTwice(code))
            }
            EventKind::KeyDown(code) => {
                let push = self.pressed.try_push(code);
                push.map_err(|_| Violation::TooManyPressed(code))?;
                if !totals.pressed.contains(&code) {
                    let _ = totals.pressed.try_push(code);
                }
                if self.forbids_system_keys && is_system_chord(&self.pressed) {
                    Err(Violation::SystemChord(code))
                } else {
                    Ok(())
                }
            }
            EventKind::KeyUp(code) => {
                let index = self.pressed.iter().position(|other| *other == code);
                self.pressed
                    .remove(index.ok_or(Violation::ReleasedWithoutPress(code))?);
                let is_late = !totals.pressed.is_empty() && !totals.pressed.contains(&code);
                if is_sorted && is_late {
                    Err(Violation::LateRelease(code))
                } else {
                    Ok(())
                }
            }
            EventKind::Axis(axis, value) => {
                self.axes[axis.index()] = value;
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn check_motion(
        &mut self,
        kind: EventKind,
        totals: &mut StepTotals,
        bounds: Option<PointerBounds>,
    ) -> Result<(), Violation> {
        match kind {
            EventKind::MoveBy(right, down) => {
                totals.motion += Vec2::new(right as f32, down as f32);
            }
            EventKind::MoveTo(right, down) => {
                let position = Vec2::new(right, down);
                let before = self.pointer.replace(position).unwrap_or(position);
                let screen = bounds.map_or(Vec2::ONE, |bounds| bounds.screen);
                totals.motion += (position - before) * screen;
            }
            _ => return Ok(()),
        }
        let distance = totals.motion.length();
        match bounds {
            Some(bounds) if distance > bounds.max_step + ROUNDING => {
                Err(Violation::PointerTooFast(distance, bounds.max_step))
            }
            _ => Ok(()),
        }
    }
}

/// The sums of the events of one step.
#[derive(Default)]
struct StepTotals {
    pressed: ArrayVec<KeyCode, MAX_PRESSED>,
    motion: Vec2,
}

/// Returns `true` if the pressed keys act on the system: one of them alone, or one of them with Control and Alt.
fn is_system_chord(pressed: &[KeyCode]) -> bool {
    let is_pressed = |names: &[&str]| pressed.iter().any(|key| names.contains(&key.name()));
    is_pressed(&["MetaLeft", "MetaRight", "PrintScreen"])
        || is_pressed(&["ControlLeft", "ControlRight"])
            && is_pressed(&["AltLeft", "AltRight"])
            && is_pressed(&[
                "Delete",
                "Backspace",
                "NumpadDecimal",
                "F1",
                "F2",
                "F3",
                "F4",
                "F5",
                "F6",
                "F7",
                "F8",
                "F9",
                "F10",
                "F11",
                "F12",
            ])
}

/// Returns `true` if an event is permitted without an accepted reading.
fn is_release(kind: EventKind) -> bool {
    match kind {
        EventKind::KeyUp(_) | EventKind::Unselect(_) | EventKind::Value(..) => true,
        EventKind::Axis(_, value) => value == 0.0,
        EventKind::Depth(_, depth) => depth == 0.0,
        EventKind::Velocity(_, velocity) => velocity == 0.0,
        _ => false,
    }
}

fn is_in_range(kind: EventKind) -> bool {
    match kind {
        EventKind::MoveTo(right, down) => {
            (0.0..=1.0).contains(&right) && (0.0..=1.0).contains(&down)
        }
        EventKind::Axis(axis, value) => {
            let min = if axis.is_trigger() { 0.0 } else { -1.0 };
            (min..=1.0).contains(&value)
        }
        EventKind::Depth(_, depth) | EventKind::Velocity(_, depth) => (0.0..=1.0).contains(&depth),
        EventKind::Value(_, value) => value.is_finite(),
        _ => true,
    }
}
