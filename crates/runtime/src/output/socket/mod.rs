//! Unix sockets that only their owner can connect to, from the moment they exist: the sockets of the output `spacenav` and the
//! control socket, which is a named pipe on Windows.

#[cfg(target_os = "linux")]
mod linux;
#[cfg(target_os = "linux")]
pub(crate) use linux::{
    Listener, SocketError, Stream, check_path, connect, connect_to_any, default_path,
};

#[cfg(windows)]
mod windows;
#[cfg(windows)]
pub(crate) use self::windows::{Listener, SocketError, Stream, check_path, connect, default_path};

#[cfg(not(any(target_os = "linux", windows)))]
mod unsupported;
#[cfg(not(any(target_os = "linux", windows)))]
pub(crate) use unsupported::{Listener, SocketError, Stream, check_path, connect, default_path};
