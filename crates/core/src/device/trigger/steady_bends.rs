//! The bends of the fingers without outliers of single readings.

use crate::device::DeviceInput;
use crate::estimate::FingerBends;
use crate::hand::Finger;

/// The median of the last three bends of each finger: a camera that takes a closed finger for a straight one for one picture neither
/// ends a shape nor begins one.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SteadyBends {
    /// The bends of the last readings, latest first.
    last: [FingerBends; 3],
    median: FingerBends,
}

impl SteadyBends {
    /// Processes the next step of the hand. Nothing is known of a finger in its first two readings, nor without delay of one that is
    /// not measured, not finite or not trusted.
    pub(super) fn update(&mut self, input: &DeviceInput) {
        if input.pose.jumped {
            *self = Self::default();
        }
        self.last.rotate_right(1);
        self.last[0] = *input.bends;
        for &finger in Finger::ALL {
            let is_trusted = !input.pose.untrusted.contains(finger);
            let bends = self.last.map(|bends| {
                let bend = bends.get(finger);
                bend.filter(|bend| is_trusted && bend.is_finite())
            });
            let median = match bends {
                [Some(a), Some(b), Some(c)] => Some(a.min(b).max(a.max(b).min(c))),
                _ => None,
            };
            self.median.set(finger, median);
        }
    }

    /// Returns the bends.
    pub(super) fn get(&self) -> &FingerBends {
        &self.median
    }
}
