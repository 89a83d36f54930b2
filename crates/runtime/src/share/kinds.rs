//! Kinds of lines, and sets of them.

use super::target::{ShareFormat, ShareLink, ShareTarget};
use crate::trace::Stage;
use ademan_core::names::named_enum;

named_enum! {
    /// The kind of an object that a client of `json`, `ws` or `web` can ask for.
    pub enum ShareKind ("kind") {
        /// Readings of the sensor.
        Readings = "readings",
        /// Joint angles.
        Angles = "angles",
        /// Poses of arm and hand.
        Pose = "pose",
        /// Touches of the fingertips.
        Touches = "touches",
        /// Presses among the touches, with their evidence.
        Presses = "presses",
        /// Events sent to the output.
        Events = "events",
        /// Commands that the layout issued.
        Commands = "commands",
        /// The active layout: its boards and targets. Sent after the request, and when it changes.
        Layout = "layout",
        /// The state of the session, the positions of the boards, and the targets and keys that are pressed.
        Scene = "scene",
    }
}

impl ShareKind {
    /// Returns the stage that the objects are results of; `None` for objects that several stages contribute to.
    pub(super) const fn stage(self) -> Option<Stage> {
        match self {
            Self::Readings => Some(Stage::Readings),
            Self::Angles => Some(Stage::Angles),
            Self::Pose => Some(Stage::Pose),
            Self::Touches => Some(Stage::Touches),
            Self::Presses => Some(Stage::Presses),
            Self::Events => Some(Stage::Events),
            Self::Commands => Some(Stage::Commands),
            Self::Layout | Self::Scene => None,
        }
    }

    /// Returns `true` if every object replaces the previous one, so that a rate limit may skip objects.
    const fn is_continuous(self) -> bool {
        matches!(
            self,
            Self::Readings | Self::Angles | Self::Pose | Self::Scene
        )
    }
}

/// The kind of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LineKind {
    /// The line of a format without requests.
    Plain(ShareFormat),
    /// The text line with its own time, by which a receiver on another machine recognizes old ones.
    TimedTextLine,
    /// An object with its kind.
    Object(ShareKind),
}

impl LineKind {
    /// Returns `true` if clients without requests receive it.
    pub const fn is_plain(self) -> bool {
        !matches!(self, Self::Object(_))
    }

    /// Returns the kind of the lines of a target; `None` if its clients choose the kinds.
    pub fn of_target(target: &ShareTarget) -> Option<Self> {
        match (target.format, target.link) {
            (ShareFormat::TextLine, ShareLink::Tls | ShareLink::Zenoh(_)) => {
                Some(Self::TimedTextLine)
            }
            (format, _) => format.is_plain().then_some(Self::Plain(format)),
        }
    }
}

/// A set of kinds of lines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct KindSet(u32);

impl KindSet {
    fn bit(kind: LineKind) -> u32 {
        match kind {
            LineKind::Plain(format) => 1 << format.index(),
            LineKind::TimedTextLine => 1 << 15,
            LineKind::Object(kind) => 1 << (16 + kind.index()),
        }
    }

    /// Returns the set of one kind.
    pub fn only(kind: LineKind) -> Self {
        Self(Self::bit(kind))
    }

    /// Returns the set of these kinds of objects.
    pub fn of_objects(kinds: impl IntoIterator<Item = ShareKind>) -> Self {
        let bits = kinds
            .into_iter()
            .map(|kind| Self::bit(LineKind::Object(kind)));
        Self(bits.fold(0, |set, bit| set | bit))
    }

    /// Adds the kinds of another set.
    pub fn insert_all(&mut self, other: Self) {
        self.0 |= other.0;
    }

    /// Returns `true` if the set has a kind.
    pub fn contains(self, kind: LineKind) -> bool {
        self.0 & Self::bit(kind) != 0
    }

    /// Returns the set without the kinds that a rate limit may leave out.
    #[must_use]
    pub fn without_continuous(self) -> Self {
        let all = ShareKind::ALL.iter().copied();
        Self(self.0 & !Self::of_objects(all.filter(|kind| kind.is_continuous())).0)
    }
}
