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

/// An error of the control socket.
#[derive(Debug, thiserror::Error)]
pub enum ControlError {
    /// The path is longer than a socket path may be.
    #[error(
        "cannot listen at {}: the path has {length} bytes, a socket path at most {most}; name a shorter one with \
         --control PATH", path.display()
    )]
    PathTooLong {
        /// Path of the socket.
        path: PathBuf,
        /// Length of the path in bytes.
        length: usize,
        /// Largest length in bytes.
        most: usize,
    },
    /// Another session listens at the path.
    #[error(
        "another session listens at {}; end it with `ademan ctl stop`, or start this one with --control PATH or \
         --control off", path.display()
    )]
    InUse {
        /// Path of the socket.
        path: PathBuf,
    },
    /// The socket cannot be created.
    #[error(
        "cannot listen at {}: {reason}; name another path with --control PATH, or use --control off", path.display()
    )]
    Bind {
        /// Path of the socket.
        path: PathBuf,
        /// Error.
        reason: String,
    },
    /// The client cannot connect.
    #[error(
        "cannot connect to {}: {reason}; start `ademan run`, or name its socket with --socket PATH", path.display()
    )]
    Connect {
        /// Path of the socket.
        path: PathBuf,
        /// Error.
        reason: String,
    },
    /// The session closed the connection, or did not answer in time.
    #[error("no answer from the session at {}: {reason}", path.display())]
    NoResponse {
        /// Path of the socket.
        path: PathBuf,
        /// Error.
        reason: String,
    },
}

impl ControlError {
    fn bind(path: &Path, error: SocketError) -> Self {
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

/// Returns the default path, `ademan/control.sock` in `$XDG_RUNTIME_DIR`; `None` if that is not a directory.
pub fn default_path() -> Option<PathBuf> {
    socket::default_path("control.sock")
}

/// Checks that a socket may have this path: the system has such sockets, and the path is short enough.
pub fn check_path(path: &Path) -> Result<(), ControlError> {
    socket::check_path(path).map_err(|error| ControlError::bind(path, error))
}
