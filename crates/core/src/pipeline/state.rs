//! The state of the pipeline and the counts of suppressed events.

use serde::Serialize;

use crate::names::named_enum;

named_enum! {
    /// The state of a pipeline.
    #[derive(Default)]
    pub enum PipelineState ("state") {
        /// No reading has been received.
        #[default]
        Starting = "starting",
        /// No events are emitted: until the hand is clear of every control, or until a requested pause ends.
        Paused = "paused",
        /// Touches become events.
        Running = "running",
        /// Readings stopped. Everything is released.
        Stalled = "stalled",
        /// The session has ended.
        Stopped = "stopped",
    }
}

/// The numbers of suppressed events, by reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Suppressed {
    /// Presses beyond the rate limit.
    pub rate_limited: u64,
    /// Presses of keys that act on the system, alone or together with pressed keys, and such keys that were released
    /// early because of them.
    pub system_keys: u64,
    /// Keys and characters of a source whose role is `Pointer`.
    pub keys_by_role: u64,
    /// Motions and buttons of a source whose role is `Keys`.
    pub pointing_by_role: u64,
}

impl Suppressed {
    /// Returns the total.
    pub const fn total(&self) -> u64 {
        self.rate_limited + self.system_keys + self.keys_by_role + self.pointing_by_role
    }
}
