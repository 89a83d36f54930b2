//! Controls other than keys: one file per kind, with its schema and checks.

pub(super) mod joystick;
pub(super) mod knob;
pub(super) mod lever;
pub(super) mod pointer;
pub(super) mod radio;
pub(super) mod slider;
pub(super) mod space;
pub(super) mod toggle;
pub(super) mod touch_surface;
pub(super) mod trigger;
pub(super) mod valve;
pub(super) mod value_output;

/// Passes the kinds of controls on a board to a macro: field of the board, and schema.
///
/// A schema has a method `build`, which adds one control to the board of a builder. Controls are built in this order.
macro_rules! with_control_kinds {
    ($macro:ident) => {
        $macro! {
            toggles: toggle::ToggleSchema,
            radios: radio::RadioSchema,
            touch_surfaces: touch_surface::TouchSurfaceSchema,
            sliders: slider::SliderSchema,
            knobs: knob::KnobSchema,
            levers: lever::LeverSchema,
            valves: valve::ValveSchema,
            joysticks: joystick::JoystickSchema,
        }
    };
}
pub(super) use with_control_kinds;
