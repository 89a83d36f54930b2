//! Radio groups: of several options one is on, and poking another switches over.

use super::target_index::Places;
use super::toggle::{ToggleOutput, value};
use super::{Capabilities, DeviceInput, DeviceOutput, PressSource, VirtualDevice};
use crate::contact::{Phase, TargetId};
use crate::time::Timestamp;

/// One group.
#[derive(Clone, Debug, PartialEq)]
pub struct Radio {
    /// What it can be switched to.
    pub options: Vec<RadioOption>,
    /// The place of the option that is on at the start; nothing goes out for that.
    pub initial: Option<usize>,
}

/// One option of a group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RadioOption {
    /// The target that is poked.
    pub target: TargetId,
    /// What goes on with the option; what it taps is tapped when it goes on only.
    pub output: ToggleOutput,
}

/// The radio groups of a layout.
///
/// An option goes on at a press; the one that was on goes off first. Poking the one that is on does
/// nothing, nor does anything else. An option that finds no room leaves its group with none on.
#[derive(Clone, Debug)]
pub struct Radios {
    /// The options of all groups, each with the place of its group.
    options: Vec<(RadioOption, usize)>,
    /// For each group the place of the option that is on.
    on: Vec<Option<usize>>,
    places: Places,
}

impl Radios {
    /// Each group stands at its start.
    pub fn new(radios: Vec<Radio>) -> Self {
        let (mut options, mut on) = (Vec::new(), Vec::new());
        for (group, radio) in radios.into_iter().enumerate() {
            let first = options.len();
            let starts = radio.initial.filter(|&place| place < radio.options.len());
            on.push(starts.map(|place| first + place));
            options.extend(radio.options.into_iter().map(|option| (option, group)));
        }
        Self {
            places: Places::new(options.iter().map(|(option, _)| option.target)),
            options,
            on,
        }
    }

    fn poke(&mut self, place: usize, time: Timestamp, out: &mut DeviceOutput) {
        let (RadioOption { target, output }, group) = self.options[place];
        if self.on[group] == Some(place) {
            return;
        }
        self.switch_off(group, time, out);
        let owner = PressSource::Part(target, 0);
        let is_on = match output {
            ToggleOutput::ValueOnly => true,
            ToggleOutput::Hold(action) => out.press(owner, action, time),
            ToggleOutput::Tap(action) => out.tap(owner, action, time),
        };
        if is_on {
            self.on[group] = Some(place);
            out.emit(time, value(target, true));
        }
    }

    fn switch_off(&mut self, group: usize, time: Timestamp, out: &mut DeviceOutput) {
        let Some(place) = self.on[group].take() else {
            return;
        };
        let (RadioOption { target, output }, _) = self.options[place];
        if let ToggleOutput::Hold(_) = output {
            out.release(PressSource::Part(target, 0), time);
        }
        out.emit(time, value(target, false));
    }
}

impl VirtualDevice for Radios {
    fn add_capabilities(&self, needs: &mut Capabilities) {
        let options = self.options.iter();
        needs.extend(options.filter_map(|(option, _)| option.output.required_capability()));
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
        for group in 0..self.on.len() {
            let holds = self.on[group]
                .is_some_and(|place| matches!(self.options[place].0.output, ToggleOutput::Hold(_)));
            if holds {
                self.switch_off(group, time, out);
            }
        }
    }
}
