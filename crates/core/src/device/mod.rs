//! Stage 5: [`HandPose`] + [`Touches`](crate::contact::Touches) → [`OutputEvent`], [`TimedCommand`].
//!
//! One file or folder per kind of control. All devices of a layout share one [`KeyArbiter`].

use arrayvec::ArrayVec;
use parry3d::math::Vec3;

use crate::command::Command;
use crate::contact::surface::Scene;
use crate::contact::{Press, TargetId, Touch};
use crate::estimate::FingerBends;
use crate::hand::{InputValues, JointAngles, Side};
use crate::kinematics::HandPose;
use crate::names::named_enum;
use crate::time::Timestamp;

pub mod keycode;
mod key_names;
pub mod pressed_keys;
pub mod capabilities;
pub mod key_arbiter;
mod debounce;
mod target_index;
mod grips;
mod steps;
pub mod value_output;
pub mod pressure;
pub mod signals;
mod pending_returns;
pub mod keyboard;
pub mod toggle;
pub mod radio;
pub mod slider;
pub mod knob;
pub mod joystick;
pub mod scroll_ring;
pub mod radial_menu;
pub mod touch_surface;
pub mod xy_pad;
pub mod trigger;
pub mod pointer;

pub use capabilities::{Capabilities, Capability};
pub use key_arbiter::{
    KeyAction, KeyArbiter, Latch, Multitap, MultitapId, Multitaps, PressSource, Sequence,
    SequenceId, SequenceStep, TextId,
};
pub use keycode::{KeyCode, KeyKind};

/// An event for the operating system or a peer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutputEvent {
    /// The time at which it happened.
    pub time: Timestamp,
    /// The event itself.
    pub kind: EventKind,
}

/// One detent of the wheel, in the unit of [`EventKind::Scroll`].
pub const DETENT: i32 = 120;

/// The kind of an event and its data.
///
/// Each key that is down is released and each axis is set to 0 when tracking is lost, the layout changes or
/// the session ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EventKind {
    /// A press of a key or button.
    KeyDown(KeyCode),
    /// A release of a key or button.
    KeyUp(KeyCode),
    /// A character, independent of the keymap of the receiver.
    Character(char),
    /// Motion of the pointer in pixels: to the right, down.
    MoveBy(i32, i32),
    /// Position of the pointer on the screen, 0..=1: from left to right, from top to bottom.
    MoveTo(f32, f32),
    /// Rotation of the wheel, [`DETENT`] for one detent: to the right, up (away from the wearer).
    Scroll(i32, i32),
    /// Value of an axis of a gamepad or 6-DoF device, −1..=1 (triggers, throttle and brake 0..=1); 0 at rest.
    Axis(Axis, f32),
    /// Depth of a press on a target, as a fraction of its travel, for outputs with analog controls.
    Depth(TargetId, f32),
    /// Value of a control that keeps its position, such as a slider: 0..=1 of its range. The value of an
    /// endless knob is the number of its turns, negative for counter-clockwise. The value of a radial menu tells which of its
    /// sectors is highlighted, see [`RadialMenu::value`](radial_menu::RadialMenu::value).
    Value(TargetId, f32),
    /// Press of a key with a [signal](signals::Signal): its velocity, the speed of the fingertip as a fraction of a fast press, above
    /// 0 to 1; 0 for its release.
    Velocity(TargetId, f32),
    /// Selection of a target in space.
    Select(TargetId),
    /// End of the selection of a target.
    Unselect(TargetId),
}

impl EventKind {
    /// Returns `true` for a press of a key or button, and for a character.
    pub const fn is_press(self) -> bool {
        matches!(self, Self::KeyDown(_) | Self::Character(_))
    }
}

/// A command that a device issues.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedCommand {
    /// The time of the press or gesture that issues it.
    pub time: Timestamp,
    /// The command itself.
    pub command: Command,
}

