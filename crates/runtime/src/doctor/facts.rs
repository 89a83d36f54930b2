//! The facts about a machine, without a judgement.

use std::path::PathBuf;

use crate::advice::AccessDenied;

/// The facts about a machine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Facts {
    /// User of this process.
    pub user: User,
    /// Serial ports by name: those that are required, and all USB adapters.
    pub ports: Vec<(String, DeviceNode)>,
    /// Kernel module and device node of `uinput`.
    pub uinput: UinputFacts,
    /// X server that `DISPLAY` names.
    pub display: XDisplay,
    /// Compositor that `WAYLAND_DISPLAY` names.
    pub compositor: Compositor,
    /// `true` if this program was built with Wayland support.
    pub has_wayland: bool,
    /// Nice value of the threads that press and release keys, 0 for the normal priority.
    pub granted_nice: i32,
    /// Control group of the watchdog.
    pub watchdog_scope: WatchdogScope,
    /// Directory of the control socket.
    pub runtime: RuntimeDir,
}

/// A user and the groups of the session.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct User {
    /// Login name, or the user id if there is none.
    pub name: String,
    /// `true` if the user is root.
    pub is_root: bool,
    /// Groups of this process.
    pub groups: Vec<String>,
}

/// The state of a device node.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DeviceNode {
    /// The node does not exist.
    Absent,
    /// The user may not read and write it.
    Denied(AccessDenied),
    /// The user may read and write it.
    Usable,
    /// The node cannot be inspected, for this reason.
    Error(String),
}

/// The kernel module `uinput` and its device node.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UinputFacts {
    /// The node `/dev/uinput`; absent also if no driver is behind it.
    pub node: DeviceNode,
    /// `true` if the module is loaded.
    pub is_loaded: bool,
    /// `true` if the kernel has the module; `None` if its files are not visible, as in a container.
    pub can_be_loaded: Option<bool>,
}

/// The state of an X server.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum XDisplay {
    /// `DISPLAY` is not set.
    Unset,
    /// A server accepts connections at this display.
    Reachable(String),
    /// No server answers at this display.
    Unreachable(String),
    /// The server of the display refuses the connection, for the reason that it states.
    Refused(String),
    /// Only a test can tell, for this reason.
    Unknown(String),
}

/// The state of a Wayland compositor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Compositor {
    /// `WAYLAND_DISPLAY` is not set.
    Unset,
    /// No compositor answers at this socket.
    Unreachable {
        /// The socket.
        socket: PathBuf,
        /// Error.
        reason: String,
    },
    /// A compositor answered.
    Reachable {
        /// Name of its program; `None` if it is not visible.
        program: Option<String>,
        /// Interfaces that it offers, such as `zwp_virtual_keyboard_manager_v1`.
        globals: Vec<String>,
    },
}

/// The control group of the watchdog. What kills a control group kills all processes in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WatchdogScope {
    /// The watchdog of the running session has a systemd scope of its own.
    Separate,
    /// The watchdog of the running session is in the control group of the program.
    Shared,
    /// No session runs, and a user manager of systemd can create a scope.
    Available,
    /// No session runs, and there is no user manager of systemd.
    Unavailable,
}

/// The runtime directory of the user, and the control socket in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RuntimeDir {
    /// `XDG_RUNTIME_DIR` is not a directory.
    Absent,
    /// The directory exists.
    Present {
        /// Path of the control socket.
        socket: PathBuf,
        /// Process that listens on the socket, if any.
        run: Option<RunningInstance>,
    },
}

/// A running instance of this program that listens on its control socket.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RunningInstance {
    /// Process id; `None` if it is not visible.
    pub process: Option<i32>,
}
