//! The check of what a setup shares, which a session refuses to start without.

use std::sync::Arc;

use super::{CheckStatus, Finding};
use crate::setup::LoadedSetup;
use crate::share::ShareHub;
use ademan_core::message::escape_line;

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
    let (status, text) = match started {
        Ok(()) => {
            let names: Vec<String> = targets.iter().map(ToString::to_string).collect();
            let text = format!("a session can share with {}", names.join(", "));
            (CheckStatus::Ok, text)
        }
        Err(error) => (CheckStatus::Missing, error.to_string()),
    };
    let (text, next_step) = text.rsplit_once("; ").unwrap_or((&text, ""));
    Some(Finding {
        check: "share",
        status,
        needed: true,
        text: escape_line(text).into_owned(),
        commands: Vec::new(),
        next_step: escape_line(next_step).into_owned(),
    })
}
