//! A touch pad.

use std::time::Duration;

use arrayvec::ArrayVec;
use parry3d::math::Vec2;

use super::{Button, LEFT, RIGHT};
use crate::contact::{Phase, Touch};
use crate::device::{DeviceOutput, EventKind};
use crate::hand::{FINGERS_OF_BOTH_HANDS, Finger, Side};
use crate::time::Timestamp;

/// A touch that is shorter clicks, in case it did not move.
const TAP: Duration = Duration::from_millis(200);

/// A finger that comes back sooner after a click drags, in case it moves.
const TAP_AGAIN: Duration = Duration::from_millis(300);

/// Metres that a finger goes before it counts as moving: the dead zone of TouchFree (Ultraleap,
/// `InteractionConfigFile.cs`).
const DEAD_ZONE: f32 = 0.003;

/// From this speed on, in metres per second, the pointer does not get any faster.
const QUICK: f32 = 0.25;

/// A click of the wheel in the units of [`Action::Scroll`].
const CLICK: f32 = 120.0;

/// How a pad moves the pointer and the wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchpadSettings {
    /// Pixels for a metre of a slow finger.
    pub px_per_m: f32,
    /// A quick finger, from 250 mm/s on, moves the pointer `1 + acceleration` times as far; in between
    /// the factor grows with the speed.
    pub acceleration: f32,
    /// Clicks of the wheel for a metre of two fingers.
    pub detents_per_m: f32,
    /// Whether the page goes along with two fingers; else the wheel does.
    pub natural_scrolling: bool,
}

/// A pad and the fingers on it.
///
/// A gesture is from the first finger that comes to the last that goes. It counts its fingers: once there
/// were two, what stays of them moves no pointer, so that fingers that do not leave at once do not either.
#[derive(Clone, Debug)]
pub(super) struct Pad {
    settings: TouchpadSettings,
    /// Those of the gesture; none between two.
    fingers: ArrayVec<OnPad, FINGERS_OF_BOTH_HANDS>,
    began: Timestamp,
    most_fingers: usize,
    has_moved: bool,
    /// Whether a finger slid off or was lost, so that nothing comes of the rest.
    is_cancelled: bool,
    /// Whether it began soon after a click.
    may_drag: bool,
    is_dragging: bool,
    /// When the last click was.
    clicked: Option<Timestamp>,
    /// When the fingers were followed last.
    followed: Timestamp,
    /// What of the pointer's way, in pixels, and of the wheel's, in 120ths, has not been told yet.
    pointer_rest: Vec2,
    wheel_rest: Vec2,
}

#[derive(Clone, Copy, Debug)]
struct OnPad {
    finger: (Side, Finger),
    /// Where it came, in metres.
    start: Vec2,
    at: Vec2,
    /// Up to where it was followed.
    followed: Vec2,
}

impl Pad {
    pub(super) fn new(settings: TouchpadSettings) -> Self {
        Self {
            settings,
            fingers: ArrayVec::new(),
            began: Timestamp::default(),
            most_fingers: 0,
            has_moved: false,
            is_cancelled: false,
            may_drag: false,
            is_dragging: false,
            clicked: None,
            followed: Timestamp::default(),
            pointer_rest: Vec2::ZERO,
            wheel_rest: Vec2::ZERO,
        }
    }

    pub(super) fn forget(&mut self) {
        *self = Self::new(self.settings);
    }

    /// Takes note of where a finger is.
    pub(super) fn take(&mut self, touch: &Touch, button: Button, out: &mut DeviceOutput) {
        if touch.phase == Phase::Touched {
            self.come(touch);
            return;
        }
        let finger = (touch.side, touch.finger);
        let Some(place) = self.fingers.iter().position(|on| on.finger == finger) else {
            return;
        };
        self.fingers[place].at = touch.position;
        self.has_moved |= touch.position.distance(self.fingers[place].start) > DEAD_ZONE;
        if matches!(touch.phase, Phase::Left | Phase::Cancelled) {
            self.fingers.remove(place);
            self.go(touch, button, out);
        }
    }

