//! Options of a session that are not part of a setup.

use std::ffi::OsString;
use std::path::PathBuf;

use super::control_socket::default_path;
use super::notice::Notice;
use crate::capture::{Haptics, Source};
use crate::output::Sink;
use crate::share::ShareTarget;
use ademan_core::command::Command;

/// A function that receives notices.
pub type NoticeReceiver = Box<dyn FnMut(Notice) + Send>;

/// Options of a session. The default is a session without control socket, recording, watched files or messages.
#[derive(Default)]
pub struct SessionOptions {
    /// Name of the session for displays, such as the file of its setup. Default: its first layout, without folders.
    pub name: Option<String>,
    /// Source that replaces the source of the setup.
    pub source: Option<Box<dyn Source>>,
    /// Playback speed of a source that is not live, 1 for real time; `None` for as fast as possible.
    pub speed: Option<f64>,
    /// Waits for a device that cannot be opened yet.
    pub wait_for_source: bool,
    /// Output that replaces the outputs of the setup. It is not checked against the layouts.
    pub output: Option<Box<dyn Sink>>,
    /// Program that releases keys when this process cannot.
    pub watchdog: Option<WatchdogProgram>,
    /// Path of a recording to create.
    pub record_to: Option<PathBuf>,
    /// Path of a BVH file to create, with the poses of the hands that are seen first.
    pub record_bvh_to: Option<PathBuf>,
    /// Formats and addresses in which the hand is shared with other programs.
    pub share: Vec<ShareTarget>,
    /// Feedback to the gloves.
    pub haptics: Haptics,
    /// Control socket for other programs.
    pub control_socket: ControlSocket,
    /// Activates layout files when they are saved.
    pub watch_layouts: bool,
    /// Pauses the session on the `panic_keys` of the setup.
    pub use_panic_keys: bool,
    /// Activates profiles by the `profiles_by_application` of the setup.
    pub follow_focus: bool,
    /// Shows an icon in the tray of the desktop.
    pub tray: bool,
    /// Shows pauses and losses as notifications of the desktop.
    pub notify: bool,
    /// Reports changes of state and losses of readings as notices.
    pub report_status: bool,
    /// Delays the session when the snapshot channel is full, instead of dropping snapshots.
    pub lossless_snapshots: bool,
    /// Receives notices on a thread of its own. Notices are dropped when 64 wait.
    pub on_notice: Option<NoticeReceiver>,
}

/// The control socket of a session.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum ControlSocket {
    /// No socket.
    #[default]
    Off,
    /// A socket at [`default_path`](super::control_socket::default_path), if there is one.
    Default,
    /// A socket at this path.
    Path(PathBuf),
}

impl ControlSocket {
    /// Returns the path of the socket, if there is one.
    pub(super) fn path(&self) -> Option<PathBuf> {
        match self {
            Self::Off => None,
            Self::Default => default_path(),
            Self::Path(path) => Some(path.clone()),
        }
    }
}

/// The program that runs [`run_watchdog`](crate::output::run_watchdog) in a second process.
#[derive(Clone, Debug)]
pub struct WatchdogProgram {
    /// Path of the program.
    pub program: PathBuf,
    /// Arguments that select the watchdog.
    pub arguments: Vec<OsString>,
    /// Command that the session executes when the watchdog exits unexpectedly or does not respond.
    pub on_lost: Command,
}
