//! Controls other than keys: each kind has its form in the file and becomes a device.

mod drives;
pub mod joystick;
pub mod knob;
pub mod lever;
pub mod radio;
pub mod slider;
pub mod pointer;
pub mod space;
pub mod toggle;
pub mod touch_surface;
pub mod trigger;
pub mod valve;

pub use drives::Drives;

use super::model::{Face, Layout};
use crate::device::VirtualDevice;
use crate::device::joystick::{Joystick, Joysticks};
use crate::device::keyboard::Keyboard;
use crate::device::knob::{Knob, Knobs};
use crate::device::pointer::Pointer;
use crate::device::radio::{Radio, Radios};
use crate::device::slider::{Slider, Sliders};
use crate::device::toggle::{Toggle, Toggles};
use crate::device::touch_surface::{TouchSurface, TouchSurfaces};
use crate::device::trigger::Triggers;

/// A control that is no key.
#[derive(Clone, Debug, PartialEq)]
pub struct Control {
    /// What is seen of it, target by target.
    pub faces: Vec<Face>,
    /// What it is and does.
    pub kind: ControlKind,
}

/// What a control is and does.
#[derive(Clone, Debug, PartialEq)]
pub enum ControlKind {
    /// A toggle switch.
    Toggle(Toggle),
    /// A radio group.
    Radio(Radio),
    /// A touch screen or touch pad.
    TouchSurface(TouchSurface),
    /// A slider or a lever.
    Slider(Slider),
    /// A knob or a valve.
    Knob(Knob),
    /// A joystick.
    Joystick(Joystick),
}

/// One device for all keys, and one for each other kind of control that the layout has.
pub(super) fn devices(layout: &Layout) -> Vec<Box<dyn VirtualDevice>> {
    let keyboard =
        Keyboard::new(layout.key_bindings()).with_chords(&layout.chords, layout.chord_timeout);
    let mut devices: Vec<Box<dyn VirtualDevice>> = vec![Box::new(keyboard)];
    let mut toggles = Vec::new();
    let (mut radios, mut touch_surfaces) = (Vec::new(), Vec::new());
    let (mut sliders, mut knobs, mut joysticks) = (Vec::new(), Vec::new(), Vec::new());
    for control in &layout.controls {
        match &control.kind {
            ControlKind::Toggle(toggle) => toggles.push(*toggle),
            ControlKind::Radio(radio) => radios.push(radio.clone()),
            ControlKind::TouchSurface(surface) => touch_surfaces.push(*surface),
            ControlKind::Slider(slider) => sliders.push(*slider),
            ControlKind::Knob(knob) => knobs.push(*knob),
            ControlKind::Joystick(joystick) => joysticks.push(*joystick),
        }
    }
    if !toggles.is_empty() {
        devices.push(Box::new(Toggles::new(toggles)));
    }
    if !radios.is_empty() {
        devices.push(Box::new(Radios::new(radios)));
    }
    if !touch_surfaces.is_empty() {
        devices.push(Box::new(TouchSurfaces::new(touch_surfaces)));
    }
    if !layout.triggers.is_empty() {
        let triggers = layout.triggers.iter().map(|(_, trigger)| *trigger);
        devices.push(Box::new(Triggers::new(triggers)));
    }
    if !sliders.is_empty() {
        devices.push(Box::new(Sliders::new(sliders)));
    }
    if !knobs.is_empty() {
        devices.push(Box::new(Knobs::new(knobs)));
    }
    if !joysticks.is_empty() {
        devices.push(Box::new(Joysticks::new(joysticks)));
    }
    if layout.pointer.is_some() || !layout.spaces.is_empty() {
        let spaces = layout.spaces.iter().map(|scenery| scenery.space.clone());
        let pointer = Pointer::new(layout.pointer.clone(), spaces.collect());
        devices.push(Box::new(pointer));
    }
    devices
}
