//! Touchpads.

use std::time::Duration;

use arrayvec::ArrayVec;
use parry3d::math::Vec2;

use super::{LEFT, MouseButton, RIGHT};
use crate::contact::{Phase, Touch};
use crate::device::{DETENT, DeviceOutput, EventKind};
use crate::hand::{FINGERS_OF_BOTH_HANDS, Finger, Side};
use crate::time::Timestamp;

/// Longest touch without motion that clicks.
const TAP_TIME: Duration = Duration::from_millis(200);

/// Longest time after a click at which a touch that moves begins a drag (tap-and-drag).
const TAP_DRAG_TIME: Duration = Duration::from_millis(300);

/// Distance that a finger travels before it moves the pointer, in metres. Dead zone of TouchFree (Ultraleap,
/// `InteractionConfigFile.cs`).
const DEAD_ZONE: f32 = 0.003;

/// Speed of a finger at which the acceleration is full, in metres per second.
const FAST: f32 = 0.25;

/// The pointer and scroll speed of a touchpad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchpadSettings {
    /// Pointer motion of a slow finger, in pixels per metre.
    pub px_per_m: f32,
    /// A finger at 250 mm/s or more moves the pointer `1 + acceleration` times as far as a slow one. Below,
    /// the factor is linear in the speed.
    pub acceleration: f32,
    /// Scroll distance of two fingers, in detents per metre.
    pub detents_per_m: f32,
    /// `true` if the content moves with the fingers (natural scrolling), instead of the view.
    pub natural_scrolling: bool,
}

/// A touchpad and the fingers on it.
///
/// A gesture lasts from the first finger down to the last finger up. Its finger count is the maximum since
/// it began: after a two-finger gesture the finger that is lifted last does not move the pointer.
#[derive(Clone, Debug)]
pub(super) struct Touchpad {
    settings: TouchpadSettings,
    fingers: ArrayVec<PadFinger, FINGERS_OF_BOTH_HANDS>,
    began: Timestamp,
    max_fingers: usize,
    has_moved: bool,
    /// `true` if a finger slid off, was lost or lifted in a gap: the rest of the gesture has no effect.
    is_cancelled: bool,
    /// `true` if the gesture began soon after a click.
    may_drag: bool,
    is_dragging: bool,
    last_click: Option<Timestamp>,
    /// The time up to which motion is emitted.
    moved_until: Timestamp,
    /// Pointer motion that is not emitted yet, in pixels.
    pointer_remainder: Vec2,
    /// Scrolling that is not emitted yet, in 1/120 detents.
    scroll_remainder: Vec2,
}

/// A finger on the pad. Positions are in metres.
#[derive(Clone, Copy, Debug)]
struct PadFinger {
    id: (Side, Finger),
    start: Vec2,
    position: Vec2,
    /// The position up to which motion is emitted.
    moved_to: Vec2,
}

impl Touchpad {
    pub(super) fn new(settings: TouchpadSettings) -> Self {
        Self {
            settings,
            fingers: ArrayVec::new(),
            began: Timestamp::default(),
            max_fingers: 0,
            has_moved: false,
            is_cancelled: false,
            may_drag: false,
            is_dragging: false,
            last_click: None,
            moved_until: Timestamp::default(),
            pointer_remainder: Vec2::ZERO,
            scroll_remainder: Vec2::ZERO,
        }
    }

    pub(super) fn reset(&mut self) {
        *self = Self::new(self.settings);
    }

    /// Updates the fingers; emits clicks and the end of a drag. A finger that lifts [in a gap](crate::kinematics::HandPose::is_after_gap)
    /// does not click: it may have moved.
    pub(super) fn handle(
        &mut self,
        touch: &Touch,
        is_after_gap: bool,
        button: MouseButton,
        out: &mut DeviceOutput,
    ) {
        if touch.phase == Phase::Touched {
            self.finger_down(touch);
            return;
        }
        let id = (touch.side, touch.finger);
        let Some(index) = self.fingers.iter().position(|finger| finger.id == id) else {
            return;
        };
        self.fingers[index].position = touch.position;
        self.has_moved |= touch.position.distance(self.fingers[index].start) > DEAD_ZONE;
        if matches!(touch.phase, Phase::Left | Phase::Cancelled) {
            self.fingers.remove(index);
            self.is_cancelled |= is_after_gap;
            self.finger_up(touch, button, out);
        }
    }

