//! Touchscreens.

use parry3d::math::Vec2;

use super::MouseButton;
use crate::contact::{Phase, Touch};
use crate::device::{DeviceOutput, EventKind};
use crate::hand::{Finger, Side};

/// A touchscreen and the finger that controls it.
#[derive(Clone, Debug)]
pub(super) struct Touchscreen {
    half_extents: Vec2,
    finger: Option<(Side, Finger)>,
    /// The position emitted last since the finger touched, 0..=1.
    position: Option<Vec2>,
}

impl Touchscreen {
    pub(super) fn new(half_extents: Vec2) -> Self {
        Self {
            half_extents,
            finger: None,
            position: None,
        }
    }

    pub(super) fn reset(&mut self) {
        self.finger = None;
        self.position = None;
    }

    pub(super) fn handle(&mut self, touch: &Touch, button: MouseButton, out: &mut DeviceOutput) {
        let finger = (touch.side, touch.finger);
        if touch.phase == Phase::Touched && self.finger.is_none() {
            self.finger = Some(finger);
            self.position = None;
        }
        if self.finger != Some(finger) {
            return;
        }
        match touch.phase {
            Phase::Touched | Phase::Moved => {
                self.move_pointer(touch, out);
            }
            // If the position was not emitted, the button would press somewhere else.
            Phase::Pressed => {
                if self.move_pointer(touch, out) {
                    button.press(touch.time, out);
                }
            }
            Phase::Released => {
                self.move_pointer(touch, out);
                button.release(touch.time, out);
            }
            Phase::Left => {
                button.release(touch.time, out);
                self.reset();
            }
            Phase::Cancelled => {
                button.cancel(touch.time, out);
                self.reset();
            }
        }
    }

    /// Moves the pointer to the finger. Returns `false` if the list of events is full.
    fn move_pointer(&mut self, touch: &Touch, out: &mut DeviceOutput) -> bool {
        let offset = touch.position / (self.half_extents * 2.0);
        let position = Vec2::new(0.5 + offset.x, 0.5 - offset.y).clamp(Vec2::ZERO, Vec2::ONE);
        let is_there = self.position == Some(position)
            || out.emit(touch.time, EventKind::MoveTo(position.x, position.y));
        if is_there {
            self.position = Some(position);
        }
        is_there
    }
}
