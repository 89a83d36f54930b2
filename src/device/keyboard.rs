//! A keyboard: touches of keys become key events, with modifiers and layers.

use super::KeyCode;
use crate::contact::TargetId;

/// What one key of a layout does.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KeyBinding {
    /// The target that stands for the key.
    pub target: TargetId,
    /// What pressing it does in each layer, base layer first. `None`, or a list that ends before
    /// the layer, does what the base layer says.
    pub actions: Vec<Option<KeyAction>>,
    /// Whether the depth of the press goes out too.
    pub analogue: bool,
}

/// What pressing a key does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyAction {
    /// Holds a key down as long as it is pressed; the receiver repeats.
    Key(KeyCode),
    /// Holds a modifier key down.
    Modifier(KeyCode, Latch),
    /// Switches to another layer: its place, 0 for the base layer.
    Layer(usize, Latch),
}

/// How long a modifier or layer stays in force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Latch {
    /// As long as its key is pressed.
    Held,
    /// A tap puts it in force for the next key only; held while another key is pressed it is as `Held`.
    OneShot,
}
