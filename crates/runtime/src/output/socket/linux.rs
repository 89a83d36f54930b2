//! Unix sockets of Linux.

use std::ffi::OsStr;
use std::fmt;
use std::fs::{self, File, Metadata, TryLockError};
use std::io;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::os::unix::fs::{FileTypeExt, MetadataExt};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, poll};
use rustix::fs::{Mode, fchmod};
use rustix::io::{Errno, retry_on_intr};
use rustix::net::sockopt::{
    Timeout, set_socket_send_buffer_size, set_socket_timeout, socket_peercred,
};
use rustix::net::{
    AddressFamily, SocketAddrUnix, SocketFlags, SocketType, bind, listen, socket_with,
};
use rustix::process::geteuid;

use super::SocketError;
use crate::files;
use ademan_core::message::escape_path;

/// A connection to a client.
pub(crate) type Stream = UnixStream;

/// Maximum length of the path of a Unix socket on Linux, in bytes: `sun_path` without its NUL (unix(7)).
const MAX_PATH: usize = 107;

/// Maximum number of clients that wait to be accepted.
const BACKLOG: i32 = 16;

/// Send buffer per client, in bytes; the kernel rounds up to at least 4.5 KiB. With the default of a few hundred KiB a
/// client that hangs would be detected minutes later.
const SEND_BUFFER: usize = 8192;

/// Longest time in which a server accepts a connection.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(1);

/// Permissions of the group and of all others.
const OTHERS: u32 = 0o077;

/// Attempts to lock a file that other processes remove at the same time.
const MAX_LOCK_ATTEMPTS: u32 = 100;

impl SocketError {
    fn other(reason: impl fmt::Display) -> Self {
        Self::Other(reason.to_string())
    }
}

impl From<io::Error> for SocketError {
    fn from(error: io::Error) -> Self {
        Self::other(error)
    }
}

/// Returns the default path of the socket of this name, in the folder `ademan` of the user's runtime folder. `None` if
/// there is no runtime folder.
pub(crate) fn default_path(name: &str) -> Option<PathBuf> {
    let runtime = PathBuf::from(std::env::var_os("XDG_RUNTIME_DIR")?);
    let exists = runtime.is_absolute() && runtime.is_dir();
    exists.then(|| runtime.join("ademan").join(name))
}

/// A listening socket. Its file stays when this is dropped, see [`remove`](Self::remove).
pub(crate) struct Listener {
    socket: UnixListener,
    path: PathBuf,
    /// Device and inode of the socket file.
    inode: (u64, u64),
    /// Locked while the socket exists.
    lock: SocketLock,
}

impl Listener {
    /// Listens at `path`. Creates the folder `ademan` of a default path, accessible by its owner only. Replaces a socket
    /// left behind by a dead process.
    pub fn open(path: &Path) -> Result<Self, SocketError> {
        check_path(path)?;
        let name = path.file_name().and_then(OsStr::to_str);
        if name
            .and_then(default_path)
            .is_some_and(|default| default == path)
        {
            let folder = path.parent().unwrap_or(Path::new("."));
            files::create_private_folder(folder).map_err(SocketError::other)?;
        }
        let lock = SocketLock::acquire(path)?;
        remove_stale(path)?;
        let socket = bind_private(path).map_err(io::Error::from)?;
        let metadata = fs::symlink_metadata(path)?;
        let listener = Self {
            socket,
            path: path.into(),
            inode: (metadata.dev(), metadata.ino()),
            lock,
        };
        match metadata.mode() & 0o077 {
            0 => Ok(listener),
            _ => Err(SocketError::other(
                "other users could connect, as the file system does not support file modes",
            )),
        }
    }

    /// Returns the path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Makes [`accept`](Self::accept) return `WouldBlock` instead of blocking.
    pub fn set_nonblocking(&self) -> io::Result<()> {
        self.socket.set_nonblocking(true)
    }

    /// Waits for the next client. [`accept`](Self::accept) takes a file descriptor before it waits, and fails without one although there
    /// is no client.
    pub fn wait_for_client(&self) -> io::Result<()> {
        let mut descriptors = [PollFd::new(&self.socket, PollFlags::IN)];
        retry_on_intr(|| poll(&mut descriptors, None))?;
        Ok(())
    }

