//! Stand-in for systems without an inspection: only what the build and the environment tell.

use std::path::Path;

use super::super::Requirements;
use super::super::facts::{
    Compositor, DeviceNode, Facts, RuntimeDir, UinputFacts, User, WatchdogScope, XDisplay,
};
use crate::output::SUPPORTS_WAYLAND;
use crate::priority;

/// The environment variables, none of which is used here.
pub(in crate::doctor) struct Environment;

impl Environment {
    /// Reads no variable.
    pub fn from_process() -> Self {
        Self
    }
}

/// Returns facts of which most are unknown.
pub(in crate::doctor) fn gather_facts(
    _: &Path,
    _: &Environment,
    requirements: &Requirements,
) -> Facts {
    let unknown = || DeviceNode::Error("not checked on this system; start a session to see".into());
    let ports = requirements.ports.iter();
    Facts {
        user: User {
            name: "unknown user".into(),
            ..User::default()
        },
        ports: ports.map(|port| (port.clone(), unknown())).collect(),
        uinput: UinputFacts {
            node: DeviceNode::Error("exists only on Linux; use the output `desktop`".into()),
            is_loaded: false,
            can_be_loaded: None,
        },
        display: XDisplay::Unknown("the desktop is not checked on this system".into()),
        compositor: Compositor::Unset,
        has_wayland: SUPPORTS_WAYLAND,
        granted_nice: priority::granted_nice(),
        watchdog_scope: WatchdogScope::Unavailable,
        runtime: RuntimeDir::Absent,
    }
}

/// Returns `false`.
pub(in crate::doctor) fn is_running_as_root() -> bool {
    false
}