/// The commands of one step, in order.
///
/// Each command needs a press or a gesture of its own, and a hand has five fingertips; further commands of
/// the same step are dropped.
pub type TimedCommands = ArrayVec<TimedCommand, 8>;

named_enum! {
    /// An axis of a gamepad or of a 6-DoF device. X points to the right; Y points up on a stick and away
    /// from the wearer on a 6-DoF device; Z points up. Rotations are right-handed about the axis.
    pub enum Axis ("axis") {
        /// Left stick, horizontal.
        LeftX = "LeftX",
        /// Left stick, vertical.
        LeftY = "LeftY",
        /// Right stick, horizontal.
        RightX = "RightX",
        /// Right stick, vertical.
        RightY = "RightY",
        /// Left trigger.
        LeftTrigger = "LeftTrigger",
        /// Right trigger.
        RightTrigger = "RightTrigger",
        /// Steering wheel, clockwise.
        Wheel = "Wheel",
        /// Rudder, to the right.
        Rudder = "Rudder",
        /// Throttle.
        Throttle = "Throttle",
        /// Brake.
        Brake = "Brake",
        /// Translation to the right.
        MoveX = "MoveX",
        /// Translation away from the wearer.
        MoveY = "MoveY",
        /// Translation up.
        MoveZ = "MoveZ",
        /// Rotation about X.
        TurnX = "TurnX",
        /// Rotation about Y.
        TurnY = "TurnY",
        /// Rotation about Z.
        TurnZ = "TurnZ",
    }
}

impl Axis {
    /// Returns `true` if it belongs to a gamepad, otherwise to a 6-DoF device.
    pub const fn is_gamepad(self) -> bool {
        self.index() < Self::MoveX.index()
    }

    /// Returns `true` if its range is 0..=1 instead of −1..=1.
    pub const fn is_trigger(self) -> bool {
        matches!(
            self,
            Self::LeftTrigger | Self::RightTrigger | Self::Throttle | Self::Brake
        )
    }
}

/// The events of one step, releases first.
///
/// In one step, ten fingers can each end one press and begin another, each with one modifier, 10 × (2 + 2)
/// events, and emit a depth and a value each, 10 × 2. A text has 32 characters at most, a text of a sequence 32 more, and the release
/// of all keys takes 52; values and velocities that do not fit follow in the next step.
pub type Events = ArrayVec<OutputEvent, 192>;

/// The input of a device: one hand in one step.
#[derive(Clone, Copy, Debug)]
pub struct DeviceInput<'a> {
    /// The targets of all controls.
    pub scene: &'a Scene,
    /// The joint angles of the hand.
    pub angles: &'a JointAngles,
    /// The bends of the fingers; none unless a device [needs](VirtualDevice::needs_bends) them or a target depends on them.
    pub bends: &'a FingerBends,
    /// The sticks, triggers and buttons of the glove.
    pub inputs: &'a InputValues,
    /// The pose of the hand, and its time.
    pub pose: &'a HandPose,
    /// The touches of the fingertips, in order of time for each finger.
    pub touches: &'a [Touch],
    /// The evidence of the presses among the touches; none for fingers that press by bending.
    pub presses: &'a [Press],
}

/// The output of a device.
#[derive(Debug)]
pub struct DeviceOutput<'a> {
    /// The presses of all devices of a layout.
    pub arbiter: &'a mut KeyArbiter,
    /// The events of this step.
    pub events: &'a mut Events,
    /// The commands of this step.
    pub commands: &'a mut TimedCommands,
}

