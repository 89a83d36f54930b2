//! What the keys of a keyboard do.

use std::time::Duration;

use crate::contact::TargetId;
use crate::device::KeyAction;

/// What one key of a layout does.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KeyBinding {
    /// The target that stands for the key.
    pub target: TargetId,
    /// What pressing it does in each layer, base layer first. `None`, or a list that ends before
    /// the layer, does what the base layer says.
    pub actions: Vec<Option<KeyAction>>,
    /// Whether the depth of the press goes out too.
    pub reports_depth: bool,
    /// When what it does takes effect.
    pub activation: Activation,
    /// For how long after it came up it does not press again, by the times of the touches; a press
    /// that comes sooner is no press at all. Zero lets every press through.
    pub debounce: Duration,
}

/// When a key does what its actions say.
///
/// Kinds other than `Press` are for actions that are [`KeyAction::Key`]; the others are in force
/// from the press whatever stands here, except for `Dwell`. The action is settled at the press, and nothing of it goes
/// out before it fires. A press that is cancelled before that does nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Activation {
    /// From the press on, as long as it is pressed.
    OnPress,
    /// When it is let go of: the code goes down and up at once.
    OnRelease,
    /// By how long it is pressed.
    TapHold(TapHold),
    /// When a fingertip has been on it for so long, however deep, once each time that it comes: the
    /// action is that of the layer in force then, and is tapped. Pressing does nothing.
    Dwell(Duration),
}

/// What a key does when it is held instead of tapped.
///
/// Let go of sooner than `after`, the key is tapped: its code goes down and up at once. Once the
/// time of a frame is `after` past the press, or at once when another key is pressed, `action` is in
/// force instead, until the key is let go of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TapHold {
    /// What it does when held; latches count as [`Latch::Held`](crate::device::Latch::Held).
    pub hold_action: KeyAction,
    /// How long it is pressed before it counts as held.
    pub hold_after: Duration,
}
