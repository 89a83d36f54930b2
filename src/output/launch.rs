//! What every system knows of guardians: how one is started, and how often it hears of the program.

use std::ffi::OsString;
use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// How often the program gives a sign of life while something is down.
pub(super) const HEARTBEAT_INTERVAL: Duration = Duration::from_millis(50);

/// How a guardian is started, and who hears that one was lost.
#[derive(Clone)]
pub struct WatchdogSettings {
    /// The program: this one, as a rule.
    pub program: PathBuf,
    /// What makes it call [`watch`](super::guardian::watch).
    pub arguments: Vec<OsString>,
    /// Called when a guardian has ended that should not have: everything was let go of by then, and another
    /// one is started, once. Must not wait.
    pub on_lost: Arc<dyn Fn() + Send + Sync>,
}

impl fmt::Debug for WatchdogSettings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?} {:?}", self.program, self.arguments)
    }
}
