//! A Unix socket that only its owner can use, from the first instant that it exists: for programs that
//! follow a hand, and for those that steer a run.

use std::ffi::OsStr;
use std::fmt;
use std::fs::{self, DirBuilder, File, OpenOptions, TryLockError};
use std::io;
use std::os::fd::{AsFd, BorrowedFd};
use std::os::unix::fs::{DirBuilderExt, FileTypeExt, MetadataExt, OpenOptionsExt};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};

use rustix::fs::{Mode, OFlags, fchmod};
use rustix::net::sockopt::{set_socket_send_buffer_size, socket_peercred};
use rustix::net::{
    AddressFamily, SocketAddrUnix, SocketFlags, SocketType, bind, listen, socket_with,
};
use rustix::process::geteuid;

/// A conversation with one client.
pub(crate) type Stream = UnixStream;

/// The longest path that a Unix socket can have on Linux, in bytes: `sun_path` less its end (unix(7)).
const LONGEST_PATH: usize = 107;

/// Clients that wait to be accepted.
const BACKLOG: i32 = 16;

/// What the system keeps for a client that does not read, in bytes; the system takes at least 4.5 KiB.
/// With its own, a few hundred KiB, a client that hangs would be noticed minutes too late.
const SEND_BUFFER: usize = 8192;

/// Why a socket cannot be had. The texts say what happened; what to do depends on what it is for.
#[derive(Debug, thiserror::Error)]
pub(crate) enum SocketError {
    /// The path is longer than that of a socket can be; both lengths are in bytes.
    #[error("the path has {length} bytes, that of a socket {most} at most")]
    PathTooLong { length: usize, most: usize },
    /// A program that is alive listens there.
    #[error("another program listens there")]
    InUse,
    /// It cannot be made.
    #[error("{0}")]
    Other(String),
}

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

/// Where a socket of this name is unless somebody says so: in the folder `ademan` of the user's runtime
/// directory; `None` where there is no such directory.
pub(crate) fn default_path(name: &str) -> Option<PathBuf> {
    let runtime = PathBuf::from(std::env::var_os("XDG_RUNTIME_DIR")?);
    let is_there = runtime.is_absolute() && runtime.is_dir();
    is_there.then(|| runtime.join("ademan").join(name))
}

/// A socket that is listened to, and taken away when it is dropped.
pub(crate) struct Listener {
    socket: UnixListener,
    path: PathBuf,
    /// Which file it is.
    inode: (u64, u64),
    /// Held as long as the socket is ours. Its file stays: to take it away would be a race with who opens it.
    _lock: File,
}

impl Listener {
    /// Listens at `path`. A folder `ademan` for it is made, for its owner alone, if it is not there. A socket
    /// that a dead owner has left behind is taken over.
    pub fn open(path: &Path) -> Result<Self, SocketError> {
        check_path(path)?;
        let name = path.file_name().and_then(OsStr::to_str);
        if name
            .and_then(default_path)
            .is_some_and(|default| default == path)
        {
            make_private_folder(path)?;
        }
        let lock = lock(path)?;
        remove_stale(path)?;
        let socket = bind_private(path).map_err(io::Error::from)?;
        let metadata = fs::symlink_metadata(path)?;
        let listener = Self {
            socket,
            path: path.into(),
            inode: (metadata.dev(), metadata.ino()),
            _lock: lock,
        };
        match metadata.mode() & 0o077 {
            0 => Ok(listener),
            _ => Err(SocketError::other(
                "others could use it, as the file system keeps no modes",
            )),
        }
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// From now on [`accept`](Self::accept) does not wait; `WouldBlock` where nobody is there.
    pub fn set_nonblocking(&self) -> io::Result<()> {
        self.socket.set_nonblocking(true)
    }

    /// The next client, as soon as there is one.
    pub fn accept(&self) -> io::Result<Stream> {
        let (stream, _) = self.socket.accept()?;
        if socket_peercred(&stream)?.uid != geteuid() {
            return Err(io::Error::new(
                io::ErrorKind::PermissionDenied,
                "another user is not listened to",
            ));
        }
        set_socket_send_buffer_size(&stream, SEND_BUFFER)?;
        Ok(stream)
    }
}

impl Listener {
    /// Takes the socket away; who accepts is woken up. Those who are connected stay so.
    pub fn close(&self) {
        // Nobody can end an `accept` but a client.
        let _ = UnixStream::connect(&self.path);
        self.remove();
    }

