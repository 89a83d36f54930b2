//! Which fingertip holds on to which control.

use arrayvec::ArrayVec;

use crate::contact::Touch;
use crate::hand::{FINGERS_OF_BOTH_HANDS, Finger, Side};

/// What each fingertip holds on to: a control has one at most, whoever presses it while it is held is
/// ignored.
#[derive(Clone, Debug)]
pub(super) struct Grips<T>(ArrayVec<Grip<T>, FINGERS_OF_BOTH_HANDS>);

/// One fingertip and its control.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grip<T> {
    pub(super) side: Side,
    pub(super) finger: Finger,
    /// The place of the control in its list.
    pub(super) place: usize,
    /// What has to be known of it until it ends.
    pub(super) state: T,
}

impl<T> Grip<T> {
    fn is_of(&self, touch: &Touch) -> bool {
        (self.side, self.finger) == (touch.side, touch.finger)
    }
}

impl<T> Grips<T> {
    /// Nothing is held.
    pub(super) fn none() -> Self {
        Self(ArrayVec::new())
    }

    /// Whose the control is, if anybody's.
    pub(super) fn on(&self, place: usize) -> Option<&Grip<T>> {
        self.0.iter().find(|grip| grip.place == place)
    }

    /// Lets the fingertip of a touch hold a control that nobody holds.
    pub(super) fn begin(&mut self, touch: &Touch, place: usize, state: T) {
        self.end(touch);
        // Each finger holds one control at most, so there is room.
        let _ = self.0.try_push(Grip {
            side: touch.side,
            finger: touch.finger,
            place,
            state,
        });
    }

    /// What the fingertip of a touch holds.
    pub(super) fn of(&mut self, touch: &Touch) -> Option<&mut Grip<T>> {
        self.0.iter_mut().find(|grip| grip.is_of(touch))
    }

    /// Takes from the fingertip of a touch what it holds.
    pub(super) fn end(&mut self, touch: &Touch) -> Option<Grip<T>> {
        let found = self.0.iter().position(|grip| grip.is_of(touch))?;
        Some(self.0.remove(found))
    }

    /// Takes a control from whoever holds it.
    pub(super) fn end_on(&mut self, place: usize) {
        self.0.retain(|grip| grip.place != place);
    }

    /// Lets nobody hold anything.
    pub(super) fn clear(&mut self) {
        self.0.clear();
    }
}
