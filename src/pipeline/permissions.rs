//! What a source may do: its role, and how many presses come of it.

use serde::{Deserialize, Serialize};

use super::PressRateLimit;
use crate::device::{EventKind, KeyKind};

/// What may come of a source.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SourceRole {
    /// Motion, wheel and axes, and the buttons of mice and gamepads.
    Pointer,
    /// Keys and characters.
    Keys,
    /// All of these.
    Both,
}

/// The part of an output that is up to a role.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    /// A key or a character.
    Keys,
    /// Something of a mouse, a gamepad or a 6-DoF device.
    Pointing,
}

impl Part {
    /// The part that an action is of. `None` for what any source may do: let go, bring an axis back to its rest,
    /// and tell of controls without an effect on the receiver's keys and pointer.
    pub(super) fn of(action: EventKind) -> Option<Self> {
        match action {
            EventKind::Character(_) => Some(Self::Keys),
            EventKind::KeyDown(key) if key.kind() == KeyKind::Keyboard => Some(Self::Keys),
            EventKind::KeyDown(_)
            | EventKind::MoveBy(..)
            | EventKind::MoveTo(..)
            | EventKind::Scroll(..) => Some(Self::Pointing),
            EventKind::Axis(_, place) if place != 0.0 => Some(Self::Pointing),
            _ => None,
        }
    }
}

impl SourceRole {
    /// All roles.
    pub const ALL: [Self; 3] = [Self::Pointer, Self::Keys, Self::Both];

    /// The word for it in a setup.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Pointer => "pointer",
            Self::Keys => "keys",
            Self::Both => "both",
        }
    }

    /// Whether keys and characters may come of it.
    pub const fn allows_keys(self) -> bool {
        !matches!(self, Self::Pointer)
    }

    /// Whether this part may come of it.
    pub(super) const fn has(self, part: Part) -> bool {
        match part {
            Part::Keys => self.allows_keys(),
            Part::Pointing => !matches!(self, Self::Keys),
        }
    }
}

/// What a source may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SourcePermissions {
    /// What may come of it.
    pub role: SourceRole,
    /// How many presses of it may come in a second.
    pub rate_limit: PressRateLimit,
}

impl SourcePermissions {
    /// For sources at this machine.
    pub const LOCAL: Self = Self {
        role: SourceRole::Both,
        rate_limit: PressRateLimit::LOCAL,
    };

    /// For sources on the network: whoever gets in there shall not type.
    pub const NETWORK: Self = Self {
        role: SourceRole::Pointer,
        rate_limit: PressRateLimit::NETWORK,
    };
}
