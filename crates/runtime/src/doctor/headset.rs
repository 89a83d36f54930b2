//! The check of the OpenXR runtime, which the source `openxr:` reads.

use std::time::Duration;

use super::time_limit::probe_within;
use super::{CheckStatus, Finding};
use crate::capture::SourceUri;
use crate::capture::transport::{HAS_OPENXR, describe_runtime};
use crate::setup::Setup;
use ademan_core::message::escape_line;

/// Longest time in which a runtime answers. It may have to start its service first.
const TIMEOUT: Duration = Duration::from_secs(10);

/// The remedy for a runtime that does not answer.
const REMEDY: &str = "end it and start it again";

/// Checks that an OpenXR runtime answers and that its headset tracks hands, without starting a session. Returns `None` if neither
/// the setup nor this build uses one.
pub fn check_headset(setup: &Setup) -> Option<Finding> {
    let needed = setup.source_uris().any(SourceUri::is_openxr);
    if !needed && !HAS_OPENXR {
        return None;
    }
    let described = probe_within(TIMEOUT, "the OpenXR runtime", REMEDY, describe_runtime);
    let (status, text) = match described {
        Ok(runtime) => (CheckStatus::Ok, format!("{runtime} tracks hands")),
        Err(error) => (CheckStatus::Missing, error),
    };
    let (text, next_step) = text.rsplit_once("; ").unwrap_or((&text, ""));
    Some(Finding {
        check: "headset",
        status,
        needed,
        text: escape_line(text).into_owned(),
        commands: Vec::new(),
        next_step: escape_line(next_step).into_owned(),
    })
}
