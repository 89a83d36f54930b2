//! Radio groups: one of several options is on, and pressing another one switches to it.

use super::target_index::TargetIndex;
use super::toggle::{ToggleOutput, value_event};
use super::{Capabilities, DeviceInput, DeviceOutput, PressSource, VirtualDevice};
use crate::contact::{Phase, TargetId, Touch};
use crate::hand::Side;
use crate::time::Timestamp;

/// A radio group.
#[derive(Clone, Debug, PartialEq)]
pub struct Radio {
    /// The options to choose from.
    pub options: Vec<RadioOption>,
    /// The index of the option that is on at the start; no event is emitted for it.
    pub initial: Option<usize>,
}

/// An option of a radio group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RadioOption {
    /// The target that is pressed.
    pub target: TargetId,
    /// The events in addition to its value. A [`ToggleOutput::Tap`] is tapped only when the option switches
    /// on.
    pub output: ToggleOutput,
}

/// The radio groups of a layout.
///
/// Pressing an option switches the previous one off, then the new one on. Pressing the option that is on has no effect. If the press
/// of an option does not fit into the event list, its group has no option on. The loss of a hand switches off an option that it has
/// switched on and that holds an action. During a pause, whose events are not sent, no option changes; one with a command issues it.
#[derive(Clone, Debug)]
pub struct Radios {
    /// The options of all groups, each with the index of its group.
    options: Vec<(RadioOption, usize)>,
    /// The index of the option that is on, and the hand that has switched it on, for each group.
    on: Vec<Option<(usize, Option<Side>)>>,
    index: TargetIndex,
}

impl Radios {
    /// Creates the groups with their initial options on.
    pub fn new(radios: Vec<Radio>) -> Self {
        let (mut options, mut on) = (Vec::new(), Vec::new());
        for (group, radio) in radios.into_iter().enumerate() {
            let first = options.len();
            let initial = radio.initial.filter(|&index| index < radio.options.len());
            on.push(initial.map(|index| (first + index, None)));
            options.extend(radio.options.into_iter().map(|option| (option, group)));
        }
        Self {
            index: TargetIndex::new(options.iter().map(|(option, _)| option.target)),
            options,
            on,
        }
    }

    fn switch_on(&mut self, index: usize, touch: &Touch, out: &mut DeviceOutput) {
        let (RadioOption { target, output }, group) = self.options[index];
        let (source, time) = (PressSource::Part(target, 0), touch.time);
        if out.is_paused() {
            if let Some(command) = output.command() {
                out.tap(source, command, time);
            }
            return;
        }
        if self.on[group].is_some_and(|(on, _)| on == index) {
            return;
        }
        self.switch_off(group, time, out);
        let is_on = match output {
            ToggleOutput::ValueOnly => true,
            ToggleOutput::Hold(action) => out.press(source, action, time),
            ToggleOutput::Tap(action) => out.tap(source, action, time),
        };
        if is_on {
            self.on[group] = Some((index, Some(touch.side)));
            out.emit(time, value_event(target, true));
        }
    }

    /// Switches off the option of a group that is on.
    fn switch_off(&mut self, group: usize, time: Timestamp, out: &mut DeviceOutput) {
        let Some((index, _)) = self.on[group].take() else {
            return;
        };
        let (RadioOption { target, output }, _) = self.options[index];
        if let ToggleOutput::Hold(_) = output {
            out.release(PressSource::Part(target, 0), time);
        }
        out.emit(time, value_event(target, false));
    }

    /// Returns the target of the option of a group that is on and holds an action, and the hand that has switched it on.
    fn held(&self, group: usize) -> Option<(TargetId, Option<Side>)> {
        let (index, by) = self.on[group]?;
        let (RadioOption { target, output }, _) = self.options[index];
        matches!(output, ToggleOutput::Hold(_)).then_some((target, by))
    }
}

impl VirtualDevice for Radios {
    fn add_capabilities(&self, required: &mut Capabilities) {
        let options = self.options.iter();
        required.extend(options.filter_map(|(option, _)| option.output.required_capability()));
    }

    fn update(&mut self, input: &DeviceInput, out: &mut DeviceOutput) {
        for touch in input.touches {
            if touch.phase == Phase::Pressed
                && let Some(index) = self.index.get(touch.target)
            {
                self.switch_on(index, touch, out);
            }
        }
    }

    fn release_all(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        for group in 0..self.on.len() {
            if self.held(group).is_some() {
                self.switch_off(group, time, out);
            }
        }
    }

    fn release_hand(&mut self, side: Side, time: Timestamp, out: &mut DeviceOutput) {
        for group in 0..self.on.len() {
            if let Some((target, by)) = self.held(group)
                && by == Some(side)
            {
                out.cancel(PressSource::Part(target, 0), time);
                self.switch_off(group, time, out);
            }
        }
    }
}
