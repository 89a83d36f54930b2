//! 5 · [`HandPose`] + [`Touches`](crate::contact::Touches) → [`OutputEvent`].

use arrayvec::ArrayVec;

use crate::contact::surface::Scene;
use crate::contact::{TargetId, Touch};
use crate::estimate::JointAngles;
use crate::kinematics::HandPose;
use crate::names::named_enum;
use crate::time::Timestamp;

pub mod keycode;
pub mod capabilities;
pub mod pointer;
pub mod key_arbiter;
mod target_index;
mod grips;
mod pending_returns;
mod steps;
pub mod value_output;
pub mod keyboard;
pub mod radio;
pub mod toggle;
pub mod touch_surface;
pub mod trigger;
pub mod slider;
pub mod knob;
pub mod joystick;

pub use capabilities::{Capabilities, Capability};
pub use key_arbiter::{KeyAction, KeyArbiter, Latch, PressSource, TextId};
pub use keycode::{KeyCode, KeyKind};

/// Something for the operating system or a peer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutputEvent {
    /// When it happened.
    pub time: Timestamp,
    /// What happened.
    pub kind: EventKind,
}

/// What an output is to do.
///
/// What goes down comes up, and an axis that left 0 comes back to it, when the hand is lost, the layout
/// changes or the run ends.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum EventKind {
    /// A key or button goes down.
    KeyDown(KeyCode),
    /// A key or button comes up.
    KeyUp(KeyCode),
    /// A character is written, whichever keys the receiver's keymap has for it.
    Character(char),
    /// The pointer moves by so many pixels to the right and down.
    MoveBy(i32, i32),
    /// The pointer goes to this place on the screen: 0..=1 from left to right and from top to bottom.
    MoveTo(f32, f32),
    /// The wheel turns: to the right and up (away from the wearer), in 120ths of a click.
    Scroll(i32, i32),
    /// A stick, trigger or 6-DoF axis stands there: −1..=1; 0 is its rest, triggers stay at 0 or above.
    Axis(Axis, f32),
    /// How far a target is pushed in, 0..=1; for outputs that know analogue controls.
    Depth(TargetId, f32),
    /// Where a control stands that keeps its place, such as a slider: 0..=1 of its range; an
    /// endless knob counts its turns, negative the other way.
    Value(TargetId, f32),
    /// A target in space is selected.
    Select(TargetId),
    /// It no longer is.
    Unselect(TargetId),
    /// Something for the engine itself.
    Ask(Request),
}

/// What a control can ask of the engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// Let nothing out any more; the same again ends that.
    Pause,
    /// Put another layout of the setup in force: its place.
    Profile(u8),
    /// The same with the one after the one in force; after the last comes the first.
    NextProfile,
    /// Bring the boards to where the hand is.
    Recenter,
    /// Move the boards to the right, up and towards the wearer, in micrometres.
    Nudge([i32; 3]),
    /// Lift the far sides of the boards, in thousandths of a degree.
    Tilt(i32),
    /// Make the boards so many thousandths as large as they are. New boards are built outside the engine,
    /// by whoever runs it.
    Scale(u16),
}

named_enum! {
    /// An axis of a gamepad or of a 6-DoF device. X runs to the right, Y up on a stick and away from
    /// the wearer on a 6-DoF device, Z up; turns are right-handed about the axis.
    pub enum Axis ("axis") {
        /// The left stick, sideways.
        LeftX = "LeftX",
        /// The left stick, up and down.
        LeftY = "LeftY",
        /// The right stick, sideways.
        RightX = "RightX",
        /// The right stick, up and down.
        RightY = "RightY",
        /// The left trigger.
        LeftTrigger = "LeftTrigger",
        /// The right trigger.
        RightTrigger = "RightTrigger",
        /// Displacement to the right.
        MoveX = "MoveX",
        /// Displacement away from the wearer.
        MoveY = "MoveY",
        /// Displacement up.
        MoveZ = "MoveZ",
        /// Turn about X.
        TurnX = "TurnX",
        /// Turn about Y.
        TurnY = "TurnY",
        /// Turn about Z.
        TurnZ = "TurnZ",
    }
}

impl Axis {
    /// Whether a gamepad has it; otherwise a 6-DoF device does.
    pub const fn is_gamepad(self) -> bool {
        self.index() < Self::MoveX.index()
    }

    /// Whether it goes from 0 to one side only.
    pub const fn is_trigger(self) -> bool {
        matches!(self, Self::LeftTrigger | Self::RightTrigger)
    }
}

/// The events of one frame: releases first, presses second.
///
/// Ten fingers can each end one press and begin another in a frame, each with a modifier around it:
/// 10 × (2 + 2), tell a depth and a value: 10 × 2, a text has at most 32 characters, and everything that
/// is down, at most 48 codes, can be let go of after that.
pub type Events = ArrayVec<OutputEvent, 192>;

/// What a device sees of one hand in one frame.
#[derive(Clone, Copy, Debug)]
pub struct DeviceInput<'a> {
    /// Where the controls are.
    pub scene: &'a Scene,
    /// The angles of its joints.
    pub angles: &'a JointAngles,
    /// Where it is, and since when.
    pub pose: &'a HandPose,
    /// What its fingertips did, in order of time for each finger.
    pub touches: &'a [Touch],
}

/// Where a device puts what comes of it.
#[derive(Debug)]
pub struct DeviceOutput<'a> {
    /// What is down; shared by all devices of a layout.
    pub arbiter: &'a mut KeyArbiter,
    /// What goes out in this frame.
    pub events: &'a mut Events,
}

impl DeviceOutput<'_> {
    /// Begins a press, see [`Switchboard::press`]; whether it found room.
    pub fn press(&mut self, owner: PressSource, action: KeyAction, time: Timestamp) -> bool {
        let is_pressed = self.arbiter.press(owner, action, time, self.events);
        self.arbiter.emit_changes(time, self.events);
        is_pressed
    }

    /// Ends the press of this owner, who let go.
    pub fn release(&mut self, owner: PressSource, time: Timestamp) {
        self.arbiter.release(|other| other == owner);
        self.arbiter.emit_changes(time, self.events);
    }

    /// Ends the press of this owner, who was lost or slid off.
    pub fn cancel(&mut self, owner: PressSource, time: Timestamp) {
        self.arbiter.cancel(|other| other == owner);
        self.arbiter.emit_changes(time, self.events);
    }

    /// Begins a press and ends it at once; whether it found room.
    pub fn tap(&mut self, owner: PressSource, action: KeyAction, time: Timestamp) -> bool {
        let is_pressed = self.press(owner, action, time);
        self.release(owner, time);
        is_pressed
    }

    /// Tells of something that is neither down nor up; `false` when there is no room for it.
    pub fn emit(&mut self, time: Timestamp, action: EventKind) -> bool {
        self.arbiter.emit(time, action, self.events)
    }
}

/// A virtual device: it hears of every touch and says what should go out.
pub trait VirtualDevice: Send {
    /// Adds everything that it can ever send to an output, so that an output which cannot carry it is
    /// refused before anything is sent.
    fn add_capabilities(&self, needs: &mut Capabilities);

    /// Takes one frame of one hand.
    fn update(&mut self, seen: &DeviceInput, out: &mut DeviceOutput);

    /// Lets go of everything at `time`: tracking lost, paused, layout changed, exit. What is pressed on
    /// the switchboard is ended there for all devices at once; what is left are values that spring back,
    /// and what the device remembers.
    fn release_all(&mut self, time: Timestamp, out: &mut DeviceOutput);
}
