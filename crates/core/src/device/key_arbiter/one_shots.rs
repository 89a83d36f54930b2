//! Modifiers and layers that a tap activates for the next key.

use arrayvec::ArrayVec;

use super::{KeyAction, Latch, MODIFIER_COUNT, Press, PressSource};
use crate::device::KeyCode;
use crate::hand::Side;

/// A modifier that a tap has armed, and the hand that has tapped it.
pub(super) type ArmedModifier = (KeyCode, Side);

/// The one-shot modifiers and the one-shot layer.
#[derive(Clone, Debug, Default)]
pub(super) struct OneShots {
    /// Modifiers armed for the next key.
    pub(super) armed: ArrayVec<ArmedModifier, MODIFIER_COUNT>,
    /// The layer armed for the next key.
    pub(super) layer: Option<(usize, Side)>,
    /// Modifiers that are down for one key press.
    pub(super) active: ArrayVec<ArmedModifier, MODIFIER_COUNT>,
    /// The source of that key press.
    active_for: Option<PressSource>,
}

impl OneShots {
    /// Disarms what `action` has armed. Returns `true` if it was armed.
    pub(super) fn deactivate(&mut self, action: KeyAction) -> bool {
        match action {
            KeyAction::Modifier(code, Latch::OneShot) => {
                let before = self.armed.len();
                self.armed.retain(|(armed, _)| *armed != code);
                self.armed.len() < before
            }
            KeyAction::Layer(layer, Latch::OneShot)
                if self.layer.is_some_and(|(armed, _)| armed == layer) =>
            {
                self.layer = None;
                true
            }
            _ => false,
        }
    }

    /// Makes the armed modifiers active for one key press, instead of those active before.
    pub(super) fn apply_to(&mut self, source: PressSource) {
        self.active = std::mem::take(&mut self.armed);
        self.active_for = Some(source);
        self.layer = None;
    }

    /// Disarms what a hand has armed. What is active ends with its key press.
    pub(super) fn release_hand(&mut self, side: Side) {
        self.armed.retain(|(_, by)| *by != side);
        self.layer = self.layer.filter(|&(_, by)| by != side);
    }

    /// Handles the end of a press.
    pub(super) fn end_press(&mut self, press: &Press, is_tap: bool) {
        if self.active_for == Some(press.source) {
            self.active.clear();
            self.active_for = None;
        }
        if !is_tap || !press.latches || press.is_used {
            return;
        }
        match press.action {
            KeyAction::Modifier(code, Latch::OneShot)
                if !self.armed.iter().any(|&(armed, _)| armed == code) =>
            {
                // The list has room for every modifier.
                let _ = self.armed.try_push((code, press.side));
            }
            KeyAction::Layer(layer, Latch::OneShot) => self.layer = Some((layer, press.side)),
            _ => {}
        }
    }
}
