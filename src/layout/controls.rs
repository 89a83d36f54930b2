//! Controls other than keys: each kind has its form in the file and becomes a device.

mod drives;
pub mod toggle;

pub use drives::Drives;

use super::keyboard::{Front, Layout};
use crate::device::VirtualDevice;
use crate::device::keyboard::Keyboard;
use crate::device::toggle::Toggles;

/// A control that is no key.
#[derive(Clone, Debug, PartialEq)]
pub struct Control {
    /// What is seen of it, target by target.
    pub fronts: Vec<Front>,
    /// What it is and does.
    pub kind: Kind,
}

/// What a control is and does.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// A toggle switch.
    Toggle(crate::device::toggle::Toggle),
}

/// One device for all keys, and one for each other kind of control that the layout has.
pub(super) fn devices(layout: &Layout) -> Vec<Box<dyn VirtualDevice>> {
    let mut devices: Vec<Box<dyn VirtualDevice>> =
        vec![Box::new(Keyboard::new(layout.keyboard_bindings()))];
    let mut toggles = Vec::new();
    for control in &layout.controls {
        match &control.kind {
            Kind::Toggle(toggle) => toggles.push(*toggle),
        }
    }
    if !toggles.is_empty() {
        devices.push(Box::new(Toggles::new(toggles)));
    }
    devices
}
