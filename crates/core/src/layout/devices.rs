//! The devices of a layout.

use super::controls::with_control_devices;
use super::model::{ControlKind, Layout};
use crate::device::keyboard::Keyboard;
use crate::device::pointer::Pointer;
use crate::device::pressure::Pressures;
use crate::device::trigger::Triggers;
use crate::device::value_output::ValueOutput;
use crate::device::{Capabilities, VirtualDevice};

impl Layout {
    /// Returns the devices that handle the touches: one for all keys, and one for each other kind of control that is present.
    ///
    /// Their events within a step have the same order.
    pub fn devices(&self) -> Vec<Box<dyn VirtualDevice>> {
        let mut devices = Vec::from_iter([self.keyboard()]);
        devices.extend(self.pressure_device());
        /// Adds the device for all controls of each kind.
        macro_rules! add_devices {
            ($($(#[$doc:meta])* $kind:ident: $module:ident::$settings:ident, $device:ident;)+) => {$(
                let settings = self.controls.iter().filter_map(|control| match &control.kind {
                    ControlKind::$kind(settings) => Some(settings.clone()),
                    _ => None,
                });
                let settings: Vec<_> = settings.collect();
                if !settings.is_empty() {
                    devices.push(Box::new(crate::device::$module::$device::new(settings)));
                }
            )+};
        }
        with_control_devices!(add_devices);
        devices.extend(self.trigger_device());
        devices.extend(self.pointer_device());
        devices
    }

    /// Returns everything that the layout can ever emit, including modifiers.
    pub fn required_capabilities(&self) -> Capabilities {
        let mut capabilities = Capabilities::default();
        for device in self.devices() {
            device.add_capabilities(&mut capabilities);
        }
        self.multitaps.add_capabilities(&mut capabilities);
        for sequence in &self.sequences {
            sequence.add_capabilities(&mut capabilities);
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
