//! What a layout can ever send, so that an output that cannot carry it is refused before anything is typed.

use std::collections::BTreeSet;
use std::fmt;

use super::{Action, Axis, KeyCode, KeyKind};

/// Everything that a layout can ever send to an output.
///
/// A [`Depth`](Action::Depth), a [`Value`](Action::Value), what is selected and what is asked of the
/// engine are not in it: they are told to all outputs, and an output may make nothing of them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// The keys and buttons, modifiers included.
    pub codes: BTreeSet<KeyCode>,
    /// Whether it [writes](Action::Write) characters.
    pub writes: bool,
    /// Whether it [moves](Action::MoveBy) the pointer.
    pub moves: bool,
    /// Whether it [brings](Action::MoveTo) the pointer to places on the screen.
    pub places: bool,
    /// Whether it turns the [wheel](Action::Scroll).
    pub scrolls: bool,
    /// The axes that it moves.
    pub axes: BTreeSet<Axis>,
}

/// One of the things that an output must be able to carry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// This key or button.
    Code(KeyCode),
    /// Characters.
    Write,
    /// Motion of the pointer.
    Move,
    /// Places on the screen.
    Place,
    /// The wheel.
    Scroll,
    /// This axis.
    Axis(Axis),
}

impl Need {
    /// What an output must be able to carry for this action; `None` for what all outputs are told.
    pub const fn of(action: Action) -> Option<Self> {
        Some(match action {
            Action::KeyDown(code) | Action::KeyUp(code) => Self::Code(code),
            Action::Write(_) => Self::Write,
            Action::MoveBy(..) => Self::Move,
            Action::MoveTo(..) => Self::Place,
            Action::Scroll(..) => Self::Scroll,
            Action::Axis(axis, _) => Self::Axis(axis),
            Action::Depth(..)
            | Action::Value(..)
            | Action::Select(_)
            | Action::Unselect(_)
            | Action::Ask(_) => return None,
        })
    }
}

impl fmt::Display for Need {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Code(code) => write!(f, "`{code}`"),
            Self::Write => f.write_str("characters"),
            Self::Move => f.write_str("pointer motion"),
            Self::Place => f.write_str("pointer places"),
            Self::Scroll => f.write_str("a wheel"),
            Self::Axis(axis) => write!(f, "`{axis}`"),
        }
    }
}

impl Needs {
    /// Whether it presses keys, not just buttons, or writes characters.
    pub fn types(&self) -> bool {
        let is_key = |code: &KeyCode| code.kind() == KeyKind::Key;
        self.writes || self.codes.iter().any(is_key)
    }

    /// Whether this is among them.
    pub fn has(&self, need: Need) -> bool {
        match need {
            Need::Code(code) => self.codes.contains(&code),
            Need::Write => self.writes,
            Need::Move => self.moves,
            Need::Place => self.places,
            Need::Scroll => self.scrolls,
            Need::Axis(axis) => self.axes.contains(&axis),
        }
    }

    /// Adds one.
    pub fn insert(&mut self, need: Need) {
        match need {
            Need::Code(code) => drop(self.codes.insert(code)),
            Need::Write => self.writes = true,
            Need::Move => self.moves = true,
            Need::Place => self.places = true,
            Need::Scroll => self.scrolls = true,
            Need::Axis(axis) => drop(self.axes.insert(axis)),
        }
    }

    /// All of them: keys and buttons in order of code, then the rest.
    pub fn iter(&self) -> impl Iterator<Item = Need> + '_ {
        let wanted = |is_wanted: bool, need| is_wanted.then_some(need);
        let of_pointer = [
            wanted(self.writes, Need::Write),
            wanted(self.moves, Need::Move),
            wanted(self.places, Need::Place),
            wanted(self.scrolls, Need::Scroll),
        ];
        let codes = self.codes.iter().copied().map(Need::Code);
        let axes = self.axes.iter().copied().map(Need::Axis);
        codes.chain(of_pointer.into_iter().flatten()).chain(axes)
    }
}

impl Extend<Need> for Needs {
    fn extend<T: IntoIterator<Item = Need>>(&mut self, needs: T) {
        for need in needs {
            self.insert(need);
        }
    }
}

impl FromIterator<Need> for Needs {
    fn from_iter<T: IntoIterator<Item = Need>>(needs: T) -> Self {
        let mut all = Self::default();
        all.extend(needs);
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn code(name: &str) -> Need {
        Need::Code(name.parse().unwrap())
    }

    #[test]
    fn what_is_put_in_comes_out_once_keys_first() {
        let put_in = [
            Need::Axis(Axis::TurnZ),
            Need::Scroll,
            Need::Place,
            code("PadSouth"),
            Need::Write,
            Need::Move,
            code("A"),
            code("A"),
        ];
        let needs: Needs = put_in.into_iter().collect();
        let ordered = [
            code("A"),
            code("PadSouth"),
            Need::Write,
            Need::Move,
            Need::Place,
            Need::Scroll,
            Need::Axis(Axis::TurnZ),
        ];
        assert!(needs.iter().eq(ordered));
        assert!(put_in.iter().all(|need| needs.has(*need)));
        assert!(!needs.has(code("B")) && !needs.has(Need::Axis(Axis::TurnX)));
        assert!(!ordered.iter().any(|need| Needs::default().has(*need)));
    }

    #[test]
    fn both_layouts_are_served_by_what_either_needs() {
        let mut both = Needs::from_iter([code("A"), Need::Write]);
        both.extend(Needs::from_iter([code("B"), Need::Scroll]).iter());
        let needs = Needs::from_iter([code("A"), code("B"), Need::Write, Need::Scroll]);
        assert_eq!(both, needs);
    }
}
