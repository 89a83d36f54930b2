//! Controls other than keys: one file per kind, with its schema, checks, words and drawing.
//!
//! A kind is a file with a [`KindSpec`] and a schema, and a line in `with_control_kinds!`. A kind with a device of its own has a
//! [`ControlModel`], too, and a line in `with_control_devices!`. Forms, tables, JSON Schema and every drawing follow from them.

pub(crate) mod joystick;
pub(crate) mod knob;
pub(crate) mod lever;
pub(super) mod pointer;
pub(crate) mod radial_menu;
pub(crate) mod radio;
pub(crate) mod slider;
pub(crate) mod scroll_ring;
pub(super) mod space;
pub(crate) mod toggle;
pub(crate) mod touch_surface;
pub(super) mod trigger;
pub(crate) mod valve;
pub(super) mod value_output;
pub(crate) mod xy_pad;

use parry3d::math::Vec2;

use super::model::{Face, Layout};
use super::render::drawing::{Canvas, Words};
use crate::device::value_output::NamedValue;

/// Passes the kinds of controls on a board to a macro: kind, field of the board, module and schema.
///
/// A module has a constant `KIND`. A schema has a method `build`, which adds one control to the board of a builder. Controls are built
/// in this order, and their targets are numbered in it.
macro_rules! with_control_kinds {
    ($macro:ident) => {
        $macro! {
            Toggle toggles: toggle::ToggleSchema,
            Radio radios: radio::RadioSchema,
            TouchSurface touch_surfaces: touch_surface::TouchSurfaceSchema,
            XyPad xy_pads: xy_pad::XyPadSchema,
            Slider sliders: slider::SliderSchema,
            Knob knobs: knob::KnobSchema,
            Lever levers: lever::LeverSchema,
            Valve valves: valve::ValveSchema,
            Joystick joysticks: joystick::JoystickSchema,
            ScrollRing scroll_rings: scroll_ring::ScrollRingSchema,
            RadialMenu radial_menus: radial_menu::RadialMenuSchema,
        }
    };
}
pub(crate) use with_control_kinds;

/// Passes the controls with a device of their own to a macro: kind, module of the device, settings and device.
///
/// The devices act in this order within a step. The settings implement [`ControlModel`].
macro_rules! with_control_devices {
    ($macro:ident) => {
        $macro! {
            /// A toggle switch.
            Toggle: toggle::Toggle, Toggles;
            /// A radio group.
            Radio: radio::Radio, Radios;
            /// A touchscreen or touchpad.
            TouchSurface: touch_surface::TouchSurface, TouchSurfaces;
            /// An XY pad.
            XyPad: xy_pad::XyPad, XyPads;
            /// A slider or a lever.
            Slider: slider::Slider, Sliders;
            /// A knob or a valve.
            Knob: knob::Knob, Knobs;
            /// A joystick.
            Joystick: joystick::Joystick, Joysticks;
            /// A scroll ring.
            ScrollRing: scroll_ring::ScrollRing, ScrollRings;
            /// A radial menu.
            RadialMenu: radial_menu::RadialMenu, RadialMenus;
        }
    };
}
pub(super) use with_control_devices;

/// A kind of control, for editors, with the fields of its table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KindSpec {
    /// Name of the table of its fields.
    pub table: &'static str,
    /// Name in messages.
    pub name: &'static str,
    /// Names on the screen: in English, in Spanish.
    pub words: [&'static str; 2],
    /// A new control as it is written in a file. `AT` stands for its center, `AT_RIGHT` for the position beside it; names become
    /// unique.
    pub new: &'static str,
}

/// The part of a control that a finger moves, and its travel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Handle {
    /// A switch, which a press turns on or off.
    Switch,
    /// A handle on a track along x.
    Line {
        /// Half of the length of the track, in metres.
        half_length: f32,
    },
    /// A rim around which a finger moves. Its mark is `start + turns × value` turns clockwise from the top.
    Turn {
        /// Radius at which a finger holds it, in metres.
        radius: f32,
        /// `true` if the value is a number of turns, otherwise 0..=1.
        is_endless: bool,
        /// Position of the value 0, in turns.
        start: f32,
        /// Change of the position from the value 0 to 1, in turns.
        turns: f32,
    },
    /// A stick that is pushed to all sides.
    Stick {
        /// Travel to each side, in metres.
        half: f32,
    },
    /// An area on which a finger slides.
    Area,
    /// A handle on an area, which is under the finger.
    Pad {
        /// Travel to each side, in metres.
        half: Vec2,
    },
}

/// One front of a control that is drawn.
pub(crate) struct Front<'a> {
    /// The layout.
    pub layout: &'a Layout,
    /// The outline and label.
    pub face: &'a Face,
    /// The index among the fronts of the control.
    pub index: usize,
    /// `true` if the control is a switch that is on.
    pub is_on: bool,
}

/// A control as displays, simulated people and checks need to know it.
pub(crate) trait ControlModel {
    /// Returns the part that a finger moves.
    fn handle(&self) -> Handle;

    /// Returns the values of a control that has several for a front. Empty for any other: each of its fronts has one, of the same
    /// index.
    fn values(&self) -> &[NamedValue] {
        &[]
    }

    /// Returns them to be numbered.
    fn values_mut(&mut self) -> &mut [NamedValue] {
        &mut []
    }

    /// Returns a value at the start; `None` if it has none until it is used.
    fn initial_value(&self, _index: usize) -> Option<f32> {
        None
    }

    /// Sets a value with which it is drawn: 0..=1, a number of turns, or 1 for on.
    fn set_value(&mut self, _index: usize, _value: f32) {}

    /// Returns the label of a value; `None` for a value that is a quantity or has no label.
    fn value_label(&self, _value: f32) -> Option<&str> {
        None
    }

    /// Returns the number of a value that is a quantity, as it is drawn; `None` for any other value.
    fn value_number(&self, index: usize) -> Option<f32> {
        self.initial_value(index)
    }

    /// Describes each front.
    fn describe(&self, words: &Words) -> Vec<String>;

    /// Draws what is below the fronts, in the axes of the board.
    fn draw_below(&self, _faces: &[Face], _canvas: &mut Canvas) {}

    /// Draws a front in its own axes, in millimetres, y down.
    fn draw(&self, front: &Front, canvas: &mut Canvas);
}