    /// Accepts the next client. Fails if the client belongs to another user.
    pub fn accept(&self) -> io::Result<Stream> {
        let (stream, _) = self.socket.accept()?;
        if socket_peercred(&stream)?.uid != geteuid() {
            return Err(io::Error::new(
                io::ErrorKind::PermissionDenied,
                "rejected a client of another user",
            ));
        }
        set_socket_send_buffer_size(&stream, SEND_BUFFER)?;
        Ok(stream)
    }

    /// Returns another file descriptor of the lock. Dropping it makes a descriptor free.
    pub fn spare_descriptor(&self) -> io::Result<File> {
        self.lock.file.try_clone()
    }

    /// Removes the socket file and wakes a thread that blocks in [`accept`](Self::accept). Clients stay connected.
    pub fn close(&self) {
        // Only a client can end an `accept`.
        let _ = connect_to_any(&self.path);
        self.remove();
    }

    /// Removes the socket file, and then its lock, unless another process has replaced it.
    pub fn remove(&self) {
        if inode_at(&self.path) == Some(self.inode) {
            let _ = fs::remove_file(&self.path);
        }
        self.lock.remove();
    }
}

impl AsFd for Listener {
    fn as_fd(&self) -> BorrowedFd<'_> {
        self.socket.as_fd()
    }
}

/// Checks the length of the path of a socket.
pub(crate) fn check_path(path: &Path) -> Result<(), SocketError> {
    let length = path.as_os_str().len();
    if length <= MAX_PATH {
        Ok(())
    } else {
        Err(SocketError::PathTooLong {
            length,
            max: MAX_PATH,
        })
    }
}

/// Connects as a client. Fails if the server belongs to another user, who could read the requests and forge the replies.
pub(crate) fn connect(path: &Path) -> io::Result<Stream> {
    let stream = connect_to_any(path)?;
    if socket_peercred(&stream)?.uid == geteuid() {
        Ok(stream)
    } else {
        Err(io::Error::new(
            io::ErrorKind::PermissionDenied,
            "the program that listens there belongs to another user",
        ))
    }
}

/// Connects to a server of any user, within [`CONNECT_TIMEOUT`].
pub(crate) fn connect_to_any(path: &Path) -> io::Result<UnixStream> {
    let socket = stream_socket()?;
    let address = SocketAddrUnix::new(path)?;
    // The kernel applies the time-out of writes to a full backlog (`unix_stream_connect` in net/unix/af_unix.c).
    set_socket_timeout(&socket, Timeout::Send, Some(CONNECT_TIMEOUT))?;
    match retry_on_intr(|| rustix::net::connect(&socket, &address)) {
        Err(Errno::AGAIN) => Err(io::Error::new(
            io::ErrorKind::TimedOut,
            "the program that listens there accepts no connection",
        )),
        connected => {
            connected?;
            set_socket_timeout(&socket, Timeout::Send, None)?;
            Ok(UnixStream::from(socket))
        }
    }
}

fn stream_socket() -> rustix::io::Result<OwnedFd> {
    let flags = SocketFlags::CLOEXEC;
    socket_with(AddressFamily::UNIX, SocketType::STREAM, flags, None)
}

/// A locked file beside a socket. Its owner owns the socket; the kernel drops the lock when the process exits.
///
/// The file is removed with the lock. Another process may have opened it before and locks it then, so a lock counts only if
/// its file still has the name.
struct SocketLock {
    file: File,
    path: PathBuf,
}

