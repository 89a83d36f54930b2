//! From a target to the control that it belongs to.

use crate::contact::TargetId;

/// For each target the place of its control in a list; a lookup costs the same for any number of them.
#[derive(Clone, Debug, Default)]
pub(super) struct Places(Vec<Option<u32>>);

impl Places {
    /// Target `targets[i]` belongs to control `i`; of several with the same target the first counts.
    pub(super) fn new(
        targets: impl DoubleEndedIterator<Item = TargetId> + ExactSizeIterator,
    ) -> Self {
        Self::of_pairs(targets.enumerate().rev())
    }

    /// Each pair is a control and one of its targets; of several with the same target the last counts.
    pub(super) fn of_pairs(pairs: impl Iterator<Item = (usize, TargetId)>) -> Self {
        let mut places = Vec::new();
        for (place, TargetId(target)) in pairs {
            let target = target as usize;
            if places.len() <= target {
                places.resize(target + 1, None);
            }
            places[target] = Some(place as u32);
        }
        Self(places)
    }

    /// The place of the control that a target belongs to.
    pub(super) fn of(&self, target: TargetId) -> Option<usize> {
        let place = (*self.0.get(target.0 as usize)?)?;
        Some(place as usize)
    }
}
