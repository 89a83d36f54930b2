//! The controls that fingertips hold, and their holders.

use arrayvec::ArrayVec;

use crate::contact::Touch;
use crate::hand::{FINGERS_OF_BOTH_HANDS, Finger, Side};

/// The controls that fingertips hold.
///
/// A control has at most one holder. Other fingers that press it at the same time are ignored.
#[derive(Clone, Debug)]
pub(super) struct Grips<T>(ArrayVec<Grip<T>, FINGERS_OF_BOTH_HANDS>);

/// A fingertip and the control that it holds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grip<T> {
    pub(super) side: Side,
    pub(super) finger: Finger,
    /// The index of the control.
    pub(super) control: usize,
    /// Data of the device that lasts until the grip ends.
    pub(super) state: T,
}

impl<T> Grip<T> {
    fn is_held_by(&self, touch: &Touch) -> bool {
        (self.side, self.finger) == (touch.side, touch.finger)
    }
}

impl<T> Grips<T> {
    /// Creates an empty set.
    pub(super) fn new() -> Self {
        Self(ArrayVec::new())
    }

    /// Returns the grip on a control, if a fingertip holds it.
    pub(super) fn on_control(&self, control: usize) -> Option<&Grip<T>> {
        self.0.iter().find(|grip| grip.control == control)
    }

    /// Makes the touching fingertip hold a free control; it releases what it held before.
    pub(super) fn grab(&mut self, touch: &Touch, control: usize, state: T) {
        self.release(touch);
        // Each finger holds one control at most, so there is room.
        let _ = self.0.try_push(Grip {
            side: touch.side,
            finger: touch.finger,
            control,
            state,
        });
    }

    /// Returns the grip of the touching fingertip.
    pub(super) fn get_mut(&mut self, touch: &Touch) -> Option<&mut Grip<T>> {
        self.0.iter_mut().find(|grip| grip.is_held_by(touch))
    }

    /// Ends the grip of the touching fingertip and returns it.
    pub(super) fn release(&mut self, touch: &Touch) -> Option<Grip<T>> {
        let found = self.0.iter().position(|grip| grip.is_held_by(touch))?;
        Some(self.0.remove(found))
    }

    /// Ends the grip on a control.
    pub(super) fn release_control(&mut self, control: usize) {
        self.0.retain(|grip| grip.control != control);
    }

    /// Ends all grips.
    pub(super) fn clear(&mut self) {
        self.0.clear();
    }
}
