//! Lookup from a target to the control that it belongs to.

use crate::contact::TargetId;

/// The index of the control that each target belongs to. A lookup takes constant time.
#[derive(Clone, Debug, Default)]
pub(super) struct TargetIndex(Vec<Option<u32>>);

impl TargetIndex {
    /// Maps the `i`-th target to control `i`. If a target occurs several times, its first control wins.
    pub(super) fn new(
        targets: impl DoubleEndedIterator<Item = TargetId> + ExactSizeIterator,
    ) -> Self {
        let mut controls = Vec::new();
        for (control, TargetId(target)) in targets.enumerate().rev() {
            let target = target as usize;
            if controls.len() <= target {
                controls.resize(target + 1, None);
            }
            controls[target] = Some(control as u32);
        }
        Self(controls)
    }

    /// Returns the index of the control that a target belongs to.
    pub(super) fn get(&self, target: TargetId) -> Option<usize> {
        let control = (*self.0.get(target.0 as usize)?)?;
        Some(control as usize)
    }
}
