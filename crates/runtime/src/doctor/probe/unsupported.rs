//! Stand-in for systems without an inspection: only what the build and the environment tell.

use std::path::Path;

use super::super::Requirements;
use super::super::facts::{
    Compositor, DeviceNode, Facts, RunningInstance, RuntimeDir, UinputFacts, User, WatchdogScope,
    XDisplay,
};
use crate::output::{SUPPORTS_WAYLAND, socket};
use crate::priority;
use crate::session::control_socket;

/// Checks of parts that only Linux has: groups of devices, uinput, X servers, compositors, limits of the priority and scopes of
/// systemd.
pub(in crate::doctor) const ABSENT: &[&str] = &[
    "user",
    "uinput",
    "display",
    "compositor",
    "priority",
    "watchdog",
];

/// The facts do not list serial ports that the setup does not name.
pub(in crate::doctor) const LISTS_PORTS: bool = false;

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
        runtime: runtime(),
    }
}

/// Returns the control socket, and whether a session listens there.
fn runtime() -> RuntimeDir {
    let Some(socket) = control_socket::default_path() else {
        return RuntimeDir::Absent;
    };
    let run = socket::connect(&socket).ok();
    RuntimeDir::Present {
        socket,
        run: run.map(|_| RunningInstance::default()),
    }
}

/// Returns `false`.
pub(in crate::doctor) fn is_running_as_root() -> bool {
    false
}
