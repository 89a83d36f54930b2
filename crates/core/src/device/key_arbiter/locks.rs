//! Modifiers and layers that a tap locks until the next tap.

use arrayvec::ArrayVec;

use super::{KeyAction, Latch, MODIFIER_COUNT, Press};
use crate::device::KeyCode;
use crate::hand::Side;

/// The locked modifiers and the locked layer, each with the hand that has locked it.
#[derive(Clone, Debug, Default)]
pub(super) struct Locks {
    /// Modifiers that stay down.
    pub(super) modifiers: ArrayVec<(KeyCode, Side), MODIFIER_COUNT>,
    /// The layer that stays active.
    pub(super) layer: Option<(usize, Side)>,
}

impl Locks {
    /// Unlocks what `action` has locked. Returns `true` if it was locked.
    pub(super) fn deactivate(&mut self, action: KeyAction) -> bool {
        match action {
            KeyAction::Modifier(code, Latch::Lock) => self.unlock(code),
            KeyAction::Layer(layer, Latch::Lock)
                if self.layer.is_some_and(|(locked, _)| locked == layer) =>
            {
                self.layer = None;
                true
            }
            _ => false,
        }
    }

    /// Unlocks a modifier. Returns `true` if it was locked.
    pub(super) fn unlock(&mut self, code: KeyCode) -> bool {
        let before = self.modifiers.len();
        self.modifiers.retain(|(locked, _)| *locked != code);
        self.modifiers.len() < before
    }

    /// Unlocks what a hand has locked.
    pub(super) fn release_hand(&mut self, side: Side) {
        self.modifiers.retain(|(_, by)| *by != side);
        self.layer = self.layer.filter(|&(_, by)| by != side);
    }

    /// Handles the end of a press.
    pub(super) fn end_press(&mut self, press: &Press, is_tap: bool) {
        if !is_tap || !press.latches || press.is_used {
            return;
        }
        match press.action {
            KeyAction::Modifier(code, Latch::Lock)
                if !self.modifiers.iter().any(|&(locked, _)| locked == code) =>
            {
                // The list has room for every modifier.
                let _ = self.modifiers.try_push((code, press.side));
            }
            KeyAction::Layer(layer, Latch::Lock) => self.layer = Some((layer, press.side)),
            _ => {}
        }
    }
}
