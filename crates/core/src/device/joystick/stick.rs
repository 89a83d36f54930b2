//! The state of a joystick that is off its center.

use std::time::Duration;

use parry3d::math::Vec2;

use super::Joystick;
use crate::contact::{Phase, Touch};
use crate::device::{DeviceOutput, EventKind, PressSource};
use crate::hand::{Finger, Side};
use crate::time::Timestamp;

/// Thresholds with hysteresis, as fractions.
#[derive(Clone, Copy, Debug)]
struct Thresholds {
    press: f32,
    release: f32,
}

/// Thresholds of the key of a direction, as fractions of the full deflection.
const DIRECTION: Thresholds = Thresholds {
    press: 0.5,
    release: 0.4,
};
/// Thresholds of the push, as fractions of the travel.
const PUSH: Thresholds = Thresholds {
    press: 0.9,
    release: 0.7,
};
/// Number of parts: four directions and the push.
pub(super) const PART_COUNT: usize = 5;
/// Thresholds of the parts: up, down, left, right, push.
const THRESHOLDS: [Thresholds; PART_COUNT] = [DIRECTION, DIRECTION, DIRECTION, DIRECTION, PUSH];
/// Longest time between two steps for which the pointer moves: after a longer gap, the deflection during
/// the gap is unknown.
const MAX_GAP: Duration = Duration::from_millis(100);

/// A joystick that is held, or whose return to the center is not emitted yet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stick {
    /// The index of the joystick.
    pub(super) index: usize,
    holder: Option<(Side, Finger)>,
    /// The position on the cap at which the fingertip pressed, in metres.
    pressed_at: Vec2,
    /// Fraction of the full deflection, of length 1 at most.
    deflection: Vec2,
    /// The axis values emitted last.
    axes: Vec2,
    /// The parts that are pressed: up, down, left, right, push.
    pressed: [bool; PART_COUNT],
    /// The time up to which it has moved the pointer.
    moved_until: Timestamp,
    /// Motion of the pointer that is less than a pixel and not emitted yet.
    remainder: Vec2,
}

impl Stick {
    /// Creates a centered stick that the touching fingertip holds.
    pub(super) fn new(index: usize, touch: &Touch) -> Self {
        Self {
            index,
            holder: Some((touch.side, touch.finger)),
            pressed_at: touch.position,
            deflection: Vec2::ZERO,
            axes: Vec2::ZERO,
            pressed: [false; PART_COUNT],
            moved_until: touch.time,
            remainder: Vec2::ZERO,
        }
    }

    /// Makes the touching fingertip hold a stick whose return to the center is not emitted yet.
    pub(super) fn grab(&mut self, touch: &Touch) {
        *self = Self {
            axes: self.axes,
            ..Self::new(self.index, touch)
        };
    }

    pub(super) fn is_held(&self) -> bool {
        self.holder.is_some()
    }

    pub(super) fn is_held_by(&self, touch: &Touch) -> bool {
        self.holder == Some((touch.side, touch.finger))
    }

    pub(super) fn is_held_by_hand(&self, hand: Side) -> bool {
        self.holder.is_some_and(|(side, _)| side == hand)
    }

    /// Follows the fingertip that holds it: presses and releases the keys of its parts.
    pub(super) fn deflect(&mut self, joystick: &Joystick, touch: &Touch, out: &mut DeviceOutput) {
        let deflection = (touch.position - self.pressed_at) / joystick.max_deflection;
        if !deflection.is_finite() {
            return;
        }
        self.deflection = deflection.clamp_length_max(1.0);
        let Vec2 { x, y } = self.deflection;
        let fractions = [y, -y, -x, x, touch.depth];
        self.release_parts(joystick, &fractions, touch.time, out);
        for (part, &fraction) in fractions.iter().enumerate() {
            let Some(action) = joystick.action(part) else {
                continue;
            };
            if !self.pressed[part] && fraction >= THRESHOLDS[part].press {
                let source = PressSource::Part(joystick.target, part as u8);
                self.pressed[part] = out.press(source, action, touch.time);
            }
        }
    }

    /// Releases the parts below their threshold. Runs before presses: a stick that flips from one side to
    /// the other never presses both.
    fn release_parts(
        &mut self,
        joystick: &Joystick,
        fractions: &[f32; PART_COUNT],
        time: Timestamp,
        out: &mut DeviceOutput,
    ) {
        for (part, &fraction) in fractions.iter().enumerate() {
            if self.pressed[part] && fraction < THRESHOLDS[part].release {
                out.release(PressSource::Part(joystick.target, part as u8), time);
                self.pressed[part] = false;
            }
        }
    }

    /// Ends the grip of the fingertip: releases all parts and centers the axes.
    pub(super) fn release(&mut self, joystick: &Joystick, touch: &Touch, out: &mut DeviceOutput) {
        for part in (0..PART_COUNT).filter(|&part| self.pressed[part]) {
            let source = PressSource::Part(joystick.target, part as u8);
            match touch.phase {
                Phase::Released | Phase::Left => out.release(source, touch.time),
                _ => out.cancel(source, touch.time),
            }
        }
        self.reset();
        self.emit_axes(joystick, touch.time, out);
    }

    /// Forgets holder, deflection and presses, without emitting anything.
    pub(super) fn reset(&mut self) {
        self.holder = None;
        self.deflection = Vec2::ZERO;
        self.pressed = [false; PART_COUNT];
    }

    /// Emits the axes that have changed. Returns `true` if both are at 0.
    pub(super) fn emit_axes(
        &mut self,
        joystick: &Joystick,
        time: Timestamp,
        out: &mut DeviceOutput,
    ) -> bool {
        let Some(axes) = joystick.axes else {
            return true;
        };
        let response = joystick.response(self.deflection);
        for (component, axis) in axes.into_iter().enumerate() {
            let value = response[component];
            if value != self.axes[component] && out.emit(time, EventKind::Axis(axis, value)) {
                self.axes[component] = value;
            }
        }
        self.axes == Vec2::ZERO
    }

    /// Moves the pointer for the time since the last call.
    pub(super) fn move_pointer(
        &mut self,
        joystick: &Joystick,
        time: Timestamp,
        out: &mut DeviceOutput,
    ) {
        let elapsed = time.since(self.moved_until).min(MAX_GAP);
        self.moved_until = time;
        let velocity = joystick.response(self.deflection) * joystick.pointer_speed_px_s;
        let motion = self.remainder + velocity * elapsed.as_secs_f32();
        let pixels = motion.round();
        self.remainder = motion - pixels;
        let (right, up) = (pixels.x as i32, pixels.y as i32);
        if (right, up) != (0, 0) {
            // Motion that does not fit into the event list is dropped: the pointer keeps moving anyway.
            out.emit(time, EventKind::MoveBy(right, -up));
        }
    }
}
