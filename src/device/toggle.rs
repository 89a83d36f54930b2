//! Toggle switches: one poke turns one on, the next turns it off.

use super::target_index::Places;
use super::{
    Capabilities, Capability, DeviceInput, DeviceOutput, EventKind, KeyAction, PressSource,
    VirtualDevice,
};
use crate::contact::{Phase, TargetId};
use crate::time::Timestamp;

/// One switch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Toggle {
    /// The target that is poked.
    pub target: TargetId,
    /// What goes on with the switch.
    pub output: ToggleOutput,
}

/// What goes on with a switch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ToggleOutput {
    /// Only its value is told: 1 for on, 0 for off.
    ValueOnly,
    /// Something is pressed as long as it is on. When everything is let go of, it is off again.
    Hold(KeyAction),
    /// Something is tapped at each change, for a receiver that has the state itself. It stays as it is
    /// when everything is let go of.
    Tap(KeyAction),
}

impl ToggleOutput {
    /// What an output must be able to carry for it.
    pub fn required_capability(self) -> Option<Capability> {
        match self {
            Self::ValueOnly => None,
            Self::Hold(action) | Self::Tap(action) => action.required_capability(),
        }
    }
}

/// The toggle switches of a layout.
///
/// A switch changes at each press and at nothing else: not at the release, nor when the finger is
/// withdrawn or slides off.
#[derive(Clone, Debug)]
pub struct Toggles {
    toggles: Vec<(Toggle, bool)>,
    places: Places,
}

impl Toggles {
    /// All off.
    pub fn new(toggles: Vec<Toggle>) -> Self {
        Self {
            places: Places::new(toggles.iter().map(|toggle| toggle.target)),
            toggles: toggles.into_iter().map(|toggle| (toggle, false)).collect(),
        }
    }

    fn poke(&mut self, place: usize, time: Timestamp, out: &mut DeviceOutput) {
        let (Toggle { target, output }, is_on) = &mut self.toggles[place];
        let owner = PressSource::Part(*target, 0);
        let will_be_on = !*is_on;
        let has_changed = match *output {
            ToggleOutput::ValueOnly => true,
            ToggleOutput::Hold(action) if will_be_on => out.press(owner, action, time),
            ToggleOutput::Hold(_) => {
                out.release(owner, time);
                true
            }
            ToggleOutput::Tap(action) => out.tap(owner, action, time),
        };
        if has_changed {
            *is_on = will_be_on;
            out.emit(time, value(*target, *is_on));
        }
    }
}

/// What is told of a target that is on or off.
pub(super) fn value(target: TargetId, is_on: bool) -> EventKind {
    EventKind::Value(target, f32::from(u8::from(is_on)))
}

impl VirtualDevice for Toggles {
    fn add_capabilities(&self, needs: &mut Capabilities) {
        let toggles = self.toggles.iter();
        needs.extend(toggles.filter_map(|(toggle, _)| toggle.output.required_capability()));
    }

    fn update(&mut self, seen: &DeviceInput, out: &mut DeviceOutput) {
        for touch in seen.touches {
            if touch.phase == Phase::Pressed
                && let Some(place) = self.places.of(touch.target)
            {
                self.poke(place, touch.time, out);
            }
        }
    }

    fn release_all(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        for (toggle, is_on) in &mut self.toggles {
            let holds = matches!(toggle.output, ToggleOutput::Hold(_));
            if holds && std::mem::take(is_on) {
                out.emit(time, value(toggle.target, false));
            }
        }
    }
}
