//! Tiers of tracking quality.

use super::Participant;
use crate::hand::Finger;
use crate::names::named_enum;

named_enum! {
    /// A tier of quality: the scatter, the missed and the spurious taps, as in `docs/typing-measured.md`. What a tier does not set
    /// comes from the person.
    pub enum Tier ("tier") {
        /// 3 mm.
        T0 = "T0",
        /// 5 mm.
        T1 = "T1",
        /// 6 mm, 2 % spurious, 2 % missed.
        T2 = "T2",
        /// 8 mm, 2 % spurious, 2 % missed.
        T3 = "T3",
        /// 10 mm, 3 % spurious, 3 % missed, and neighbors that follow a pressing finger by the whole of their published fractions.
        T4 = "T4",
        /// 4 mm, an offset of 8 mm that grows by a random walk of 0.4 mm a tap, as of a board that has moved.
        Toff = "Toff",
    }
}

/// The offset of [`Tier::Toff`], in millimetres.
const OFFSET: f64 = 8.0;
/// Its random walk, in millimetres a tap.
const WALK: f64 = 0.4;
/// The deviation of the depth in all tiers, in millimetres: a tier is about the plane of the board.
const DEPTH_SCATTER: f64 = 1.0;
/// The depth beyond the travel in all tiers, in millimetres.
const DEPTH: f64 = 4.0;

impl Tier {
    /// Returns the deviation along each axis of the board, in millimetres.
    pub fn scatter(self) -> f64 {
        match self {
            Self::T0 => 3.0,
            Self::T1 => 5.0,
            Self::T2 => 6.0,
            Self::T3 => 8.0,
            Self::T4 => 10.0,
            Self::Toff => 4.0,
        }
    }

    fn missed_and_spurious(self) -> f64 {
        match self {
            Self::T0 | Self::T1 | Self::Toff => 0.0,
            Self::T2 | Self::T3 => 0.02,
            Self::T4 => 0.03,
        }
    }

    /// Sets the scatter, the offset and the faults of a person to the values of the tier. `direction` is the direction of the offset, in
    /// radians.
    pub(super) fn apply(self, person: &mut Participant, direction: f64) {
        let offset = match self {
            Self::Toff => OFFSET,
            _ => 0.0,
        };
        person.scatter = [self.scatter(); 2];
        person.scatter_parts = [0.0; 2];
        person.elongation = 0.0;
        person.depth = DEPTH;
        person.depth_scatter = DEPTH_SCATTER;
        person.offsets = [[offset * direction.cos(), offset * direction.sin()]; Finger::COUNT];
        person.drift = if self == Self::Toff { WALK } else { 0.0 };
        person.drift_kept = 1.0;
        person.sway = 0.0;
        person.slip = 0.0;
        person.missed = self.missed_and_spurious();
        person.spurious = self.missed_and_spurious();
        if self == Self::T4 {
            person.enslaving = 1.0;
        }
        person.adaptation = 1.0;
    }
}
