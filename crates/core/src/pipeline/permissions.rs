//! The permissions of a source: the kinds of events that it may cause, and its rate limit for presses.

use serde::{Deserialize, Serialize};

use super::PressRateLimit;
use crate::device::{EventKind, KeyKind};
use crate::document::schema;

schema! {
    /// The kinds of events that a source may cause.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    pub enum SourceRole {
        /// Motion, wheel and axes, and the buttons of mice and gamepads.
        Pointer,
        /// Keys and characters.
        Keys,
        /// All events.
        Both,
    }
}

/// A class of events that a role permits or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum EventClass {
    /// Keys and characters.
    Keys,
    /// Motion, buttons and axes of a mouse, a gamepad or a 6-DoF device.
    Pointing,
}

impl EventClass {
    /// Returns the class of an event, or `None` for events that every source may cause: releases, the return of an axis
    /// to 0, and reports that have no effect on the keys and the pointer of the receiver.
    pub(super) fn from_kind(kind: EventKind) -> Option<Self> {
        match kind {
            EventKind::Character(_) => Some(Self::Keys),
            EventKind::KeyDown(key) if key.kind() == KeyKind::Keyboard => Some(Self::Keys),
            EventKind::KeyDown(_)
            | EventKind::MoveBy(..)
            | EventKind::MoveTo(..)
            | EventKind::Scroll(..) => Some(Self::Pointing),
            EventKind::Axis(_, value) if value != 0.0 => Some(Self::Pointing),
            _ => None,
        }
    }
}

impl SourceRole {
    /// All roles.
    pub const ALL: [Self; 3] = [Self::Pointer, Self::Keys, Self::Both];

    /// Returns the name used in messages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Pointer => "pointer",
            Self::Keys => "keys",
            Self::Both => "both",
        }
    }

    /// Returns `true` if the source may cause keys and characters.
    pub const fn allows_keys(self) -> bool {
        !matches!(self, Self::Pointer)
    }

    /// Returns `true` if the source may cause events of this class.
    pub(super) const fn allows(self, class: EventClass) -> bool {
        match class {
            EventClass::Keys => self.allows_keys(),
            EventClass::Pointing => !matches!(self, Self::Keys),
        }
    }
}

/// The permissions of a source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SourcePermissions {
    /// The kinds of events that it may cause.
    pub role: SourceRole,
    /// The rate limit for presses of keys and buttons.
    pub rate_limit: PressRateLimit,
}

impl SourcePermissions {
    /// Returns the permissions that both sources of one hand have. Roles that exclude each other permit only pointing, which
    /// the setup refuses.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            role: match self.role {
                SourceRole::Both => other.role,
                role if other.role == SourceRole::Both || other.role == role => role,
                _ => SourceRole::Pointer,
            },
            rate_limit: self.rate_limit.min(other.rate_limit),
        }
    }

    /// The default for sources on this machine: all events.
    pub const LOCAL: Self = Self {
        role: SourceRole::Both,
        rate_limit: PressRateLimit::LOCAL,
    };

    /// The default for network sources: no keys, so that an intruder cannot type.
    pub const NETWORK: Self = Self {
        role: SourceRole::Pointer,
        rate_limit: PressRateLimit::NETWORK,
    };
}
