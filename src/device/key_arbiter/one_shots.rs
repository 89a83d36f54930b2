//! Modifiers and layers that a tap puts in force for one key.

use arrayvec::ArrayVec;

use super::{KeyAction, Latch, MODIFIERS, Press, PressSource};
use crate::device::KeyCode;

/// What taps of one-shot keys left behind.
#[derive(Clone, Debug, Default)]
pub(super) struct OneShots {
    /// Modifiers that wait for the next key.
    armed: ArrayVec<KeyCode, MODIFIERS>,
    /// The layer that waits for the next key.
    pub(super) layer: Option<usize>,
    /// Modifiers that are down for one key press.
    pub(super) in_force: ArrayVec<KeyCode, MODIFIERS>,
    /// That key press.
    for_press: Option<PressSource>,
}

impl OneShots {
    /// Disarms what `action` armed before; whether there was something to disarm.
    pub(super) fn take_back(&mut self, action: KeyAction) -> bool {
        match action {
            KeyAction::Modifier(code, Latch::OneShot) => {
                let before = self.armed.len();
                self.armed.retain(|armed| *armed != code);
                self.armed.len() < before
            }
            KeyAction::Layer(layer, Latch::OneShot) if self.layer == Some(layer) => {
                self.layer = None;
                true
            }
            _ => false,
        }
    }

    /// Puts what is armed in force for one key press, instead of what was in force before.
    pub(super) fn pass_to(&mut self, press: PressSource) {
        self.in_force = std::mem::take(&mut self.armed);
        self.for_press = Some(press);
        self.layer = None;
    }

    /// Takes note that a press has ended.
    pub(super) fn end_of(&mut self, press: &Press, is_tap: bool) {
        if self.for_press == Some(press.owner) {
            self.in_force.clear();
            self.for_press = None;
        }
        if !is_tap || !press.arms || press.is_used {
            return;
        }
        match press.action {
            KeyAction::Modifier(code, Latch::OneShot) if !self.armed.contains(&code) => {
                // A ninth modifier does not exist; if it did, its tap would be lost.
                let _ = self.armed.try_push(code);
            }
            KeyAction::Layer(layer, Latch::OneShot) => self.layer = Some(layer),
            _ => {}
        }
    }
}
