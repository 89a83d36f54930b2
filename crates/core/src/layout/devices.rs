//! The devices of a layout.

use super::model::{ControlKind, Layout};
use crate::device::joystick::Joysticks;
use crate::device::keyboard::Keyboard;
use crate::device::knob::Knobs;
use crate::device::pointer::Pointer;
use crate::device::pressure::Pressures;
use crate::device::radio::Radios;
use crate::device::slider::Sliders;
use crate::device::toggle::Toggles;
use crate::device::touch_surface::TouchSurfaces;
use crate::device::trigger::Triggers;
use crate::device::value_output::ValueOutput;
use crate::device::{Capabilities, VirtualDevice};

impl Layout {
    /// Returns the devices that handle the touches: one for all keys, and one for each other kind of control that is present.
    ///
    /// Their order is that of their events within a step.
    pub fn devices(&self) -> Vec<Box<dyn VirtualDevice>> {
        /// The device for all controls of a kind.
        macro_rules! device {
            ($kind:ident, $device:ident) => {{
                let settings: Vec<_> = self
                    .controls
                    .iter()
                    .filter_map(|control| match &control.kind {
                        ControlKind::$kind(settings) => Some(settings.clone()),
                        _ => None,
                    })
                    .collect();
                (!settings.is_empty())
                    .then(|| -> Box<dyn VirtualDevice> { Box::new($device::new(settings)) })
            }};
        }
        let devices = [
            Some(self.keyboard()),
            self.pressure_device(),
            device!(Toggle, Toggles),
            device!(Radio, Radios),
            device!(TouchSurface, TouchSurfaces),
            self.trigger_device(),
            device!(Slider, Sliders),
            device!(Knob, Knobs),
            device!(Joystick, Joysticks),
            self.pointer_device(),
        ];
        devices.into_iter().flatten().collect()
    }

    /// Returns everything that the layout can ever emit, including modifiers.
    pub fn required_capabilities(&self) -> Capabilities {
        let mut capabilities = Capabilities::default();
        for device in self.devices() {
            device.add_capabilities(&mut capabilities);
        }
        capabilities
    }

    fn keyboard(&self) -> Box<dyn VirtualDevice> {
        let keyboard = Keyboard::new(self.key_bindings());
        Box::new(keyboard.with_chords(&self.chords, self.chord_timeout))
    }

    fn pressure_device(&self) -> Option<Box<dyn VirtualDevice>> {
        let keys = self.keys.iter().map(|key| (key.face.target, key.output));
        let mut keys = keys.filter(|(_, output)| *output != ValueOutput::ValueOnly);
        let first = keys.next()?;
        Some(Box::new(Pressures::new([first].into_iter().chain(keys))))
    }

    fn trigger_device(&self) -> Option<Box<dyn VirtualDevice>> {
        if self.triggers.is_empty() {
            return None;
        }
        let triggers = self.triggers.iter().map(|(_, trigger)| *trigger);
        Some(Box::new(Triggers::new(triggers)))
    }

    fn pointer_device(&self) -> Option<Box<dyn VirtualDevice>> {
        if self.pointer.is_none() && self.spaces.is_empty() {
            return None;
        }
        let spaces = self.spaces.iter().map(|targets| targets.space.clone());
        Some(Box::new(Pointer::new(
            self.pointer.clone(),
            spaces.collect(),
        )))
    }
}
