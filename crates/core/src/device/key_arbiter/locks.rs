//! Modifiers and layers that a tap locks until the next tap.

use arrayvec::ArrayVec;

use super::{KeyAction, Latch, MODIFIER_COUNT, Press};
use crate::device::KeyCode;

/// The locked modifiers and the locked layer.
#[derive(Clone, Debug, Default)]
pub(super) struct Locks {
    /// Modifiers that stay down.
    pub(super) modifiers: ArrayVec<KeyCode, MODIFIER_COUNT>,
    /// The layer that stays active.
    pub(super) layer: Option<usize>,
}

impl Locks {
    /// Unlocks what `action` has locked; returns whether it was locked.
    pub(super) fn deactivate(&mut self, action: KeyAction) -> bool {
        match action {
            KeyAction::Modifier(code, Latch::Lock) => {
                let before = self.modifiers.len();
                self.modifiers.retain(|locked| *locked != code);
                self.modifiers.len() < before
            }
            KeyAction::Layer(layer, Latch::Lock) if self.layer == Some(layer) => {
                self.layer = None;
                true
            }
            _ => false,
        }
    }

    /// Handles the end of a press.
    pub(super) fn end_press(&mut self, press: &Press, is_tap: bool) {
        if !is_tap || !press.latches || press.is_used {
            return;
        }
        match press.action {
            KeyAction::Modifier(code, Latch::Lock) if !self.modifiers.contains(&code) => {
                // There are no more modifiers than fit.
                let _ = self.modifiers.try_push(code);
            }
            KeyAction::Layer(layer, Latch::Lock) => self.layer = Some(layer),
            _ => {}
        }
    }
}
