//! Unix sockets that only their owner can connect to, from the moment they exist: the sockets of the output `spacenav` and the
//! control socket, which is a named pipe on Windows.

#[cfg(target_os = "linux")]
mod linux;
#[cfg(target_os = "linux")]
pub(crate) use linux::{Listener, Stream, check_path, connect, connect_to_any, default_path};

#[cfg(windows)]
mod windows;
#[cfg(windows)]
pub(crate) use self::windows::{Listener, Stream, check_path, connect, default_path};

#[cfg(not(any(target_os = "linux", windows)))]
mod unsupported;
#[cfg(not(any(target_os = "linux", windows)))]
pub(crate) use unsupported::{Listener, Stream, check_path, connect, default_path};

/// A failure to create a socket. The messages contain the cause; the remedy depends on the purpose of the socket.
#[derive(Debug, thiserror::Error)]
#[cfg_attr(
    not(any(target_os = "linux", windows)),
    expect(
        dead_code,
        reason = "a socket that cannot exist is neither in use nor too long"
    )
)]
pub(crate) enum SocketError {
    /// The path is too long; both lengths are in bytes, for a Windows pipe in characters.
    #[error("the path has {length} bytes, and a socket path at most {max}")]
    PathTooLong { length: usize, max: usize },
    /// A running program listens there.
    #[error("another program listens there")]
    InUse,
    /// Any other cause.
    #[error("{0}")]
    Other(String),
}
