//! The axes that are off center.

use ademan_core::device::{Axis, EventKind};

/// The set of axes that are off center. Every output with axes tracks it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct AxisState([bool; Axis::COUNT]);

impl AxisState {
    /// Records the position of an axis; 0 is its center.
    pub fn set(&mut self, axis: Axis, value: f32) {
        self.0[axis.index()] = value != 0.0;
    }

    /// Returns the axes that are off center, in the order of [`Axis::ALL`].
    pub fn deflected_axes(&self) -> impl Iterator<Item = Axis> + '_ {
        let is_deflected = |axis: &Axis| self.0[axis.index()];
        Axis::ALL.iter().copied().filter(is_deflected)
    }

    /// Returns the event that centers an axis.
    pub const fn center(axis: Axis) -> EventKind {
        EventKind::Axis(axis, 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_is_deflected_until_it_is_centered() {
        let mut state = AxisState::default();
        state.set(Axis::TurnZ, 0.001);
        state.set(Axis::LeftX, -1.0);
        assert!(state.deflected_axes().eq([Axis::LeftX, Axis::TurnZ]));
        state.set(Axis::LeftX, -0.0);
        assert!(state.deflected_axes().eq([Axis::TurnZ]));
    }
}
