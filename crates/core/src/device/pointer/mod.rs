//! The arm as a pointer in space: it moves the cursor of the screen, clicks, drags, scrolls, and selects
//! targets in space.

mod anchored_frame;
mod arm_axes;
mod cursor;
mod direct;
mod dwell;
mod gesture;
mod gesture_set;
mod joint;
pub mod mode;
mod motion;
mod posture;
mod push;
mod rate;
mod ray;
mod selection;
mod settings;
mod trusted_hand;

pub use anchored_frame::AnchoredFrame;
pub use arm_axes::{ArmAxes, ArmAxis, ArmDirection};
pub use dwell::DwellSettings;
pub use gesture::{Gesture, PinchGaps};
pub use mode::PointingMode;
pub use selection::SelectionSpace;
pub use settings::{ClickMethod, CursorOutput, MAX_CLICKS, PointerSettings, ScrollSettings};

use parry3d::math::{Vec2, Vec3};

use self::arm_axes::ArmAxesState;
use self::cursor::Cursor;
use self::dwell::DwellDetector;
use self::gesture_set::GestureSet;
use self::mode::Aim;
use self::motion::MotionTracker;
use self::posture::HandPosture;
use self::selection::{CursorPoint, Selector};
use self::trusted_hand::TrustedHand;
use super::value_output::ValueEmitter;
use super::{
    Capabilities, Capability, CursorPosition, DETENT, DeviceInput, DeviceOutput, EventKind,
    KeyAction, PressSource, VirtualDevice,
};
use crate::hand::{Finger, Side};
use crate::time::Timestamp;

/// Limit of the scrolling that is not emitted yet, in the same units.
const MAX_SCROLL_REMAINDER: f32 = 20.0 * DETENT as f32;

/// Longest time between two steps that counts, in seconds: after a longer gap, the speed during the gap is
/// unknown.
const MAX_GAP: f32 = 0.1;

/// The part number of the dwell click as a press source; gestures have the numbers below.
const DWELL_PART: u8 = u8::MAX;

/// A hand that points: at the screen, if the layout has a pointer, and at targets in space.
///
/// Unless the settings name a hand, the first hand seen points, until [`VirtualDevice::release_all`]. All
/// gestures have hysteresis. When the hand, or the part of it that the mode needs, is lost, untrusted or
/// re-acquired, gestures are cancelled, and each has to be seen off before it counts again.
pub struct Pointer {
    screen: Option<ScreenPointer>,
    selector: Selector,
    /// The hand that points.
    side: Option<Side>,
}

/// The part of a pointer that moves the cursor of the screen.
struct ScreenPointer {
    settings: PointerSettings,
    motion: MotionTracker,
    cursor: Cursor,
    gestures: GestureSet,
    dwell: DwellDetector,
    /// Motion of the hand since a button was pressed, in pixels; the cursor stays up to the drag threshold.
    held_back: Vec2,
    is_dragging: bool,
    /// Scrolling that is not emitted yet, in 1/120 detents.
    scroll_remainder: Vec2,
    depth: Option<ValueEmitter>,
    axes: ArmAxesState,
    /// `true` if a mode that [starts at rest](PointingMode::starts_at_rest) has not been at rest since the hand was lost.
    awaits_rest: bool,
    /// `true` if the hand points into the range of the mode, and not beside it.
    is_in_range: bool,
    /// The time of the last step; `None` since the hand was lost.
    time: Option<Timestamp>,
}

impl Pointer {
    /// Creates a pointer. Without settings there is no cursor, and the index fingertip selects targets in
    /// space.
    pub fn new(settings: Option<PointerSettings>, spaces: Vec<SelectionSpace>) -> Self {
        Self {
            screen: settings.map(ScreenPointer::new),
            selector: Selector::new(spaces),
            side: None,
        }
    }

    /// Returns `true` if this hand points, or if none does yet. Without a side in the settings, the first hand points that is seen where
    /// the mode needs it: a camera also sends a hand that has left its view.
    fn is_pointing_hand(&mut self, hand: &TrustedHand) -> bool {
        let (side, screen) = (hand.pose().side, self.screen.as_ref());
        let configured = screen.and_then(|screen| screen.settings.side);
        if let Some(pointing) = configured.or(self.side) {
            return side == pointing;
        }
        let is_seen = match screen {
            Some(screen) => !hand.jumped() && screen.settings.mode.aim(hand).is_some(),
            None => hand.tip(Finger::Index).is_some(),
        };
        self.side = is_seen.then_some(side);
        // What had no room in the event list of a release is emitted in a step of any hand.
        true
    }
}

