//! Lines that a transcript does not have.

use crate::output::axis_state::AxisState;
use ademan_core::device::pressed_keys::PressedKeys;
use ademan_core::device::{EventKind, OutputEvent};
use ademan_core::time::Timestamp;

/// The number of missing lines, and the state after them.
#[derive(Clone, Debug, Default)]
pub(super) struct MissedLines {
    /// The number of lines; 0 if none is missing.
    pub count: u64,
    /// The time of the last event.
    pub time: Timestamp,
    pressed: PressedKeys,
    axes: AxisState,
}

impl MissedLines {
    /// Updates the state with an event, whether its line is missing or not.
    pub fn apply(&mut self, event: &OutputEvent) {
        self.time = event.time;
        match event.kind {
            EventKind::KeyDown(key) => _ = self.pressed.press(key),
            EventKind::KeyUp(key) => _ = self.pressed.release(key),
            EventKind::Axis(axis, value) => self.axes.set(axis, value),
            _ => {}
        }
    }

    /// Returns a copy if lines are missing, and counts from 0 again.
    pub fn take(&mut self) -> Option<Box<Self>> {
        let missed = (self.count > 0).then(|| Box::new(self.clone()));
        self.count = 0;
        missed
    }

    /// Returns the releases and centerings that are among the missing lines, for a transcript in which these keys are
    /// pressed and these axes deflected.
    pub fn releases_of<'a>(
        &'a self,
        pressed: &'a PressedKeys,
        axes: &'a AxisState,
    ) -> impl Iterator<Item = EventKind> + 'a {
        let released = pressed
            .release_order()
            .filter(|key| !self.pressed.contains(*key));
        let centered = axes
            .deflected_axes()
            .filter(|axis| self.axes.deflected_axes().all(|other| other != *axis));
        released
            .map(EventKind::KeyUp)
            .chain(centered.map(AxisState::center))
    }
}
