//! The check of the OpenXR runtime, which the source `openxr:` reads.

use std::time::Duration;

use super::Finding;
use super::time_limit::probe_within;
use crate::capture::SourceUri;
use crate::capture::transport::{HAS_OPENXR, describe_runtime};
use crate::setup::Setup;

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
    let tracks = described.map(|runtime| format!("{runtime} tracks hands"));
    Some(Finding::from_result("headset", needed, tracks).with_remedy_as_next_step())
}
