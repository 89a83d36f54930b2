//! Unix sockets that only their owner can connect to, from the moment they exist: those of the output `spacenav` and of
//! the control socket.

#[cfg(target_os = "linux")]
mod linux;
#[cfg(target_os = "linux")]
pub(crate) use linux::{Listener, SocketError, Stream, check_path, connect, default_path};

#[cfg(not(target_os = "linux"))]
mod unsupported;
#[cfg(not(target_os = "linux"))]
pub(crate) use unsupported::{Listener, SocketError, Stream, check_path, connect, default_path};