    /// Moves the pointer or the wheel along with the fingers, up to `time`.
    pub(super) fn follow(&mut self, time: Timestamp, button: Button, out: &mut DeviceOutput) {
        let seconds = time.since(self.followed).as_secs_f32();
        self.followed = time;
        let count = self.fingers.len();
        if !self.has_moved || self.is_cancelled || count != self.most_fingers {
            return;
        }
        let mut way = Vec2::ZERO;
        for on in &mut self.fingers {
            way += on.way() / count as f32;
            on.followed = on.at;
        }
        match count {
            1 => {
                let will_drag = self.may_drag && !self.is_dragging;
                if will_drag {
                    self.is_dragging = button.press(time, out);
                }
                // Without its button a drag would be a mere motion.
                if !will_drag || self.is_dragging {
                    self.move_pointer(way, seconds, time, out);
                }
            }
            2 => self.turn_wheel(way, time, out),
            _ => {}
        }
    }

    fn come(&mut self, touch: &Touch) {
        let finger = (touch.side, touch.finger);
        // One that comes again has gone, told or not.
        self.fingers.retain(|on| on.finger != finger);
        if self.fingers.is_empty() {
            let since_click = self.clicked.take().map(|clicked| touch.time.since(clicked));
            *self = Self {
                began: touch.time,
                followed: touch.time,
                may_drag: since_click.is_some_and(|since| since < TAP_AGAIN),
                ..Self::new(self.settings)
            };
        }
        // Each finger is on one target at most, so there is room.
        let _ = self.fingers.try_push(OnPad {
            finger,
            start: touch.position,
            at: touch.position,
            followed: touch.position,
        });
        self.most_fingers = self.most_fingers.max(self.fingers.len());
    }

    /// A finger has gone.
    fn go(&mut self, touch: &Touch, button: Button, out: &mut DeviceOutput) {
        self.is_cancelled |= touch.phase == Phase::Cancelled;
        if std::mem::take(&mut self.is_dragging) {
            match touch.phase {
                Phase::Cancelled => button.cancel(touch.time, out),
                _ => button.end(touch.time, out),
            }
            self.may_drag = false;
        }
        let is_tap = self.fingers.is_empty()
            && !self.has_moved
            && !self.is_cancelled
            && touch.time.since(self.began) < TAP;
        let action = match self.most_fingers {
            1 if is_tap => LEFT,
            2 if is_tap => RIGHT,
            _ => return,
        };
        if button.click(action, touch.time, out) && action == LEFT {
            self.clicked = Some(touch.time);
        }
    }

    fn move_pointer(&mut self, way: Vec2, seconds: f32, time: Timestamp, out: &mut DeviceOutput) {
        let speed = way.length() / seconds;
        // Not a number where no time has gone by.
        let quickness = if speed > 0.0 {
            (speed / QUICK).min(1.0)
        } else {
            0.0
        };
        let factor = 1.0 + self.settings.acceleration * quickness;
        let pixels = way * self.settings.px_per_m * factor;
        self.pointer_rest += Vec2::new(pixels.x, -pixels.y);
        let whole = self.pointer_rest.trunc();
        let told = EventKind::MoveBy(whole.x as i32, whole.y as i32);
        if whole != Vec2::ZERO && out.emit(time, told) {
            self.pointer_rest -= whole;
        }
    }

    fn turn_wheel(&mut self, way: Vec2, time: Timestamp, out: &mut DeviceOutput) {
        let turn = way * self.settings.detents_per_m * CLICK;
        self.wheel_rest += if self.settings.natural_scrolling {
            -turn
        } else {
            turn
        };
        let whole = self.wheel_rest.trunc();
        let told = EventKind::Scroll(whole.x as i32, whole.y as i32);
        if whole != Vec2::ZERO && out.emit(time, told) {
            self.wheel_rest -= whole;
        }
    }
}

impl OnPad {
    /// Its way since it was followed last, without what lies in the dead zone around its start.
    fn way(&self) -> Vec2 {
        if self.followed != self.start {
            return self.at - self.followed;
        }
        let way = self.at - self.start;
        way * (1.0 - DEAD_ZONE / way.length()).max(0.0)
    }
}
