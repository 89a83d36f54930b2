//! The capabilities that layouts need and outputs offer.

use std::collections::BTreeSet;
use std::fmt;

use super::{Axis, EventKind, KeyCode, KeyKind};

/// A set of capabilities that a layout needs, or that an output offers.
///
/// A layout is refused by an output that lacks one of its capabilities. Events without a capability
/// ([`Depth`](EventKind::Depth), [`Value`](EventKind::Value), [`Velocity`](EventKind::Velocity), [`Select`](EventKind::Select) and
/// [`Unselect`](EventKind::Unselect)) go to every output, which may ignore them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Capabilities {
    /// Keys and buttons, including modifiers.
    pub keys: BTreeSet<KeyCode>,
    /// `true` if it contains [`EventKind::Character`].
    pub text: bool,
    /// `true` if it contains [`EventKind::MoveBy`].
    pub relative_motion: bool,
    /// `true` if it contains [`EventKind::MoveTo`].
    pub absolute_motion: bool,
    /// `true` if it contains [`EventKind::Scroll`].
    pub scroll: bool,
    /// Gamepad and 6-DoF axes.
    pub axes: BTreeSet<Axis>,
}

/// A kind of event that an output can send.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Capability {
    /// A key or button.
    Key(KeyCode),
    /// Characters.
    Text,
    /// Motion of the pointer in pixels.
    RelativeMotion,
    /// Positions of the pointer on the screen.
    AbsoluteMotion,
    /// The wheel.
    Scroll,
    /// A gamepad or 6-DoF axis.
    Axis(Axis),
}

impl Capability {
    /// Returns the capability that an output needs for an event; `None` if every output accepts it.
    pub const fn required_by(kind: EventKind) -> Option<Self> {
        Some(match kind {
            EventKind::KeyDown(code) | EventKind::KeyUp(code) => Self::Key(code),
            EventKind::Character(_) => Self::Text,
            EventKind::MoveBy(..) => Self::RelativeMotion,
            EventKind::MoveTo(..) => Self::AbsoluteMotion,
            EventKind::Scroll(..) => Self::Scroll,
            EventKind::Axis(axis, _) => Self::Axis(axis),
            EventKind::Depth(..)
            | EventKind::Value(..)
            | EventKind::Velocity(..)
            | EventKind::Select(_)
            | EventKind::Unselect(_) => return None,
        })
    }
}

impl fmt::Display for Capability {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Key(code) => write!(f, "`{code}`"),
            Self::Text => f.write_str("characters"),
            Self::RelativeMotion => f.write_str("relative pointer motion"),
            Self::AbsoluteMotion => f.write_str("absolute pointer motion"),
            Self::Scroll => f.write_str("scrolling"),
            Self::Axis(axis) => write!(f, "`{axis}`"),
        }
    }
}

impl Capabilities {
    /// Returns the set of all capabilities.
    pub fn all() -> Self {
        Self {
            keys: KeyCode::all().collect(),
            text: true,
            relative_motion: true,
            absolute_motion: true,
            scroll: true,
            axes: Axis::ALL.iter().copied().collect(),
        }
    }

    /// Returns `true` if the set contains keys, not only buttons, or characters.
    pub fn include_typing(&self) -> bool {
        let is_key = |code: &KeyCode| code.kind() == KeyKind::Keyboard;
        self.text || self.keys.iter().any(is_key)
    }

    /// Returns `true` if the set contains a capability.
    pub fn contains(&self, capability: Capability) -> bool {
        match capability {
            Capability::Key(code) => self.keys.contains(&code),
            Capability::Text => self.text,
            Capability::RelativeMotion => self.relative_motion,
            Capability::AbsoluteMotion => self.absolute_motion,
            Capability::Scroll => self.scroll,
            Capability::Axis(axis) => self.axes.contains(&axis),
        }
    }

    /// Adds a capability.
    pub fn insert(&mut self, capability: Capability) {
        match capability {
            Capability::Key(code) => drop(self.keys.insert(code)),
            Capability::Text => self.text = true,
            Capability::RelativeMotion => self.relative_motion = true,
            Capability::AbsoluteMotion => self.absolute_motion = true,
            Capability::Scroll => self.scroll = true,
            Capability::Axis(axis) => drop(self.axes.insert(axis)),
        }
    }

    /// Iterates over the set: keys and buttons in order of code, then the rest.
    pub fn iter(&self) -> impl Iterator<Item = Capability> + '_ {
        let others = [
            (self.text, Capability::Text),
            (self.relative_motion, Capability::RelativeMotion),
            (self.absolute_motion, Capability::AbsoluteMotion),
            (self.scroll, Capability::Scroll),
        ];
        let others = others.into_iter().filter_map(|(has, it)| has.then_some(it));
        let keys = self.keys.iter().copied().map(Capability::Key);
        let axes = self.axes.iter().copied().map(Capability::Axis);
        keys.chain(others).chain(axes)
    }
}

impl Extend<Capability> for Capabilities {
    fn extend<T: IntoIterator<Item = Capability>>(&mut self, capabilities: T) {
        for capability in capabilities {
            self.insert(capability);
        }
    }
}

impl FromIterator<Capability> for Capabilities {
    fn from_iter<T: IntoIterator<Item = Capability>>(capabilities: T) -> Self {
        let mut set = Self::default();
        set.extend(capabilities);
        set
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(name: &str) -> Capability {
        Capability::Key(name.parse().unwrap())
    }

    #[test]
    fn a_set_iterates_over_each_capability_once_keys_first() {
        let inserted = [
            Capability::Axis(Axis::TurnZ),
            Capability::Scroll,
            Capability::AbsoluteMotion,
            key("PadSouth"),
            Capability::Text,
            Capability::RelativeMotion,
            key("A"),
            key("A"),
        ];
        let set: Capabilities = inserted.into_iter().collect();
        let ordered = [
            key("A"),
            key("PadSouth"),
            Capability::Text,
            Capability::RelativeMotion,
            Capability::AbsoluteMotion,
            Capability::Scroll,
            Capability::Axis(Axis::TurnZ),
        ];
        assert!(set.iter().eq(ordered));
        assert!(inserted.iter().all(|it| set.contains(*it)));
        assert!(!set.contains(key("B")) && !set.contains(Capability::Axis(Axis::TurnX)));
    }

    #[test]
    fn the_union_of_two_layouts_contains_the_capabilities_of_both() {
        let mut union = Capabilities::from_iter([key("A"), Capability::Text]);
        union.extend(Capabilities::from_iter([key("B"), Capability::Scroll]).iter());
        let expected =
            Capabilities::from_iter([key("A"), key("B"), Capability::Text, Capability::Scroll]);
        assert_eq!(union, expected);
    }
}