impl SocketLock {
    /// Locks the file beside the socket at `socket`.
    fn acquire(socket: &Path) -> Result<Self, SocketError> {
        let path = socket.with_added_extension("lock");
        for _ in 0..MAX_LOCK_ATTEMPTS {
            // The setup of another person may name `Cargo`: `Cargo.lock` must not be removed, nor become private. A lock is empty
            // and private; whatever is no file is refused when it is opened.
            let is_other = |found: Metadata| {
                found.is_file() && (found.len() > 0 || found.mode() & OTHERS != 0)
            };
            if fs::symlink_metadata(&path).is_ok_and(is_other) {
                return Err(SocketError::Other(format!(
                    "{} is not the lock of a socket",
                    escape_path(&path)
                )));
            }
            let file = files::open_private(&path).map_err(|error| {
                SocketError::Other(format!("cannot open {}: {error}", escape_path(&path)))
            })?;
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Err(SocketError::InUse),
                Err(TryLockError::Error(error)) => return Err(error.into()),
            }
            let lock = Self {
                file,
                path: path.clone(),
            };
            if lock.has_name() {
                return Ok(lock);
            }
        }
        Err(SocketError::InUse)
    }

    /// Returns `true` if the locked file is the one at the path.
    fn has_name(&self) -> bool {
        let own = self.file.metadata().ok();
        let own = own.map(|own| (own.dev(), own.ino()));
        own.is_some() && own == inode_at(&self.path)
    }

    /// Removes the file while it is locked.
    fn remove(&self) {
        if self.has_name() {
            let _ = fs::remove_file(&self.path);
        }
    }
}

impl Drop for SocketLock {
    fn drop(&mut self) {
        self.remove();
    }
}

/// Returns the device and the inode of the file at a path.
fn inode_at(path: &Path) -> Option<(u64, u64)> {
    let found = fs::symlink_metadata(path).ok()?;
    Some((found.dev(), found.ino()))
}

/// Removes a socket left behind by a dead process. The caller must have the lock.
fn remove_stale(path: &Path) -> Result<(), SocketError> {
    match fs::symlink_metadata(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        Err(error) => Err(error.into()),
        Ok(metadata) if !metadata.file_type().is_socket() => {
            Err(SocketError::other("the file there is not a socket"))
        }
        Ok(_) => remove_if_refused(path, connect_to_any(path).map(drop)),
    }
}

/// Removes a socket to which connections are refused, unless it has gone. Fails if a program may listen there.
fn remove_if_refused(path: &Path, connected: io::Result<()>) -> Result<(), SocketError> {
    let error = match connected {
        // A server without the lock listens there.
        Ok(()) => return Err(SocketError::InUse),
        Err(error) => error,
    };
    let removed = match error.kind() {
        io::ErrorKind::TimedOut => return Err(SocketError::InUse),
        io::ErrorKind::ConnectionRefused => fs::remove_file(path),
        io::ErrorKind::NotFound => Ok(()),
        // A server may listen there, and only this process cannot connect.
        _ => {
            return Err(SocketError::Other(format!(
                "cannot tell whether a program listens there: {error}"
            )));
        }
    };
    match removed {
        Err(failure) if failure.kind() != io::ErrorKind::NotFound => Err(failure.into()),
        _ => Ok(()),
    }
}

