//! Which axes are away from their rest: the account of every output that has axes.

use crate::device::{Axis, EventKind};

/// The axes that have left 0 and not come back.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct AxisState([bool; Axis::COUNT]);

impl AxisState {
    /// Notes where an axis stands.
    pub fn set(&mut self, axis: Axis, value: f32) {
        self.0[axis.index()] = value != 0.0;
    }

    /// The axes that are away from their rest, in order.
    pub fn deflected_axes(&self) -> impl Iterator<Item = Axis> + '_ {
        let is_away = |axis: &Axis| self.0[axis.index()];
        Axis::ALL.iter().copied().filter(is_away)
    }

    /// What brings an axis back.
    pub const fn center(axis: Axis) -> EventKind {
        EventKind::Axis(axis, 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_is_away_from_its_rest_until_it_comes_back() {
        let mut deflected = AxisState::default();
        deflected.set(Axis::TurnZ, 0.001);
        deflected.set(Axis::LeftX, -1.0);
        assert!(deflected.deflected_axes().eq([Axis::LeftX, Axis::TurnZ]));
        deflected.set(Axis::LeftX, -0.0);
        assert!(deflected.deflected_axes().eq([Axis::TurnZ]));
    }
}
