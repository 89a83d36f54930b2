//! Modifiers and layers that a tap puts in force until the next tap.

use arrayvec::ArrayVec;

use super::{KeyAction, Latch, MODIFIERS, Press};
use crate::device::KeyCode;

/// What taps of locking keys left in force.
#[derive(Clone, Debug, Default)]
pub(super) struct Locks {
    /// Modifiers that stay down.
    pub(super) modifiers: ArrayVec<KeyCode, MODIFIERS>,
    /// The layer that stays.
    pub(super) layer: Option<usize>,
}

impl Locks {
    /// Unlocks what `action` locked before; whether there was something to unlock.
    pub(super) fn take_back(&mut self, action: KeyAction) -> bool {
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

    /// Takes note that a press has ended.
    pub(super) fn end_of(&mut self, press: &Press, is_tap: bool) {
        if !is_tap || !press.arms || press.is_used {
            return;
        }
        match press.action {
            KeyAction::Modifier(code, Latch::Lock) if !self.modifiers.contains(&code) => {
                // A ninth modifier does not exist; if it did, its tap would be lost.
                let _ = self.modifiers.try_push(code);
            }
            KeyAction::Layer(layer, Latch::Lock) => self.layer = Some(layer),
            _ => {}
        }
    }
}
