//! The check of the focus, which `profiles_by_application` follows.

use std::time::Duration;

use super::Finding;
use super::time_limit::probe_within;
use crate::session::focus;
use crate::setup::Setup;
use ademan_core::message::escape;

/// Longest time in which a desktop answers.
const TIMEOUT: Duration = Duration::from_secs(5);

/// The remedy for a desktop that does not answer.
const REMEDY: &str = "continue it, or log in again";

/// Checks that the desktop tells which application has the focus, and states the rule of the setup that holds. `None` for a setup
/// without rules.
pub fn check_focus(setup: &Setup) -> Option<Finding> {
    let rules = &setup.profiles_by_application;
    if rules.is_empty() {
        return None;
    }
    let rules = rules.clone();
    let probed = probe_within(TIMEOUT, "the desktop", REMEDY, move || {
        let (desktop, rule) = focus::probe(&rules)?;
        Ok((desktop, rule.cloned()))
    });
    let followed = probed.map(|(desktop, rule)| {
        let rule = rule.map_or("no rule matches it".into(), |rule| {
            let (application, profile) = (escape(&rule.application), escape(&rule.profile));
            format!("the rule for `{application}` holds, with the profile `{profile}`")
        });
        format!("{desktop} tells which application has the focus; {rule}")
    });
    Some(Finding::from_result("focus", true, followed))
}
