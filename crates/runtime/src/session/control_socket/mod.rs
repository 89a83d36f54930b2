//! The control socket: commands from other programs of the same user, as lines of JSON.
//!
//! A request is a [`Command`](ademan_core::command::Command), such as `{"command":"tilt","deg":5}`, or `{"command":"subscribe"}`.
//! The response is `{"ok":true}` with the fields of a state or a `text`, or `{"ok":false,"error":"…"}`. An invalid line
//! gets an error response and the connection stays open. After a subscription the client receives notifications: lines
//! with an `event`, which have the form of the stage `events` of a [`trace`](crate::trace), `press` with the fields of the stage
//! `presses`, and `state`, `reload` and `missed`; and lines with a `command`, in the form of the stage `commands`. After `{"command":"watch"}` it receives
//! [views](crate::session::view), for displays.
//!
//! A client cannot delay the session. Commands go through [`CommandSender`](crate::session::CommandSender).
//! A client that does not read loses the oldest of 64 notifications, and is disconnected when a write takes 1 s. At most 16
//! clients are connected: another one takes the place of the client that has been idle for the longest time.

pub mod request;
mod response;
mod notification;
mod context;
mod line_writer;
mod clients;
#[cfg(all(test, target_os = "linux"))]
mod clients_tests;
mod connection;
mod server;
mod client;
mod watch_client;

use std::path::{Path, PathBuf};

use crate::output::socket::{self, SocketError};
use crate::setup::LoadedSetup;
use ademan_core::layout::Layout;
use ademan_core::message::{escape_line, escape_path};

pub use client::Client;
pub use context::ServerContext;
pub use notification::Notifier;
pub use server::ControlServer;
pub use watch_client::WatchClient;

/// A profile of the setup and its layout.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProfileInfo {
    /// Name of the profile.
    pub name: String,
    /// Path of the layout file, or the name of a shipped layout.
    pub file: String,
}

impl ProfileInfo {
    /// Returns the profiles of a setup, in order.
    pub(super) fn all(setup: &LoadedSetup) -> Vec<Self> {
        let layouts = setup.profile_names().zip(setup.layouts());
        let profile = |(name, layout): (&str, &Layout)| Self {
            name: name.to_owned(),
            file: layout.file.clone(),
        };
        layouts.map(profile).collect()
    }
}

/// An error of the control socket.
#[derive(Debug, thiserror::Error)]
pub enum ControlError {
    /// The path is longer than a socket path may be.
    #[error(
        "cannot listen on {}: the path has {length} bytes, a socket path at most {most}; name a shorter one with \
         --control PATH",
        escape_path(path)
    )]
    PathTooLong {
        /// Path of the socket.
        path: PathBuf,
        /// Length of the path in bytes.
        length: usize,
        /// Largest length in bytes.
        most: usize,
    },
    /// Another session listens on the path.
    #[error(
        "another session listens on {}; end it with `ademan ctl stop`, or start this one with --control PATH or \
         --control off",
        escape_path(path)
    )]
    InUse {
        /// Path of the socket.
        path: PathBuf,
    },
    /// The socket cannot be created.
    #[error(
        "cannot listen on {}: {}; name another path with --control PATH, or use --control off",
        escape_path(path),
        escape_line(reason)
    )]
    Bind {
        /// Path of the socket.
        path: PathBuf,
        /// Error.
        reason: String,
    },
    /// The client cannot connect.
    #[error(
        "cannot connect to {}: {}; start `ademan run`, or name its socket with --socket PATH",
        escape_path(path),
        escape_line(reason)
    )]
    Connect {
        /// Path of the socket.
        path: PathBuf,
        /// Error.
        reason: String,
    },
    /// The session has refused the request, with this reason.
    #[error("{}", escape_line(.0))]
    Refused(String),
    /// The session closed the connection, or did not answer in time.
    #[error(
        "no answer from the session at {}: {}",
        escape_path(path),
        escape_line(reason)
    )]
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
