//! Toggle switches: a press turns one on, the next press turns it off.

use std::time::Duration;

use super::debounce::Debouncer;
use super::target_index::TargetIndex;
use super::{
    Capabilities, Capability, DeviceInput, DeviceOutput, EventKind, KeyAction, PressSource,
    VirtualDevice,
};
use crate::contact::{Phase, TargetId, Touch};
use crate::hand::Side;
use crate::time::Timestamp;

/// The time after a release during which a switch ignores presses, as keys do by default.
const DEBOUNCE: Duration = Duration::from_millis(40);

/// A toggle switch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Toggle {
    /// The target that is pressed.
    pub target: TargetId,
    /// The events in addition to its value.
    pub output: ToggleOutput,
}

/// The events of a switch in addition to [`EventKind::Value`], 1 for on and 0 for off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ToggleOutput {
    /// Nothing else.
    ValueOnly,
    /// The action is held while the switch is on. [`VirtualDevice::release_all`], and the loss of the hand that has turned it on,
    /// turn the switch off.
    Hold(KeyAction),
    /// The action is tapped at each change, for receivers that keep the state themselves.
    /// [`VirtualDevice::release_all`] leaves the switch as it is.
    Tap(KeyAction),
}

impl ToggleOutput {
    /// Returns the capability that an output needs for it.
    pub fn required_capability(self) -> Option<Capability> {
        match self {
            Self::ValueOnly => None,
            Self::Hold(action) | Self::Tap(action) => action.required_capability(),
        }
    }

    /// Returns the command of the action, if it is one.
    pub(super) fn command(self) -> Option<KeyAction> {
        match self {
            Self::Hold(action @ KeyAction::Command(_))
            | Self::Tap(action @ KeyAction::Command(_)) => Some(action),
            _ => None,
        }
    }
}

/// The toggle switches of a layout.
///
/// A switch changes only when it is pressed: not on release, not when the finger leaves or slides off, and not within 40 ms of a
/// release. During a pause, whose events are not sent, only a switch changes that is off after the pause, or that issues a command.
#[derive(Clone, Debug)]
pub struct Toggles {
    /// The switches, each with the hand that has turned it on.
    toggles: Vec<(Toggle, Option<Side>)>,
    index: TargetIndex,
    debouncer: Debouncer,
}

impl Toggles {
    /// Creates the switches, all off.
    pub fn new(toggles: Vec<Toggle>) -> Self {
        Self {
            index: TargetIndex::new(toggles.iter().map(|toggle| toggle.target)),
            debouncer: Debouncer::new(toggles.len()),
            toggles: toggles.into_iter().map(|toggle| (toggle, None)).collect(),
        }
    }

    fn switch(&mut self, index: usize, touch: &Touch, out: &mut DeviceOutput) {
        let (Toggle { target, output }, on_by) = &mut self.toggles[index];
        let is_kept = !matches!(output, ToggleOutput::Hold(_)) && output.command().is_none();
        if is_kept && out.is_paused() {
            return;
        }
        let (source, time) = (PressSource::Part(*target, 0), touch.time);
        let will_be_on = on_by.is_none();
        let has_changed = match *output {
            ToggleOutput::ValueOnly => true,
            ToggleOutput::Hold(action) if will_be_on => out.press(source, action, time),
            ToggleOutput::Hold(_) => {
                out.release(source, time);
                true
            }
            ToggleOutput::Tap(action) => out.tap(source, action, time),
        };
        if has_changed {
            *on_by = will_be_on.then_some(touch.side);
            out.emit(time, value_event(*target, will_be_on));
        }
    }
}

/// Returns the value event of a target that is on or off.
pub(super) fn value_event(target: TargetId, is_on: bool) -> EventKind {
    EventKind::Value(target, f32::from(u8::from(is_on)))
}

impl VirtualDevice for Toggles {
    fn add_capabilities(&self, required: &mut Capabilities) {
        let toggles = self.toggles.iter();
        required.extend(toggles.filter_map(|(toggle, _)| toggle.output.required_capability()));
    }

    fn update(&mut self, input: &DeviceInput, out: &mut DeviceOutput) {
        for touch in input.touches {
            let Some(index) = self.index.get(touch.target) else {
                continue;
            };
            match touch.phase {
                Phase::Pressed if !self.debouncer.is_bounce(index, touch.time, DEBOUNCE) => {
                    self.switch(index, touch, out);
                }
                // Also the end of a press that was ignored, so that noise switches once.
                Phase::Released | Phase::Cancelled => {
                    self.debouncer.record_release(index, touch.time);
                }
                _ => {}
            }
        }
    }

    fn release_all(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        self.debouncer.reset();
        for (toggle, on_by) in &mut self.toggles {
            let holds = matches!(toggle.output, ToggleOutput::Hold(_));
            if holds && on_by.take().is_some() {
                out.emit(time, value_event(toggle.target, false));
            }
        }
    }

    fn release_hand(&mut self, side: Side, time: Timestamp, out: &mut DeviceOutput) {
        for (toggle, on_by) in &mut self.toggles {
            let holds = matches!(toggle.output, ToggleOutput::Hold(_));
            if holds && on_by.take_if(|by| *by == side).is_some() {
                out.cancel(PressSource::Part(toggle.target, 0), time);
                out.emit(time, value_event(toggle.target, false));
            }
        }
    }
}