    /// Takes the socket away, for whoever does not wait in [`accept`](Self::accept).
    pub fn remove(&self) {
        let is_ours = fs::symlink_metadata(&self.path)
            .is_ok_and(|found| (found.dev(), found.ino()) == self.inode);
        if is_ours {
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// Whether a socket can have this path.
pub(crate) fn check_path(path: &Path) -> Result<(), SocketError> {
    let length = path.as_os_str().len();
    match length > LONGEST_PATH {
        false => Ok(()),
        true => Err(SocketError::PathTooLong {
            length,
            most: LONGEST_PATH,
        }),
    }
}

impl AsFd for Listener {
    fn as_fd(&self) -> BorrowedFd<'_> {
        self.socket.as_fd()
    }
}

/// Connects as a client.
pub(crate) fn connect(path: &Path) -> io::Result<Stream> {
    UnixStream::connect(path)
}

fn make_private_folder(path: &Path) -> Result<(), SocketError> {
    let folder = path.parent().unwrap_or(Path::new("."));
    match DirBuilder::new().mode(0o700).create(folder) {
        Err(error) if error.kind() != io::ErrorKind::AlreadyExists => {
            return Err(SocketError::Other(format!(
                "cannot make {}: {error}",
                folder.display()
            )));
        }
        _ => {}
    }
    let metadata = fs::symlink_metadata(folder)?;
    let is_private =
        metadata.is_dir() && metadata.uid() == geteuid().as_raw() && metadata.mode() & 0o077 == 0;
    match is_private {
        true => Ok(()),
        false => Err(SocketError::Other(format!(
            "others may enter {0}; make it yours alone: chmod 700 {0}",
            folder.display()
        ))),
    }
}

/// Whoever has the lock beside a socket owns the socket. It ends with its owner, however that ends.
fn lock(path: &Path) -> Result<File, SocketError> {
    let mut beside = path.as_os_str().to_owned();
    beside.push(".lock");
    let lock = OpenOptions::new()
        .write(true)
        .create(true)
        .truncate(false)
        .mode(0o600)
        .custom_flags(OFlags::NOFOLLOW.bits() as i32)
        .open(&beside)
        .map_err(|error| {
            SocketError::Other(format!("cannot open {}: {error}", beside.display()))
        })?;
    match lock.try_lock() {
        Ok(()) => Ok(lock),
        Err(TryLockError::WouldBlock) => Err(SocketError::InUse),
        Err(TryLockError::Error(error)) => Err(error.into()),
    }
}

/// Takes away what a dead owner has left behind; only for who has the lock.
fn remove_stale(path: &Path) -> Result<(), SocketError> {
    match fs::symlink_metadata(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        Err(error) => Err(error.into()),
        Ok(metadata) if !metadata.file_type().is_socket() => Err(SocketError::other(
            "something else than a socket is there; name another path",
        )),
        // Somebody who knows nothing of the lock.
        Ok(_) if UnixStream::connect(path).is_ok() => Err(SocketError::InUse),
        Ok(_) => Ok(fs::remove_file(path)?),
    }
}

/// Linux gives the file of a socket the mode that the socket has before, less the umask (`unix_bind_bsd`
/// in net/unix/af_unix.c): there is no instant at which it is wider, and no umask of the process to change.
fn bind_private(path: &Path) -> rustix::io::Result<UnixListener> {
    let socket = socket_with(
        AddressFamily::UNIX,
        SocketType::STREAM,
        SocketFlags::CLOEXEC,
        None,
    )?;
    fchmod(&socket, Mode::RUSR | Mode::WUSR)?;
    bind(&socket, &SocketAddrUnix::new(path)?)?;
    listen(&socket, BACKLOG)?;
    Ok(UnixListener::from(socket))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_socket_is_its_owners_alone_and_gone_when_it_is_closed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("c.sock");
        let listener = Listener::open(&path).unwrap();
        let mode = fs::symlink_metadata(&path).unwrap().mode();
        assert_eq!(mode & 0o777, 0o600);
        listener.close();
        assert!(!path.exists());
    }

    #[test]
    fn a_second_owner_is_refused_and_a_dead_ones_socket_taken_over() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("c.sock");
        let first = Listener::open(&path).unwrap();
        let second = Listener::open(&path);
        assert!(matches!(second, Err(SocketError::InUse)));
        drop(first);
        assert!(path.exists(), "as after a crash");
        let next = Listener::open(&path).unwrap();
        assert!(connect(next.path()).is_ok());
    }

    #[test]
    fn who_listens_without_the_lock_is_not_taken_over_nor_is_what_is_no_socket() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("c.sock");
        let _other = UnixListener::bind(&path).unwrap();
        let opened = Listener::open(&path);
        assert!(matches!(opened, Err(SocketError::InUse)));

        let path = folder.path().join("notes");
        fs::write(&path, "mine").unwrap();
        let error = Listener::open(&path).err().unwrap().to_string();
        assert!(error.contains("something else than a socket"), "{error}");
        assert_eq!(fs::read_to_string(&path).unwrap(), "mine");
    }

    #[test]
    fn a_path_that_no_socket_can_have_is_refused_with_the_reason() {
        let path = PathBuf::from(format!("/tmp/{}", "x".repeat(103)));
        let error = Listener::open(&path).err().unwrap().to_string();
        assert!(error.contains("108 bytes"), "{error}");
        assert!(error.contains("107 at most"), "{error}");
    }
}
