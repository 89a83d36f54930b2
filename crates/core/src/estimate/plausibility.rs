//! Angles and hands that cannot be trusted, because too many of their readings are implausible: a loose wire, or too much noise.

use super::{Estimate, Rejection};
use crate::hand::{Dof, DofSet, FingerSet, JointAngles};
use crate::time::Timestamp;

/// The time constant of the fractions of readings, in seconds.
const SPAN: f64 = 0.4;

/// The largest weight of a reading in a fraction, so that the three readings after which a jump is accepted do not make a slow source
/// untrusted.
const MAX_WEIGHT: f64 = 0.08;

/// The fraction of implausible readings above which an angle is unreliable, and below which it is reliable again. A glove with a noise
/// of 3 counts of 255 has up to 0.12 at its steepest sensor, a loose wire 0.7.
const ANGLE: Limits = Limits {
    high: 0.25,
    low: 0.15,
};

/// The fraction of rejected readings above which a hand is not trusted, and below which it is trusted again. A glove with a noise of 3
/// counts has 0.17.
const HAND: Limits = Limits {
    high: 0.35,
    low: 0.2,
};

/// The level at or below which a fraction counts as 0.
const NEGLIGIBLE: f64 = 1e-3;

/// The limits of a fraction, with hysteresis.
struct Limits {
    high: f64,
    low: f64,
}

/// The fraction of readings that were implausible, 0..=1, as an exponential moving average.
#[derive(Clone, Copy, Debug, Default)]
struct ImplausibleFraction {
    level: f64,
    is_high: bool,
}

impl ImplausibleFraction {
    fn update(&mut self, is_implausible: bool, weight: f64, limits: &Limits) {
        let target = if is_implausible { 1.0 } else { 0.0 };
        self.level += (target - self.level) * weight;
        self.is_high = self.level > limits.high || self.is_high && self.level >= limits.low;
    }
}

/// The parts of a hand that are not trusted because their readings are implausible.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Implausible {
    /// The angles that jump or are outside the range of their joint.
    pub angles: DofSet,
    /// `true` if the whole hand is not trusted, because too many of its readings were rejected.
    pub is_hand: bool,
}

impl Implausible {
    /// Returns `true` if the position of the hand is not trusted.
    pub fn concerns_hand(self) -> bool {
        self.is_hand || self.angles.iter().any(|dof| dof.finger().is_none())
    }

    /// Returns the fingers that are not trusted.
    pub fn fingers(self) -> FingerSet {
        if self.concerns_hand() {
            return FingerSet::ALL;
        }
        let fingers = self.angles.iter().filter_map(Dof::finger);
        fingers.fold(FingerSet::NONE, FingerSet::with)
    }

    /// Returns the parts that are in either.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self {
            angles: self.angles.union(other.angles),
            is_hand: self.is_hand || other.is_hand,
        }
    }
}

/// The plausibility of the latest readings of one source.
#[derive(Clone, Debug, Default)]
pub(super) struct Plausibility {
    /// The time of the latest reading, accepted or not.
    time: Timestamp,
    hand: ImplausibleFraction,
    angles: [ImplausibleFraction; Dof::COUNT],
    /// The unreliable angles.
    unreliable: DofSet,
    /// The angles that are implausible in the present reading.
    blamed: DofSet,
    /// The angles that were removed from the present reading.
    removed: DofSet,
    /// The angles of the reading before, while some are unreliable.
    previous: JointAngles,
    /// `true` if a fraction is not negligible.
    is_active: bool,
    /// `true` if an angle or the hand is trusted again.
    has_recovered: bool,
}

impl Plausibility {
    /// Returns the parts that are not trusted.
    pub fn implausible(&self) -> Implausible {
        Implausible {
            angles: self.unreliable,
            is_hand: self.hand.is_high,
        }
    }

    /// Records that an angle of the present reading is outside the range of its joint. Returns `true` if the angle is unreliable anyway, so
    /// that the reading need not be rejected.
    pub fn note_outside(&mut self, dof: Dof) -> bool {
        self.blamed = self.blamed.with(dof);
        self.unreliable.contains(dof)
    }

    /// Records the angles that differ by more than `reach` radians from the last accepted angles as implausible.
    pub fn note_jumps(&mut self, reach: f64, angles: &JointAngles, last: &JointAngles) {
        for (dof, radians) in angles.known() {
            if last.is_known(dof) && (radians - last.get(dof)).abs() > reach {
                self.blamed = self.blamed.with(dof);
            }
        }
    }

    /// Returns the time of the latest reading.
    pub fn time(&self) -> Timestamp {
        self.time
    }

    /// Removes the unreliable angles from a reading. Unreliable angles that differ by more than `reach` radians from the previous reading
    /// are recorded as implausible.
    pub fn remove_unreliable(&mut self, reach: f64, angles: &mut JointAngles) {
        let before = std::mem::replace(&mut self.removed, self.unreliable);
        // An angle that becomes reliable again may have changed by any amount.
        self.has_recovered |= !before.difference(self.removed).is_empty();
        if self.removed.is_empty() {
            return;
        }
        let previous = std::mem::replace(&mut self.previous, *angles);
        for dof in self.removed.iter() {
            let has_jumped = (angles.get(dof) - previous.get(dof)).abs() > reach;
            if angles.is_known(dof) && previous.is_known(dof) && has_jumped {
                self.blamed = self.blamed.with(dof);
            }
            angles.remove(dof);
        }
    }

    /// Updates the fractions with the outcome of a reading.
    pub fn update(&mut self, time: Timestamp, outcome: Result<(), Rejection>) {
        let elapsed = time.since(std::mem::replace(&mut self.time, time));
        let is_rejected = matches!(outcome, Err(Rejection::TooFast | Rejection::OutsideLimits));
        let blamed = std::mem::take(&mut self.blamed);
        if !self.is_active && !is_rejected {
            return;
        }
        let weight = (elapsed.as_secs_f64() / SPAN).min(MAX_WEIGHT);
        let was_high = self.hand.is_high;
        self.hand.update(is_rejected, weight, &HAND);
        self.is_active = self.hand.level > NEGLIGIBLE;
        let mut unreliable = DofSet::NONE;
        for &dof in Dof::ALL {
            let fraction = &mut self.angles[dof.index()];
            fraction.update(blamed.contains(dof), weight, &ANGLE);
            self.is_active |= fraction.level > NEGLIGIBLE;
            if fraction.is_high {
                unreliable = unreliable.with(dof);
            }
        }
        self.unreliable = unreliable;
        self.has_recovered |= was_high && !self.hand.is_high;
    }

    /// Makes the finger of each angle that is unreliable or was removed untrusted, or the whole hand for an angle of the arm. Once they are
    /// trusted again, the estimate jumps.
    pub fn distrust(&mut self, estimate: &mut Estimate) {
        estimate.jumped |= std::mem::take(&mut self.has_recovered);
        let implausible = Implausible {
            angles: self.unreliable.union(self.removed),
            is_hand: self.hand.is_high,
        };
        estimate.untrusted = estimate.untrusted.union(implausible.fingers());
        estimate.is_placed &= !implausible.concerns_hand();
    }
}