/// Binds a socket with mode 0600. Linux gives the file the mode of the socket, less the umask (`unix_bind_bsd` in
/// net/unix/af_unix.c), so the mode is never wider, and the umask of the process is unchanged.
fn bind_private(path: &Path) -> rustix::io::Result<UnixListener> {
    let socket = stream_socket()?;
    fchmod(&socket, Mode::RUSR | Mode::WUSR)?;
    bind(&socket, &SocketAddrUnix::new(path)?)?;
    listen(&socket, BACKLOG)?;
    Ok(UnixListener::from(socket))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::PermissionsExt;
    use std::os::unix::net::UnixDatagram;

    #[test]
    fn a_socket_is_accessible_by_its_owner_only_and_removed_when_it_is_closed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("c.sock");
        let listener = Listener::open(&path).unwrap();
        let mode = fs::symlink_metadata(&path).unwrap().mode();
        assert_eq!(mode & 0o777, 0o600);
        listener.close();
        assert!(!path.exists());
    }

    #[test]
    fn a_socket_that_is_closed_or_refused_leaves_no_file_behind() {
        let folder = tempfile::tempdir().unwrap();
        let files = || fs::read_dir(folder.path()).unwrap().count();
        let listener = Listener::open(&folder.path().join("c.sock")).unwrap();
        assert_eq!(files(), 2, "the socket and its lock");
        listener.close();
        assert_eq!(files(), 0);
        let next = Listener::open(&folder.path().join("c.sock")).unwrap();
        listener.remove();
        drop(listener);
        assert_eq!(files(), 2, "they belong to the next process");
        next.close();

        let notes = folder.path().join("notes");
        fs::write(&notes, "mine").unwrap();
        assert!(Listener::open(&notes).is_err());
        assert_eq!(files(), 1, "only the notes");
    }

    #[test]
    fn a_lock_whose_file_was_removed_does_not_count() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("c.sock");
        let first = SocketLock::acquire(&path).unwrap();
        assert!(matches!(
            SocketLock::acquire(&path),
            Err(SocketError::InUse)
        ));
        fs::remove_file(&first.path).unwrap();
        assert!(!first.has_name());
        let second = SocketLock::acquire(&path).unwrap();
        drop(first);
        assert!(second.has_name(), "it is the lock of another process");
    }

    #[test]
    fn a_socket_in_use_is_an_error_and_that_of_a_dead_process_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("c.sock");
        let first = Listener::open(&path).unwrap();
        let second = Listener::open(&path);
        assert!(matches!(second, Err(SocketError::InUse)));
        // A process that another test starts listens, too, until it has executed its program.
        rustix::net::shutdown(&first.socket, rustix::net::Shutdown::Both).unwrap();
        drop(first);
        assert!(path.exists(), "as after a crash");
        let next = Listener::open(&path).unwrap();
        assert!(connect(next.path()).is_ok());
    }

    #[test]
    fn neither_a_server_without_a_lock_nor_a_regular_file_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("c.sock");
        let _other = UnixListener::bind(&path).unwrap();
        let opened = Listener::open(&path);
        assert!(matches!(opened, Err(SocketError::InUse)));

        let datagrams = folder.path().join("d.sock");
        let _receiver = UnixDatagram::bind(&datagrams).unwrap();
        assert!(Listener::open(&datagrams).is_err());
        assert!(
            datagrams.exists(),
            "it may be in use although no connection is possible"
        );

        let notes = folder.path().join("notes");
        fs::write(&notes, "mine").unwrap();
        let error = Listener::open(&notes).err().unwrap().to_string();
        assert!(error.contains("not a socket"), "{error}");
        assert_eq!(fs::read_to_string(&notes).unwrap(), "mine");
    }

    #[test]
    fn a_file_beside_a_socket_with_content_or_for_others_is_no_lock_and_stays() {
        for (content, mode) in [("mine", 0o600), ("mine", 0o644), ("", 0o644)] {
            let folder = tempfile::tempdir().unwrap();
            let file = folder.path().join("Cargo.lock");
            fs::write(&file, content).unwrap();
            fs::set_permissions(&file, fs::Permissions::from_mode(mode)).unwrap();
            let error = Listener::open(&folder.path().join("Cargo")).err().unwrap();
            assert!(error.to_string().contains("is not the lock"), "{error}");
            assert_eq!(fs::read_to_string(&file).unwrap(), content);
            assert_eq!(fs::metadata(&file).unwrap().mode() & 0o777, mode);
            assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        }
    }

    #[test]
    fn a_socket_that_vanishes_while_it_is_checked_needs_no_removal() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("c.sock");
        let gone = connect_to_any(&path).map(drop);
        assert!(remove_if_refused(&path, gone).is_ok());
        let refused = || Err(io::ErrorKind::ConnectionRefused.into());
        assert!(remove_if_refused(&path, refused()).is_ok());

        let _server = UnixListener::bind(&path).unwrap();
        for kind in [
            io::ErrorKind::PermissionDenied,
            io::ErrorKind::TimedOut,
            io::ErrorKind::Other,
        ] {
            assert!(remove_if_refused(&path, Err(kind.into())).is_err());
        }
        assert!(remove_if_refused(&path, Ok(())).is_err());
        assert!(path.exists(), "it may be in use");
        assert!(remove_if_refused(&path, refused()).is_ok());
        assert!(!path.exists());
    }

    #[test]
    fn a_path_that_is_too_long_is_an_error() {
        let path = PathBuf::from(format!("/tmp/{}", "x".repeat(103)));
        let error = Listener::open(&path).err().unwrap().to_string();
        assert!(error.contains("108 bytes"), "{error}");
        assert!(error.contains("at most 107"), "{error}");
    }
}
