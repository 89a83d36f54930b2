//! The finger of a person for each target of a board.

use super::motor::TypingKeys;
use super::typing_hand::TypingHand;
use crate::contact::TargetId;
use crate::contact::surface::{Surface, Target};
use crate::hand::{Finger, FingerSet, Side};

/// Half the breadth of a column of keys, in metres.
const HALF_COLUMN: f32 = 0.0095;

/// Largest distance of two keys of one row across the row, and of two columns that are one, in metres.
const SAME_ROW: f32 = 0.002;

/// Rounding of a key that is exactly between two columns, in columns.
const BETWEEN_COLUMNS: f32 = 1e-3;

/// The division of boards between the fingers of a hand.
pub(super) struct FingerAssignment<'a> {
    /// The hand.
    pub(super) hand: &'a TypingHand,
    /// The fingers that press.
    pub(super) fingers: FingerSet,
    /// The keys by which the fingers find theirs.
    pub(super) keys: &'a TypingKeys,
}

impl FingerAssignment<'_> {
    /// Returns the fingers of the person for a target on a board that the hand moves to, best first; empty if the layout decides.
    ///
    /// The columns of the board are divided between the fingers: on a board of this hand with F or J as touch typing is taught, and
    /// otherwise those below a hand above the middle of the board, in proportion on a wider board. The thumb presses the space bar.
    pub(super) fn fingers_for(&self, surface: &Surface, target: TargetId) -> Vec<Finger> {
        let used = Finger::ALL.iter().copied();
        let used: Vec<Finger> = used
            .filter(|finger| self.fingers.contains(*finger))
            .collect();
        if self.fingers.contains(Finger::Thumb) && self.keys.space.contains(&target) {
            let others = used.into_iter().filter(|finger| *finger != Finger::Thumb);
            return std::iter::once(Finger::Thumb).chain(others).collect();
        }
        let taught = self.taught_finger(surface, target);
        let column = self.column(surface, target, self.fingers).unwrap_or(0.0);
        let distance = |finger: Finger| match (finger, taught) {
            // The thumb is below the others, and presses keys only if no other finger can.
            (Finger::Thumb, _) => f32::INFINITY,
            (_, Some(taught)) => finger.index().abs_diff(taught.index()) as f32,
            (_, None) => {
                let x = self.finger_x(surface, finger).unwrap_or(f32::INFINITY);
                (x - column).abs()
            }
        };
        let mut fingers: Vec<(Finger, f32)> = used
            .into_iter()
            .map(|finger| (finger, distance(finger)))
            .collect();
        fingers.sort_by(|a, b| a.1.total_cmp(&b.1));
        fingers.into_iter().map(|(finger, _)| finger).collect()
    }

    /// Returns the finger that touch typists use for a target: the index finger for the column of F or J and those towards the other
    /// hand, and one finger for each column away from it. A key between two columns belongs to the left one, as rows are staggered.
    fn taught_finger(&self, surface: &Surface, target: TargetId) -> Option<Finger> {
        let side = surface.side()?;
        let mut home = self.keys.home.iter();
        let home = home.find_map(|home| surface.target(*home))?;
        let position = |key: &Target| key.surface_from_target.translation;
        let home = position(home);
        let beside = surface.targets().filter_map(|(_, other)| {
            let offset = position(other) - home;
            (offset.y.abs() < SAME_ROW && offset.x.abs() > SAME_ROW).then_some(offset.x.abs())
        });
        let pitch = beside.fold(f32::INFINITY, f32::min);
        let columns = (position(surface.target(target)?).x - home.x) / pitch;
        let to_the_right = (columns - 0.5 - BETWEEN_COLUMNS).ceil();
        let outward = match side {
            Side::Right => to_the_right,
            Side::Left => -to_the_right,
        };
        let fingers = [Finger::Index, Finger::Middle, Finger::Ring, Finger::Little];
        Some(fingers[outward.clamp(0.0, 3.0) as usize])
    }

    /// Returns the X of a target relative to the middle finger, in metres, as far as the fingers span the board.
    fn column(&self, surface: &Surface, target: TargetId, fingers: FingerSet) -> Option<f32> {
        let x_of = |key: &Target| key.surface_from_target.translation.x;
        let own = x_of(surface.target(target)?);
        let xs = surface.targets().map(|(_, other)| x_of(other));
        let (min, max) = xs.fold((f32::INFINITY, f32::NEG_INFINITY), |(min, max), x| {
            (min.min(x), max.max(x))
        });
        let pressing = fingers.without(Finger::Thumb);
        let candidates = Finger::ALL
            .iter()
            .filter(|finger| pressing.contains(**finger));
        let span = candidates
            .filter_map(|finger| self.finger_x(surface, *finger))
            .fold(0.0_f32, |span, x| span.max(x.abs()));
        let half_width = (max - min) / 2.0;
        let scale = ((span + HALF_COLUMN) / (half_width + HALF_COLUMN)).min(1.0);
        Some((own - min.midpoint(max)) * scale)
    }

    /// Returns the X of a half bent finger on the board relative to the middle finger, in metres.
    fn finger_x(&self, surface: &Surface, finger: Finger) -> Option<f32> {
        let pose = self.hand.half_bent_pose();
        let world_from_surface = surface.world_from_surface(&pose)?;
        let x_of = |digit| {
            let tip = pose.fingertip(digit)?;
            Some(world_from_surface.inverse_transform_point(tip).x)
        };
        Some(x_of(finger)? - x_of(Finger::Middle)?)
    }
}