    /// Emits pointer motion or scrolling for the motion of the fingers up to `time`.
    pub(super) fn emit_motion(
        &mut self,
        time: Timestamp,
        button: MouseButton,
        out: &mut DeviceOutput,
    ) {
        let seconds = time.since(self.moved_until).as_secs_f32();
        self.moved_until = time;
        let count = self.fingers.len();
        if !self.has_moved || self.is_cancelled || count != self.max_fingers {
            return;
        }
        let mut motion = Vec2::ZERO;
        for finger in &mut self.fingers {
            motion += finger.motion() / count as f32;
            finger.moved_to = finger.position;
        }
        match count {
            1 => {
                let begins_drag = self.may_drag && !self.is_dragging;
                if begins_drag {
                    self.is_dragging = button.press(time, out);
                }
                // Without its button a drag would be plain motion.
                if !begins_drag || self.is_dragging {
                    self.move_pointer(motion, seconds, time, out);
                }
            }
            2 => self.scroll(motion, time, out),
            _ => {}
        }
    }

    fn finger_down(&mut self, touch: &Touch) {
        let id = (touch.side, touch.finger);
        // A finger that touches again has left before, whether or not that was reported.
        self.fingers.retain(|finger| finger.id != id);
        if self.fingers.is_empty() {
            let since_click = self.last_click.take().map(|click| touch.time.since(click));
            *self = Self {
                began: touch.time,
                moved_until: touch.time,
                may_drag: since_click.is_some_and(|since| since < TAP_DRAG_TIME),
                ..Self::new(self.settings)
            };
        }
        // Each finger is on one target at most, so there is room.
        let _ = self.fingers.try_push(PadFinger {
            id,
            start: touch.position,
            position: touch.position,
            moved_to: touch.position,
        });
        self.max_fingers = self.max_fingers.max(self.fingers.len());
    }

    fn finger_up(&mut self, touch: &Touch, button: MouseButton, out: &mut DeviceOutput) {
        self.is_cancelled |= touch.phase == Phase::Cancelled;
        if std::mem::take(&mut self.is_dragging) {
            match touch.phase {
                Phase::Cancelled => button.cancel(touch.time, out),
                _ => button.release(touch.time, out),
            }
            self.may_drag = false;
        }
        let is_tap = self.fingers.is_empty()
            && !self.has_moved
            && !self.is_cancelled
            && touch.time.since(self.began) < TAP_TIME;
        let action = match self.max_fingers {
            1 if is_tap => LEFT,
            2 if is_tap => RIGHT,
            _ => return,
        };
        if button.click(action, touch.time, out) && action == LEFT {
            self.last_click = Some(touch.time);
        }
    }

    fn move_pointer(
        &mut self,
        motion: Vec2,
        seconds: f32,
        time: Timestamp,
        out: &mut DeviceOutput,
    ) {
        let speed = motion.length() / seconds;
        // The speed is NaN if neither time nor motion has passed.
        let fraction = if speed > 0.0 {
            (speed / FAST).min(1.0)
        } else {
            0.0
        };
        let factor = 1.0 + self.settings.acceleration * fraction;
        let pixels = motion * self.settings.px_per_m * factor;
        self.pointer_remainder += Vec2::new(pixels.x, -pixels.y);
        let whole = self.pointer_remainder.trunc();
        let event = EventKind::MoveBy(whole.x as i32, whole.y as i32);
        if whole != Vec2::ZERO && out.emit(time, event) {
            self.pointer_remainder -= whole;
        }
    }

    fn scroll(&mut self, motion: Vec2, time: Timestamp, out: &mut DeviceOutput) {
        let amount = motion * self.settings.detents_per_m * DETENT as f32;
        self.scroll_remainder += if self.settings.natural_scrolling {
            -amount
        } else {
            amount
        };
        let whole = self.scroll_remainder.trunc();
        let event = EventKind::Scroll(whole.x as i32, whole.y as i32);
        if whole != Vec2::ZERO && out.emit(time, event) {
            self.scroll_remainder -= whole;
        }
    }
}

impl PadFinger {
    /// Returns the motion that is not emitted yet, without the dead zone around the start.
    fn motion(&self) -> Vec2 {
        if self.moved_to != self.start {
            return self.position - self.moved_to;
        }
        let motion = self.position - self.start;
        motion * (1.0 - DEAD_ZONE / motion.length()).max(0.0)
    }
}
