//! The check of what a setup shares, which a session refuses to start without.

use std::sync::Arc;

use super::Finding;
use crate::setup::LoadedSetup;
use crate::share::ShareHub;

/// Checks that a session can share with the targets of a setup. Returns `None` for a setup without targets.
///
/// Listens at their addresses for a moment.
pub fn check_share(setup: &LoadedSetup) -> Option<Finding> {
    let targets = &setup.setup.share;
    if targets.is_empty() {
        return None;
    }
    let layout = Arc::new(setup.layout.clone());
    let started = ShareHub::start(targets, setup.arm.side(), layout).map(drop);
    let shared = match started {
        Ok(()) => {
            let names: Vec<String> = targets.iter().map(ToString::to_string).collect();
            Ok(format!("a session can share with {}", names.join(", ")))
        }
        Err(error) => Err(error.to_string()),
    };
    Some(Finding::from_result("share", true, shared).with_remedy_as_next_step())
}
