//! The check of the focus, which `profiles_by_application` follows.

use std::thread;
use std::time::Duration;

use crossbeam_channel::bounded;

use super::{CheckStatus, Finding};
use crate::advice;
use crate::session::focus;
use crate::setup::{ApplicationProfile, Setup};
use ademan_core::message::{escape, escape_line};

/// Longest time in which a desktop answers.
const TIMEOUT: Duration = Duration::from_secs(5);

/// The name of the desktop and the rule that holds, or the reason why the focus cannot be followed.
type Probed = Result<(&'static str, Option<ApplicationProfile>), String>;

/// Checks that the desktop tells which application has the focus, and states the rule of the setup that holds. `None` for a setup
/// without rules.
pub fn check_focus(setup: &Setup) -> Option<Finding> {
    let rules = &setup.profiles_by_application;
    if rules.is_empty() {
        return None;
    }
    let rules = rules.clone();
    let probed = probe_within(TIMEOUT, move || {
        let (desktop, rule) = focus::probe(&rules)?;
        Ok((desktop, rule.cloned()))
    });
    let (status, text) = match probed {
        Ok((desktop, rule)) => {
            let rule = rule.map_or("no rule is for it".into(), |rule| {
                let (application, profile) = (escape(&rule.application), escape(&rule.profile));
                format!("the rule for `{application}` holds, with the profile `{profile}`")
            });
            let text = format!("{desktop} tells which application has the focus; {rule}");
            (CheckStatus::Ok, text)
        }
        Err(reason) => (CheckStatus::Missing, reason),
    };
    Some(Finding {
        check: "focus",
        status,
        needed: true,
        text: escape_line(&text).into_owned(),
        commands: Vec::new(),
        next_step: String::new(),
    })
}

/// Returns the result of `probe`. It runs on a thread of its own, as a connection to a desktop that hangs has no time limit.
fn probe_within(limit: Duration, probe: impl FnOnce() -> Probed + Send + 'static) -> Probed {
    let (probed, result) = bounded(1);
    let thread = thread::Builder::new().name("focus".into());
    let run = move || _ = probed.send(probe());
    thread
        .spawn(run)
        .map_err(|error| advice::no_thread(&error).to_string())?;
    result.recv_timeout(limit).unwrap_or_else(|_| {
        let seconds = limit.as_secs();
        Err(format!(
            "the desktop does not answer within {seconds} s: it is stopped or hangs; continue it, or log in again"
        ))
    })
}
