//! Settings of the pipeline.

use std::time::Duration;

use super::SourcePermissions;
use crate::estimate::max_sweep;

/// Settings of a [`Pipeline`](super::Pipeline): arming, stall detection and permissions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PipelineSettings {
    /// `true` to arm output at the first reading, without waiting for a hand that is clear of every control.
    pub arm_immediately: bool,
    /// The time for which the hand must be clear of every control before output is armed.
    pub arm_delay: Duration,
    /// The longest gap between two readings; after a longer one everything is released.
    pub stall_timeout: Duration,
    /// The permissions of the source, or of the first one if each hand has its own. If the rate limit is exceeded,
    /// everything is released and the pipeline pauses.
    pub permissions: SourcePermissions,
    /// `true` to allow keys that act on the system; see [`KeyCode::is_system_key`](crate::device::KeyCode::is_system_key).
    pub allow_system_keys: bool,
}

impl PipelineSettings {
    /// Returns the longest gap between two readings in which a fingertip may enter a target: three quarters of the stall timeout.
    ///
    /// In a longer one a fingertip can leave a key and press the next one; the straight line between both enters the keys beside them. A
    /// source with a known packet period that loses one packet has a gap of two periods, two thirds of the shortest stall timeout of a
    /// session. Any other source, such as a camera, needs more than seven readings per second to press a key with the default of 200 ms.
    pub(super) fn max_sweep(&self) -> Duration {
        max_sweep(self.stall_timeout)
    }
}

impl Default for PipelineSettings {
    /// Armed after 300 ms clear of every control; stalled after 200 ms; a local source; no system keys.
    fn default() -> Self {
        Self {
            arm_immediately: false,
            arm_delay: Duration::from_millis(300),
            stall_timeout: Duration::from_millis(200),
            permissions: SourcePermissions::LOCAL,
            allow_system_keys: false,
        }
    }
}
