//! A socket on which other programs of the same user ask a run for things: a line of JSON in, a line of
//! JSON out.
//!
//! | `ask` | with | what it does |
//! |---|---|---|
//! | `state` | | says how the run is: state, layout, the account of all readings |
//! | `pause`, `resume` | | lets go of everything and lets nothing out; ends that |
//! | `reload` | | reads the layout file at once |
//! | `profile` | `name` | puts another layout of the setup in force |
//! | `next-profile` | | the one after it |
//! | `recentre` | | brings the boards below the index fingertip of the hand seen last |
//! | `nudge` | `x_mm`, `y_mm`, `z_mm`: −1000..=1000 | moves the boards |
//! | `tilt` | `deg`: −90..=90 | turns the boards |
//! | `scale` | `factor`: 0.5..=2 | makes the boards larger or smaller |
//! | `save` | | writes where the boards are into the layout file |
//! | `subscribe` | | tells from now on what happens, events included |
//! | `stop` | | ends the run |
//!
//! The answer is `{"ok":true}` with what belongs to it, or `{"ok":false,"error":"…"}`. A line that makes no
//! sense is answered so too, and the conversation goes on. News are lines with an `event`: those of the
//! stage `events` of [`trace`](crate::trace), and `state`, `reload` and `missed`.
//!
//! Nothing here holds up a run: it hands over what it has if there is room, and is asked through
//! [`Calls`](crate::runtime::Calls). A client that does not read loses the oldest of 64 lines of news, and
//! is cut off when it takes nothing for 1 s.

mod response;
mod client;
mod connection;
mod notification;
pub mod request;
mod server;

use std::path::{Path, PathBuf};

use crate::output::socket::{self, SocketError};

pub use client::Client;
pub use notification::Notifier;
pub use server::{ControlServer, ServerContext};

/// A layout of the setup.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProfileInfo {
    /// What it is called.
    pub name: String,
    /// The file that it is in, or the name of a shipped one.
    pub file: String,
}

/// Why there is no control socket, or nobody at it. Each text says what to do.
#[derive(Debug, thiserror::Error)]
pub enum ControlError {
    /// The path is longer than that of a socket can be.
    #[error(
        "cannot listen at {}: the path has {length} bytes, that of a socket {most} at most; name a shorter one with --control", path.display()
    )]
    PathTooLong {
        /// The path.
        path: PathBuf,
        /// Its length, in bytes.
        length: usize,
        /// The longest that there can be.
        most: usize,
    },
    /// A run that is alive listens there.
    #[error(
        "another run listens at {}: end it with `ademan ctl stop`, or give this one a socket of its own with --control PATH, or none with --control off", path.display()
    )]
    InUse {
        /// The path.
        path: PathBuf,
    },
    /// The socket cannot be made.
    #[error("cannot listen at {}: {reason}; name another path with --control, or do without: --control off", path.display())]
    Bind {
        /// The path.
        path: PathBuf,
        /// What happened.
        reason: String,
    },
    /// Nobody listens there.
    #[error("cannot reach a run at {}: {reason}; start `ademan run`, or name its socket with --socket", path.display())]
    Connect {
        /// The path.
        path: PathBuf,
        /// What happened.
        reason: String,
    },
    /// A run was there and is not any more, or does not answer.
    #[error("the run at {} gave no answer: {reason}", path.display())]
    NoResponse {
        /// The path.
        path: PathBuf,
        /// What happened.
        reason: String,
    },
}

impl ControlError {
    fn open(path: &Path, error: SocketError) -> Self {
        let path = path.into();
        match error {
            SocketError::PathTooLong { length, max } => Self::PathTooLong {
                path,
                length,
                most: max,
            },
            SocketError::InUse => Self::InUse { path },
            SocketError::Other(reason) => Self::Bind { path, reason },
        }
    }
}

/// Where the socket is unless somebody says so: `ademan/control.sock` in `$XDG_RUNTIME_DIR`; `None` where
/// that is not a folder.
pub fn default_path() -> Option<PathBuf> {
    socket::default_path("control.sock")
}

/// Whether a socket can have this path: it is not too long, and the system has such sockets.
pub fn check_path(path: &Path) -> Result<(), ControlError> {
    socket::check_path(path).map_err(|error| ControlError::open(path, error))
}
