//! A touch screen.

use parry3d::math::Vec2;

use super::Button;
use crate::contact::{Phase, Touch};
use crate::device::{DeviceOutput, EventKind};
use crate::hand::{Finger, Side};

/// A touch screen and the finger that counts.
#[derive(Clone, Debug)]
pub(super) struct Screen {
    half: Vec2,
    finger: Option<(Side, Finger)>,
    /// The place that was told last since the finger came.
    told: Option<Vec2>,
}

impl Screen {
    pub(super) fn new(half: Vec2) -> Self {
        Self {
            half,
            finger: None,
            told: None,
        }
    }

    pub(super) fn forget(&mut self) {
        self.finger = None;
        self.told = None;
    }

    pub(super) fn take(&mut self, touch: &Touch, button: Button, out: &mut DeviceOutput) {
        let finger = (touch.side, touch.finger);
        if touch.phase == Phase::Touched && self.finger.is_none() {
            self.finger = Some(finger);
            self.told = None;
        }
        if self.finger != Some(finger) {
            return;
        }
        match touch.phase {
            Phase::Touched | Phase::Moved => {
                self.point(touch, out);
            }
            // A press at a place that was not told would be one somewhere else.
            Phase::Pressed => {
                if self.point(touch, out) {
                    button.press(touch.time, out);
                }
            }
            Phase::Released => {
                self.point(touch, out);
                button.end(touch.time, out);
            }
            Phase::Left => {
                button.end(touch.time, out);
                self.forget();
            }
            Phase::Cancelled => {
                button.cancel(touch.time, out);
                self.forget();
            }
        }
    }

    /// Brings the pointer to the finger; whether it is there.
    fn point(&mut self, touch: &Touch, out: &mut DeviceOutput) -> bool {
        let share = touch.position / (self.half * 2.0);
        let place = Vec2::new(0.5 + share.x, 0.5 - share.y).clamp(Vec2::ZERO, Vec2::ONE);
        let is_there =
            self.told == Some(place) || out.emit(touch.time, EventKind::MoveTo(place.x, place.y));
        if is_there {
            self.told = Some(place);
        }
        is_there
    }
}
