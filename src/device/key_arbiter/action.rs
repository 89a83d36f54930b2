//! What a press does.

use crate::device::{Capability, KeyCode, KeyKind, Request};

/// What pressing a key does, or switching on anything else that can be on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyAction {
    /// Holds a key or button down as long as it is pressed; the receiver repeats.
    Key(KeyCode),
    /// Holds a modifier key down.
    Modifier(KeyCode, Latch),
    /// Switches to another layer: its place, 0 for the base layer.
    Layer(usize, Latch),
    /// Writes a text, once.
    Text(TextId),
    /// Asks something of the engine, once.
    Ask(Request),
    /// Holds the pointer still, so that the hand can go back without it.
    Clutch,
    /// Makes the pointer slow.
    Precision,
}

impl KeyAction {
    /// What an output must be able to carry for it; `None` for what stays within the engine.
    pub const fn required_capability(self) -> Option<Capability> {
        match self {
            Self::Key(code) | Self::Modifier(code, _) => Some(Capability::Key(code)),
            Self::Text(_) => Some(Capability::Text),
            Self::Layer(..) | Self::Ask(_) | Self::Clutch | Self::Precision => None,
        }
    }

    /// Whether it presses a key, not just a button, or writes characters.
    pub const fn is_typing(self) -> bool {
        match self {
            Self::Key(code) | Self::Modifier(code, _) => matches!(code.kind(), KeyKind::Keyboard),
            Self::Text(_) => true,
            Self::Layer(..) | Self::Ask(_) | Self::Clutch | Self::Precision => false,
        }
    }
}

/// The place of a text in the list of its [`Switchboard`](super::Switchboard).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TextId(pub u16);

/// How long a modifier or layer stays in force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Latch {
    /// As long as its key is pressed.
    Momentary,
    /// A tap puts it in force for the next key only, a second tap takes that back; held while
    /// another key is pressed it is as `Held`.
    OneShot,
    /// In force while it is pressed, and after a tap until the next tap; held while another key is
    /// pressed it is as `Held`. Of several locked layers the last counts.
    Lock,
}
