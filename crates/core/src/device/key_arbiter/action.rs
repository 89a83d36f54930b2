//! The actions of key presses.

use super::{MultitapId, SequenceId};
use crate::command::Command;
use crate::device::{Capability, KeyCode, KeyKind};

/// The action of a key, or of any other control that can be pressed or on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum KeyAction {
    /// Holds a key or button down while it is pressed. The receiver repeats it.
    Key(KeyCode),
    /// Holds a modifier key down.
    Modifier(KeyCode, Latch),
    /// Activates the layer with this index; 0 is the base layer.
    Layer(usize, Latch),
    /// Types a text, once.
    Text(TextId),
    /// Starts a sequence, unless one runs.
    Sequence(SequenceId),
    /// Types a letter, and in place of it the next one if the same key is tapped again.
    Multitap(MultitapId),
    /// Sends a command to the session, once.
    Command(Command),
    /// Holds the pointer still, so that the hand can move back.
    Clutch,
    /// Slows the pointer down.
    Precision,
}

impl KeyAction {
    /// Returns the capability that an output needs for the action; `None` if the action itself emits no event. For the events of a
    /// sequence, see [`Sequence::add_capabilities`](super::Sequence::add_capabilities); for the letters of a multitap key, see
    /// [`Multitaps::add_capabilities`](super::Multitaps::add_capabilities).
    pub const fn required_capability(self) -> Option<Capability> {
        match self {
            Self::Key(code) | Self::Modifier(code, _) => Some(Capability::Key(code)),
            Self::Text(_) => Some(Capability::Text),
            Self::Layer(..)
            | Self::Sequence(_)
            | Self::Multitap(_)
            | Self::Command(_)
            | Self::Clutch
            | Self::Precision => None,
        }
    }

    /// Returns `true` if it presses a key of a keyboard, types a text, or is a command that types. Every sequence counts as typing.
    pub const fn is_typing(self) -> bool {
        match self {
            Self::Key(code) | Self::Modifier(code, _) => matches!(code.kind(), KeyKind::Keyboard),
            Self::Text(_) | Self::Sequence(_) | Self::Multitap(_) => true,
            Self::Command(command) => command.is_typing(),
            Self::Layer(..) | Self::Clutch | Self::Precision => false,
        }
    }

    /// Returns `true` for a key that types a letter on a US keymap.
    pub fn types_letter(self) -> bool {
        matches!(self, Self::Key(code) if code.us_character(false).is_some_and(char::is_alphabetic))
    }

    /// Returns `true` if a press with it ends the sequence that runs: the person types, clicks or holds a modifier again.
    pub(super) const fn ends_sequence(self) -> bool {
        matches!(
            self,
            Self::Key(_) | Self::Modifier(..) | Self::Text(_) | Self::Multitap(_)
        )
    }
}

/// The index of a text in the list of the [`KeyArbiter`](super::KeyArbiter).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TextId(pub u16);

/// The duration for which a modifier or layer stays active.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Latch {
    /// While its key is pressed.
    Momentary,
    /// After a tap, for the next key only; a second tap cancels it. Momentary if another key is pressed
    /// during the hold.
    OneShot,
    /// While its key is pressed, and after a tap until the next tap. Momentary if another key is pressed
    /// during the hold. Of several locked layers the last one is active.
    Lock,
}
