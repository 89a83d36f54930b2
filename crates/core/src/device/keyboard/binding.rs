//! Key bindings: the actions of keys and when they fire.

use std::time::Duration;

use crate::contact::TargetId;
use crate::device::KeyAction;

/// The binding of one key.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyBinding {
    /// The target of the key.
    pub target: TargetId,
    /// The action in each layer, base layer first. In a layer that is `None` or beyond the end of the list,
    /// the action of the base layer applies.
    pub actions: Vec<Option<KeyAction>>,
    /// `true` if the depth of the press is emitted as well.
    pub reports_depth: bool,
    /// `true` if the velocity of the press is emitted as well.
    pub reports_velocity: bool,
    /// The moment at which the action fires.
    pub activation: Activation,
    /// Time after a release during which presses are ignored, by the times of the touches. Zero accepts
    /// every press.
    pub debounce: Duration,
}

/// Returns the action of a key or chord in a layer, or in the base layer if that layer defines none.
pub fn action_in_layer(actions: &[Option<KeyAction>], layer: usize) -> Option<KeyAction> {
    let own = actions.get(layer).copied().flatten();
    own.or_else(|| actions.first().copied().flatten())
}

/// The moment at which a key fires its action.
///
/// [`OnRelease`](Self::OnRelease) and [`TapHold`](Self::TapHold) apply to [`KeyAction::Key`], texts and
/// commands; other actions are active from the press on. The action is chosen at the press, and emits
/// nothing before it fires. A press that is cancelled before that has no effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Activation {
    /// Fires at the press; held until the release.
    OnPress,
    /// Fires at the release, as a tap.
    OnRelease,
    /// Fires at the release as a tap, or after a time as a hold.
    TapHold(TapHold),
    /// After a fingertip has touched the key for this time, at any depth, once per contact: taps the action of
    /// the layer active at that moment. Presses have no effect.
    Dwell(Duration),
}

/// The hold of a tap-hold key.
///
/// A release before `hold_after` taps the action of the binding. When the key has been pressed for
/// `hold_after`, or as soon as another key is pressed, `hold_action` is held instead, until the release.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TapHold {
    /// The action when held; every latch counts as [`Latch::Momentary`](crate::device::Latch::Momentary).
    pub hold_action: KeyAction,
    /// The time after which a press is a hold.
    pub hold_after: Duration,
}