impl ScreenPointer {
    fn new(settings: PointerSettings) -> Self {
        let depth_at_rest = 0.5;
        Self {
            motion: MotionTracker::new(&settings),
            cursor: Cursor::new(&settings),
            gestures: GestureSet::new(&settings),
            dwell: DwellDetector::default(),
            held_back: Vec2::ZERO,
            is_dragging: false,
            scroll_remainder: Vec2::ZERO,
            depth: settings
                .depth
                .map(|output| ValueEmitter::new(settings.target, output, depth_at_rest)),
            axes: ArmAxesState::default(),
            awaits_rest: settings.mode.starts_at_rest(),
            is_in_range: false,
            time: None,
            settings,
        }
    }

    /// Follows the hand for one step. Returns `true` if it points anywhere.
    fn follow(&mut self, hand: &TrustedHand, out: &mut DeviceOutput) -> bool {
        let time = hand.pose().time;
        let before = self.time.replace(time).unwrap_or(time);
        let seconds = time.since(before).as_secs_f32().min(MAX_GAP);
        let aim = if hand.jumped() {
            None
        } else {
            self.settings.mode.aim(hand)
        };
        let Some(aim) = aim.map(|aim| self.after_rest(aim)) else {
            self.reset(time, out);
            return false;
        };
        self.is_in_range = aim.is_in_range();
        self.gestures
            .update(hand, &self.settings, seconds, time, out);
        self.move_cursor(aim, seconds, time, out);
        self.click_on_dwell(time, out);
        if let Aim::Posture(posture) = aim {
            self.drive_axes(&posture, time, out);
        }
        if let (Some(depth), Aim::Position(_)) = (&mut self.depth, aim) {
            depth.set((self.cursor.fractions().z * 1e3).round() / 1e3, time, out);
        }
        true
    }

    /// Returns the velocity, which is 0 until the mode has been at rest.
    fn after_rest(&mut self, aim: Aim) -> Aim {
        self.awaits_rest &= aim != Aim::Velocity(Vec3::ZERO);
        if self.awaits_rest {
            Aim::Velocity(Vec3::ZERO)
        } else {
            aim
        }
    }

    fn drive_axes(&mut self, posture: &HandPosture, time: Timestamp, out: &mut DeviceOutput) {
        let is_engaged = !self.is_disengaged(out);
        let gain = self.precision(out);
        let axes = &self.settings.axes;
        self.axes
            .update(axes, posture, (is_engaged, gain), (time, out));
    }

    /// Returns the factor of the precision gesture or key.
    fn precision(&self, out: &DeviceOutput) -> f32 {
        let is_precise = self.gestures.is_precise() || out.arbiter.is_pressed(KeyAction::Precision);
        if is_precise {
            self.settings.precision_factor
        } else {
            1.0
        }
    }

    fn move_cursor(&mut self, aim: Aim, seconds: f32, time: Timestamp, out: &mut DeviceOutput) {
        let motion = self.motion.update(aim, seconds);
        if self.gestures.is_scrolling() {
            self.cursor.hold();
            self.scroll(motion.delta.truncate(), time, out);
        } else if self.is_held(motion.delta, out) {
            self.cursor.hold();
        } else if let Some(position) = motion.first_position
            && !self.gestures.has_clutch()
        {
            self.cursor.move_to(position);
        } else {
            let gain = self.gain(motion.delta.truncate(), seconds, out);
            self.cursor
                .move_by(motion.delta * gain, self.motion.position());
        }
        self.cursor.initialise(self.motion.position());
        self.cursor.emit(time, out);
    }

    /// Returns `true` if the cursor stays, however the hand moves.
    fn is_held(&mut self, delta: Vec3, out: &DeviceOutput) -> bool {
        let is_pressing = self.gestures.is_pressing();
        if !is_pressing {
            self.held_back = Vec2::ZERO;
            self.is_dragging = false;
        }
        if self.is_disengaged(out) {
            return true;
        }
        if is_pressing && !self.is_dragging {
            self.held_back += delta.truncate();
            self.is_dragging = self.held_back.length() > self.settings.drag_threshold_px;
            return true;
        }
        !is_pressing && self.gestures.is_near()
    }

    /// Returns `true` if the wearer holds the pointer still: the clutch is off, or a key for it is held.
    fn is_disengaged(&self, out: &DeviceOutput) -> bool {
        self.gestures.is_clutch_released() || out.arbiter.is_pressed(KeyAction::Clutch)
    }