impl DeviceOutput<'_> {
    /// Starts a press and emits its events, see [`KeyArbiter::press`]. Returns `false`, and presses nothing, if
    /// there is no room. A [`KeyAction::Command`] is issued even if the event list is full, so that a full
    /// list cannot suppress a pause; one that types, by a hand that may only point, is dropped like a key.
    pub fn press(&mut self, source: PressSource, action: KeyAction, time: Timestamp) -> bool {
        let is_issued = match action {
            KeyAction::Command(_) if self.arbiter.drops(source, action) => return true,
            KeyAction::Command(command) => {
                if command == Command::Zero {
                    self.arbiter.ask_to_zero(source);
                }
                self.issue(time, command)
            }
            _ => false,
        };
        let is_pressed = self.arbiter.press(source, action, time, self.events);
        self.arbiter.emit_changes(time, self.events);
        is_issued || is_pressed
    }

    /// Issues a command. Returns `false` if there is no room.
    pub fn issue(&mut self, time: Timestamp, command: Command) -> bool {
        self.commands
            .try_push(TimedCommand { time, command })
            .is_ok()
    }

    /// Ends the press of a source.
    pub fn release(&mut self, source: PressSource, time: Timestamp) {
        self.arbiter.release(|other| other == source);
        self.arbiter.emit_changes(time, self.events);
    }

    /// Ends the press of a source that was lost or slid off: it does not count as a tap.
    pub fn cancel(&mut self, source: PressSource, time: Timestamp) {
        self.arbiter.cancel(|other| other == source);
        self.arbiter.emit_changes(time, self.events);
    }

    /// Starts a press and ends it at once. Returns `false`, and has no effect, if there is no room.
    pub fn tap(&mut self, source: PressSource, action: KeyAction, time: Timestamp) -> bool {
        let is_pressed = self.press(source, action, time);
        self.release(source, time);
        is_pressed
    }

    /// Returns `true` if the session is paused: the events of the step are not sent, and only commands that end the pause are executed.
    /// The state of a control that outlasts the pause, such as the value of a slider, must not change.
    pub fn is_paused(&self) -> bool {
        self.arbiter.is_paused()
    }

    /// Emits an event that is neither a press nor a release. Returns `false` if there is no room.
    pub fn emit(&mut self, time: Timestamp, kind: EventKind) -> bool {
        self.arbiter.emit(time, kind, self.events)
    }
}

/// The maximum number of spaces in which the position of a cursor is reported.
pub const MAX_CURSOR_SPACES: usize = 4;

/// The position of the cursor of a pointer.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CursorPosition {
    /// The position in the whole range, 0..=1: to the right, up, towards the wearer. `None` without a cursor on the
    /// screen, and while the hand points nowhere.
    pub fractions: Option<Vec3>,
    /// The position in the frame of each space of the layout, in metres; `None` while it is unknown.
    pub in_spaces: ArrayVec<Option<Vec3>, MAX_CURSOR_SPACES>,
}

/// A kind of control: turns the touches of a hand into events.
pub trait VirtualDevice: Send {
    /// Adds the capabilities that an output needs for every event the device can emit.
    fn add_capabilities(&self, required: &mut Capabilities);

    /// Returns `true` if it depends on the [bends](DeviceInput::bends) of the fingers.
    fn needs_bends(&self) -> bool {
        false
    }

    /// Updates the device for one hand and one step.
    fn update(&mut self, input: &DeviceInput, out: &mut DeviceOutput);

    /// Returns the device to rest at `time`: tracking is lost, or the session pauses, changes the layout or
    /// ends. The [`KeyArbiter`] has already released all presses; the device resets its state, and emits the
    /// values and axes that return to rest.
    fn release_all(&mut self, time: Timestamp, out: &mut DeviceOutput);

    /// Switches off, at `time`, what a hand has left on, because the hand is lost. The presses of the hand have ended with its last
    /// step.
    fn release_hand(&mut self, _side: Side, _time: Timestamp, _out: &mut DeviceOutput) {}

    /// Returns the position of its cursor, for displays; `None` for a device without one.
    fn cursor(&self) -> Option<CursorPosition> {
        None
    }

    /// Returns `true` if a hand points somewhere with it.
    fn is_pointing(&self) -> bool {
        false
    }
}
