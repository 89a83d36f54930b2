//! What was found on a machine, without a word on whether that is good.

use std::path::PathBuf;

use crate::advice::AccessDenied;

/// What was found on a machine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Facts {
    /// Who asks.
    pub user: User,
    /// Serial ports by their names: those that are wanted, and USB adapters that are there.
    pub ports: Vec<(String, DeviceNode)>,
    /// The way to make devices of the kernel.
    pub uinput: UinputFacts,
    /// What `DISPLAY` names.
    pub display: XDisplay,
    /// What `WAYLAND_DISPLAY` names.
    pub compositor: Compositor,
    /// Whether this program was built to speak with a compositor.
    pub has_wayland: bool,
    /// Where the control socket would be.
    pub runtime: RuntimeDir,
}

/// Who asks.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct User {
    /// The login name; the number where there is none.
    pub name: String,
    /// Whether the user may do everything.
    pub is_root: bool,
    /// The groups that count in this session.
    pub groups: Vec<String>,
}

/// A device file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DeviceNode {
    /// It is not there.
    Absent,
    /// It is there, and this user may not read and write it.
    Denied(AccessDenied),
    /// This user may read and write it.
    Usable,
    /// It cannot be looked at, for this reason.
    Error(String),
}

/// `/dev/uinput` and the module behind it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UinputFacts {
    /// The device file; absent too when there is nothing behind it.
    pub node: DeviceNode,
    /// Whether the kernel has the module in it now.
    pub is_loaded: bool,
    /// Whether it could be loaded; `None` where the files of the kernel are not at hand, as in a container.
    pub can_be_loaded: Option<bool>,
}

/// An X server.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum XDisplay {
    /// `DISPLAY` is not set.
    Unset,
    /// It is this one, and somebody listens there.
    Reachable(String),
    /// It is this one, and nobody listens there.
    Unreachable(String),
    /// Only using it shows whether there is one, for this reason.
    Unknown(String),
}

/// A Wayland compositor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Compositor {
    /// `WAYLAND_DISPLAY` is not set.
    Unset,
    /// It is this socket, and nobody tells there what he has.
    Unreachable {
        /// The socket.
        socket: PathBuf,
        /// What happened.
        reason: String,
    },
    /// Somebody has told what he has.
    Reachable {
        /// The program at the other end; `None` where it cannot be seen.
        program: Option<String>,
        /// The interfaces that it offers to this program, such as `zwp_virtual_keyboard_manager_v1`.
        globals: Vec<String>,
    },
}

/// The runtime folder of the user and the control socket in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RuntimeDir {
    /// `XDG_RUNTIME_DIR` names no folder.
    Absent,
    /// It does, and the control socket has its place in it.
    Present {
        /// Where the control socket is, or would be.
        socket: PathBuf,
        /// Who listens there; `None` when nobody does.
        run: Option<RunningInstance>,
    },
}

/// A run that listens at its control socket.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RunningInstance {
    /// Its process; `None` where it cannot be seen.
    pub process: Option<i32>,
}
