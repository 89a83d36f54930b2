//! A joystick that is held, or was until now.

use std::time::Duration;

use parry3d::math::Vec2;

use super::Joystick;
use crate::contact::{Phase, Touch};
use crate::device::{DeviceOutput, EventKind, PressSource};
use crate::hand::{Finger, Side};
use crate::time::Timestamp;

/// The share of the throw to a side at which its key goes down, and at which it comes up again.
const DIRECTION: (f32, f32) = (0.5, 0.4);
/// The share of the travel at which a push in counts, and at which it ends.
const PUSH: (f32, f32) = (0.9, 0.7);
/// Four directions and the push.
pub(super) const PARTS: usize = 5;
/// Where each part goes down and where it comes up.
const LEVELS: [(f32, f32); PARTS] = [DIRECTION, DIRECTION, DIRECTION, DIRECTION, PUSH];
/// The longest time between two frames for which the pointer moves: after a longer one nobody knows for how
/// much of it the stick stood there.
const LONGEST_FRAME: Duration = Duration::from_millis(100);

/// What is known of a joystick that is not in the middle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stick {
    /// The place of the joystick in its list.
    pub(super) place: usize,
    /// Who holds it.
    held_by: Option<(Side, Finger)>,
    /// Where on the cap the fingertip pressed, in metres.
    pressed_at: Vec2,
    /// Where it is pushed to, as shares of the reach.
    throw: Vec2,
    /// Where its axes stand.
    axes: Vec2,
    /// Which of up, down, left, right and the push are pressed.
    pressed: [bool; PARTS],
    /// The time up to which it has moved the pointer.
    moved_by: Timestamp,
    /// Pixels that are not a whole one yet.
    owed: Vec2,
}

impl Stick {
    /// One that the fingertip of a touch holds.
    pub(super) fn new(place: usize, touch: &Touch) -> Self {
        Self {
            place,
            held_by: Some((touch.side, touch.finger)),
            pressed_at: touch.position,
            throw: Vec2::ZERO,
            axes: Vec2::ZERO,
            pressed: [false; PARTS],
            moved_by: touch.time,
            owed: Vec2::ZERO,
        }
    }

    /// The fingertip of a touch takes it, before it was told that it is back in the middle.
    pub(super) fn grab(&mut self, touch: &Touch) {
        *self = Self {
            axes: self.axes,
            ..Self::new(self.place, touch)
        };
    }

    pub(super) fn is_held(&self) -> bool {
        self.held_by.is_some()
    }

    pub(super) fn is_of(&self, touch: &Touch) -> bool {
        self.held_by == Some((touch.side, touch.finger))
    }

    pub(super) fn is_of_hand(&self, hand: Side) -> bool {
        self.held_by.is_some_and(|(side, _)| side == hand)
    }

    /// The fingertip that holds it is somewhere else.
    pub(super) fn push(&mut self, joystick: &Joystick, touch: &Touch, out: &mut DeviceOutput) {
        let throw = (touch.position - self.pressed_at) / joystick.max_deflection;
        if !throw.is_finite() {
            return;
        }
        self.throw = throw.clamp_length_max(1.0);
        let Vec2 { x, y } = self.throw;
        let shares = [y, -y, -x, x, touch.depth];
        self.let_go_of_parts(joystick, &shares, touch.time, out);
        for (part, &share) in shares.iter().enumerate() {
            let Some(action) = joystick.action(part) else {
                continue;
            };
            if !self.pressed[part] && share >= LEVELS[part].0 {
                let owner = PressSource::Part(joystick.target, part as u8);
                self.pressed[part] = out.press(owner, action, touch.time);
            }
        }
    }

    /// Releases go first: a stick that goes over from one side to the other never presses both.
    fn let_go_of_parts(
        &mut self,
        joystick: &Joystick,
        shares: &[f32; PARTS],
        time: Timestamp,
        out: &mut DeviceOutput,
    ) {
        for (part, &share) in shares.iter().enumerate() {
            if self.pressed[part] && share < LEVELS[part].1 {
                out.release(PressSource::Part(joystick.target, part as u8), time);
                self.pressed[part] = false;
            }
        }
    }

    /// It is let go of, or its fingertip is lost.
    pub(super) fn let_go(&mut self, joystick: &Joystick, touch: &Touch, out: &mut DeviceOutput) {
        for part in (0..PARTS).filter(|&part| self.pressed[part]) {
            let owner = PressSource::Part(joystick.target, part as u8);
            match touch.phase {
                Phase::Released | Phase::Left => out.release(owner, touch.time),
                _ => out.cancel(owner, touch.time),
            }
        }
        self.forget();
        self.stand(joystick, touch.time, out);
    }

    /// Nobody holds it any more, and what it pressed is let go of.
    pub(super) fn forget(&mut self) {
        self.held_by = None;
        self.throw = Vec2::ZERO;
        self.pressed = [false; PARTS];
    }

    /// Brings the axes to where it is pushed; whether they are at 0.
    pub(super) fn stand(
        &mut self,
        joystick: &Joystick,
        time: Timestamp,
        out: &mut DeviceOutput,
    ) -> bool {
        let Some(axes) = joystick.axes else {
            return true;
        };
        let places = joystick.response(self.throw);
        for (side, axis) in axes.into_iter().enumerate() {
            let place = places[side];
            if place != self.axes[side] && out.emit(time, EventKind::Axis(axis, place)) {
                self.axes[side] = place;
            }
        }
        self.axes == Vec2::ZERO
    }

    /// Moves the pointer for the time since it did so last.
    pub(super) fn move_pointer(
        &mut self,
        joystick: &Joystick,
        time: Timestamp,
        out: &mut DeviceOutput,
    ) {
        let passed = time.since(self.moved_by).min(LONGEST_FRAME);
        self.moved_by = time;
        let speed = joystick.response(self.throw) * joystick.pointer_speed_px_s;
        let way = self.owed + speed * passed.as_secs_f32();
        let whole = way.round();
        self.owed = way - whole;
        let (right, up) = (whole.x as i32, whole.y as i32);
        if (right, up) != (0, 0) {
            // Pixels that find no room are lost: the stick goes on moving.
            out.emit(time, EventKind::MoveBy(right, -up));
        }
    }
}
