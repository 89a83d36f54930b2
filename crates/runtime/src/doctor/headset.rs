//! The check of the OpenXR runtime, which the source `openxr:` reads.

use super::{CheckStatus, Finding};
use crate::capture::SourceUri;
use crate::capture::transport::{HAS_OPENXR, describe_runtime};
use crate::setup::Setup;
use ademan_core::message::escape_line;

/// Checks that an OpenXR runtime answers and that its headset tracks hands, without starting a session. Returns `None` if neither
/// the setup nor this build uses one.
pub fn check_headset(setup: &Setup) -> Option<Finding> {
    let needed = setup.source_uris().any(SourceUri::is_openxr);
    if !needed && !HAS_OPENXR {
        return None;
    }
    let (status, text) = match describe_runtime() {
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