    /// Returns the factor from motion of the hand to motion of the cursor.
    fn gain(&self, delta: Vec2, seconds: f32, out: &DeviceOutput) -> f32 {
        let speed = if seconds > 0.0 {
            delta.length() / seconds
        } else {
            0.0
        };
        self.precision(out) * settings::gain(&self.settings.acceleration, speed)
    }

    fn scroll(&mut self, delta: Vec2, time: Timestamp, out: &mut DeviceOutput) {
        let Some(scroll) = self.settings.scroll else {
            return;
        };
        let limit = Vec2::splat(MAX_SCROLL_REMAINDER);
        let amount = delta * (DETENT as f32 / scroll.px_per_detent);
        self.scroll_remainder = (self.scroll_remainder + amount).clamp(-limit, limit);
        let whole = self.scroll_remainder.trunc();
        let event = EventKind::Scroll(whole.x as i32, whole.y as i32);
        if whole != Vec2::ZERO && out.emit(time, event) {
            self.scroll_remainder -= whole;
        }
    }

    fn click_on_dwell(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        let Some((settings, action)) = self.settings.dwell else {
            return;
        };
        let is_busy = self.gestures.is_pressing() || self.gestures.is_scrolling();
        if is_busy || self.is_disengaged(out) {
            self.dwell = DwellDetector::default();
            return;
        }
        let position = self.cursor.travelled();
        if self.dwell.update(settings, position, time) {
            let source = PressSource::Part(self.settings.target, DWELL_PART);
            out.tap(source, action, time);
        }
    }

    /// Handles the loss of the hand, or of the part of it that the mode needs.
    fn reset(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        self.gestures.cancel(self.settings.target, time, out);
        self.motion.reset();
        self.awaits_rest = self.settings.mode.starts_at_rest();
        self.is_in_range = false;
        self.time = None;
        self.dwell = DwellDetector::default();
        self.scroll_remainder = Vec2::ZERO;
        self.cursor.hold();
        self.axes.center(&self.settings.axes, time, out);
        if let Some(depth) = &mut self.depth {
            depth.return_to_rest(time, out);
        }
    }

    /// Returns the position of the cursor in space, in a mode that has one.
    fn point(&self) -> Option<CursorPoint> {
        match &self.settings.mode {
            PointingMode::Joint(joint) => {
                let point = joint.point(self.cursor.fractions());
                Some(CursorPoint::InEachSpace(point))
            }
            _ => None,
        }
    }
}

impl VirtualDevice for Pointer {
    fn add_capabilities(&self, required: &mut Capabilities) {
        self.selector.add_capabilities(required);
        let Some(ScreenPointer { settings, .. }) = &self.screen else {
            return;
        };
        match settings.output {
            CursorOutput::Absolute => required.insert(Capability::AbsoluteMotion),
            CursorOutput::Relative => required.insert(Capability::RelativeMotion),
            CursorOutput::None => {}
        }
        settings.axes.add_capabilities(required);
        if settings.scroll.is_some() {
            required.insert(Capability::Scroll);
        }
        if let Some(output) = settings.depth {
            output.add_capabilities(required);
        }
        let dwell = settings.dwell.iter().map(|(_, action)| action);
        let clicks = settings
            .clicks
            .iter()
            .map(|(_, action)| action)
            .chain(dwell);
        required.extend(clicks.filter_map(|action| action.required_capability()));
    }

    fn update(&mut self, input: &DeviceInput, out: &mut DeviceOutput) {
        let hand = TrustedHand::new(input);
        if !self.is_pointing_hand(&hand) {
            return;
        }
        let is_pointing = match &mut self.screen {
            Some(screen) => screen.follow(&hand, out),
            None => !hand.jumped(),
        };
        let point = match &self.screen {
            _ if !is_pointing => None,
            Some(screen) if screen.point().is_some() => screen.point(),
            _ => hand.tip(Finger::Index).map(CursorPoint::InWorld),
        };
        self.selector.update(point, input.pose, out);
    }

    fn release_all(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        if let Some(screen) = &mut self.screen {
            screen.reset(time, out);
        }
        self.selector.reset(time, out);
        self.side = None;
    }

    fn cursor(&self) -> Option<CursorPosition> {
        let screen = self.screen.as_ref().filter(|screen| screen.time.is_some());
        Some(CursorPosition {
            fractions: screen.map(|screen| screen.cursor.fractions()),
            in_spaces: self.selector.positions().collect(),
        })
    }
    fn is_pointing(&self) -> bool {
        self.screen
            .as_ref()
            .is_some_and(|screen| screen.is_in_range)
    }
}
