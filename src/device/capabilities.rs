//! What a layout can ever send, so that an output that cannot carry it is refused before anything is typed.

use std::collections::BTreeSet;
use std::fmt;

use super::{Axis, EventKind, KeyCode, KeyKind};

/// Everything that a layout can ever send to an output.
///
/// A [`Depth`](Action::Depth), a [`Value`](Action::Value), what is selected and what is asked of the
/// engine are not in it: they are told to all outputs, and an output may make nothing of them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Capabilities {
    /// The keys and buttons, modifiers included.
    pub keys: BTreeSet<KeyCode>,
    /// Whether it [writes](Action::Write) characters.
    pub text: bool,
    /// Whether it [moves](Action::MoveBy) the pointer.
    pub relative_motion: bool,
    /// Whether it [brings](Action::MoveTo) the pointer to places on the screen.
    pub absolute_motion: bool,
    /// Whether it turns the [wheel](Action::Scroll).
    pub scroll: bool,
    /// The axes that it moves.
    pub axes: BTreeSet<Axis>,
}

/// One of the things that an output must be able to carry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Capability {
    /// This key or button.
    Key(KeyCode),
    /// Characters.
    Text,
    /// Motion of the pointer.
    RelativeMotion,
    /// Places on the screen.
    AbsoluteMotion,
    /// The wheel.
    Scroll,
    /// This axis.
    Axis(Axis),
}

impl Capability {
    /// What an output must be able to carry for this action; `None` for what all outputs are told.
    pub const fn required_by(action: EventKind) -> Option<Self> {
        Some(match action {
            EventKind::KeyDown(code) | EventKind::KeyUp(code) => Self::Key(code),
            EventKind::Character(_) => Self::Text,
            EventKind::MoveBy(..) => Self::RelativeMotion,
            EventKind::MoveTo(..) => Self::AbsoluteMotion,
            EventKind::Scroll(..) => Self::Scroll,
            EventKind::Axis(axis, _) => Self::Axis(axis),
            EventKind::Depth(..)
            | EventKind::Value(..)
            | EventKind::Select(_)
            | EventKind::Unselect(_)
            | EventKind::Ask(_) => return None,
        })
    }
}

impl fmt::Display for Capability {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Key(code) => write!(f, "`{code}`"),
            Self::Text => f.write_str("characters"),
            Self::RelativeMotion => f.write_str("pointer motion"),
            Self::AbsoluteMotion => f.write_str("pointer places"),
            Self::Scroll => f.write_str("a wheel"),
            Self::Axis(axis) => write!(f, "`{axis}`"),
        }
    }
}

impl Capabilities {
    /// Whether it presses keys, not just buttons, or writes characters.
    pub fn include_typing(&self) -> bool {
        let is_key = |code: &KeyCode| code.kind() == KeyKind::Keyboard;
        self.text || self.keys.iter().any(is_key)
    }

    /// Whether this is among them.
    pub fn contains(&self, need: Capability) -> bool {
        match need {
            Capability::Key(code) => self.keys.contains(&code),
            Capability::Text => self.text,
            Capability::RelativeMotion => self.relative_motion,
            Capability::AbsoluteMotion => self.absolute_motion,
            Capability::Scroll => self.scroll,
            Capability::Axis(axis) => self.axes.contains(&axis),
        }
    }

    /// Adds one.
    pub fn insert(&mut self, need: Capability) {
        match need {
            Capability::Key(code) => drop(self.keys.insert(code)),
            Capability::Text => self.text = true,
            Capability::RelativeMotion => self.relative_motion = true,
            Capability::AbsoluteMotion => self.absolute_motion = true,
            Capability::Scroll => self.scroll = true,
            Capability::Axis(axis) => drop(self.axes.insert(axis)),
        }
    }

    /// All of them: keys and buttons in order of code, then the rest.
    pub fn iter(&self) -> impl Iterator<Item = Capability> + '_ {
        let wanted = |is_wanted: bool, need| is_wanted.then_some(need);
        let of_pointer = [
            wanted(self.text, Capability::Text),
            wanted(self.relative_motion, Capability::RelativeMotion),
            wanted(self.absolute_motion, Capability::AbsoluteMotion),
            wanted(self.scroll, Capability::Scroll),
        ];
        let codes = self.keys.iter().copied().map(Capability::Key);
        let axes = self.axes.iter().copied().map(Capability::Axis);
        codes.chain(of_pointer.into_iter().flatten()).chain(axes)
    }
}

impl Extend<Capability> for Capabilities {
    fn extend<T: IntoIterator<Item = Capability>>(&mut self, needs: T) {
        for need in needs {
            self.insert(need);
        }
    }
}

impl FromIterator<Capability> for Capabilities {
    fn from_iter<T: IntoIterator<Item = Capability>>(needs: T) -> Self {
        let mut all = Self::default();
        all.extend(needs);
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn code(name: &str) -> Capability {
        Capability::Key(name.parse().unwrap())
    }

    #[test]
    fn what_is_put_in_comes_out_once_keys_first() {
        let put_in = [
            Capability::Axis(Axis::TurnZ),
            Capability::Scroll,
            Capability::AbsoluteMotion,
            code("PadSouth"),
            Capability::Text,
            Capability::RelativeMotion,
            code("A"),
            code("A"),
        ];
        let needs: Capabilities = put_in.into_iter().collect();
        let ordered = [
            code("A"),
            code("PadSouth"),
            Capability::Text,
            Capability::RelativeMotion,
            Capability::AbsoluteMotion,
            Capability::Scroll,
            Capability::Axis(Axis::TurnZ),
        ];
        assert!(needs.iter().eq(ordered));
        assert!(put_in.iter().all(|need| needs.contains(*need)));
        assert!(!needs.contains(code("B")) && !needs.contains(Capability::Axis(Axis::TurnX)));
        assert!(
            !ordered
                .iter()
                .any(|need| Capabilities::default().contains(*need))
        );
    }

    #[test]
    fn both_layouts_are_served_by_what_either_needs() {
        let mut both = Capabilities::from_iter([code("A"), Capability::Text]);
        both.extend(Capabilities::from_iter([code("B"), Capability::Scroll]).iter());
        let needs =
            Capabilities::from_iter([code("A"), code("B"), Capability::Text, Capability::Scroll]);
        assert_eq!(both, needs);
    }
}
