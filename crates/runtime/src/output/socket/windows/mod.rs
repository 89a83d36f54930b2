//! Named pipes of Windows in place of Unix sockets. Only the owner of a pipe has access to it.

mod stream;

use std::fs::{File, OpenOptions};
use std::io;
use std::os::windows::fs::OpenOptionsExt;
use std::os::windows::io::OwnedHandle;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use interprocess::os::windows::named_pipe::pipe_mode::Bytes;
use interprocess::os::windows::named_pipe::{DuplexPipeStream, PipeListener, PipeListenerOptions};
use interprocess::os::windows::security_descriptor::SecurityDescriptor;
use widestring::{U16CStr, u16cstr};

pub(crate) use self::stream::Stream;
use super::SocketError;

/// Start of the path of each pipe of this machine.
const PREFIX: &str = r"\\.\pipe\";

/// Maximum length of the path of a pipe, in characters (`CreateNamedPipe`).
const MAX_PATH: usize = 256;

/// All access for the owner, none for anybody else, in the security descriptor definition language. The owner is the user who
/// created the pipe; `OW` is the well-known SID for the rights of an owner.
const OWNER_ONLY: &U16CStr = u16cstr!("D:P(A;;GA;;;OW)");

/// Buffer of each direction, in bytes: lines that a client has not read yet.
const BUFFER_BYTES: u32 = 1 << 16;

/// Longest time in which a server accepts a connection.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(1);

/// Pause between attempts while all instances of a pipe are taken.
const RETRY_DELAY: Duration = Duration::from_millis(10);

/// `ERROR_ACCESS_DENIED`: the pipe exists, and this is not its first instance.
const ACCESS_DENIED: i32 = 5;

/// `ERROR_PIPE_BUSY`: all instances of the pipe are taken.
const PIPE_BUSY: i32 = 231;

/// `FILE_FLAG_OVERLAPPED`: one thread may write while another one reads.
const OVERLAPPED: u32 = 0x4000_0000;

/// `SECURITY_IDENTIFICATION`: the server cannot act in the name of a client.
const IDENTIFICATION: u32 = 0x0001_0000;

impl From<io::Error> for SocketError {
    fn from(error: io::Error) -> Self {
        match error.raw_os_error() {
            Some(ACCESS_DENIED | PIPE_BUSY) => Self::InUse,
            _ => Self::Other(error.to_string()),
        }
    }
}

/// Returns the path of the pipe of this name, `\\.\pipe\ademan-USER-NAME` without the ending of a socket. `None` without a user
/// name.
pub(crate) fn default_path(name: &str) -> Option<PathBuf> {
    let user = std::env::var("USERNAME").ok()?;
    let name = name.strip_suffix(".sock").unwrap_or(name);
    // A backslash would be a folder, which pipes do not have.
    let user = user.replace('\\', "-");
    Some(format!("{PREFIX}ademan-{user}-{name}").into())
}

/// A listening pipe. It ends when this is dropped.
pub(crate) struct Listener {
    pipe: PipeListener<Bytes, Bytes>,
    path: PathBuf,
}

impl Listener {
    /// Listens at `path`, for clients of this machine and user.
    pub fn open(path: &Path) -> Result<Self, SocketError> {
        check_path(path)?;
        // Windows refuses a pipe that exists, whose instances several programs could share otherwise; Wine does not.
        match open(path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            _ => return Err(SocketError::InUse),
        }
        let pipe = PipeListenerOptions::new()
            .path(path)
            .accept_remote(false)
            .input_buffer_size_hint(BUFFER_BYTES)
            .output_buffer_size_hint(BUFFER_BYTES)
            .security_descriptor(Some(SecurityDescriptor::deserialize(OWNER_ONLY)?))
            .create_duplex()?;
        Ok(Self {
            pipe,
            path: path.into(),
        })
    }

    /// Returns the path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns at once: [`accept`](Self::accept) waits.
    pub fn wait_for_client(&self) -> io::Result<()> {
        Ok(())
    }

    /// Waits for the next client.
    pub fn accept(&self) -> io::Result<Stream> {
        Stream::new(self.pipe.accept()?)
    }

    /// Fails: a handle is no scarce resource.
    pub fn spare_descriptor(&self) -> io::Result<File> {
        Err(io::ErrorKind::Unsupported.into())
    }

    /// Wakes a thread that blocks in [`accept`](Self::accept). Clients stay connected.
    pub fn close(&self) {
        // Only a client can end an `accept`.
        let _ = open(&self.path);
    }
}

/// Checks the form and the length of the path of a pipe.
pub(crate) fn check_path(path: &Path) -> Result<(), SocketError> {
    let text = path.to_string_lossy();
    let length = text.chars().count();
    let name = text.strip_prefix(PREFIX);
    match name {
        _ if length > MAX_PATH => Err(SocketError::PathTooLong {
            length,
            max: MAX_PATH,
        }),
        Some(name) if !name.is_empty() && !name.contains('\\') => Ok(()),
        _ => Err(SocketError::Other(format!(
            "a pipe of Windows has a name such as {PREFIX}ademan-second"
        ))),
    }
}

/// Connects as a client.
pub(crate) fn connect(path: &Path) -> io::Result<Stream> {
    check_path(path)
        .map_err(|error| io::Error::new(io::ErrorKind::InvalidInput, error.to_string()))?;
    let pipe = DuplexPipeStream::<Bytes>::try_from(OwnedHandle::from(open(path)?));
    Stream::new(pipe.map_err(|error| io::Error::other(error.to_string()))?)
}

/// Opens a pipe, within [`CONNECT_TIMEOUT`] while all its instances are taken.
fn open(path: &Path) -> io::Result<File> {
    let mut options = OpenOptions::new();
    options.read(true).write(true);
    options.custom_flags(OVERLAPPED);
    options.security_qos_flags(IDENTIFICATION);
    let start = Instant::now();
    loop {
        match options.open(path) {
            Err(error) if error.raw_os_error() == Some(PIPE_BUSY) => {
                if start.elapsed() > CONNECT_TIMEOUT {
                    return Err(io::Error::new(
                        io::ErrorKind::TimedOut,
                        "the program that listens there accepts no connection",
                    ));
                }
                thread::sleep(RETRY_DELAY);
            }
            opened => return opened,
        }
    }
}

#[cfg(test)]
mod tests;
