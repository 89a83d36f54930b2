//! A wire over a pseudo terminal: to the source it is a serial port.

use std::io::{Error, ErrorKind, Result, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use serialport::{SerialPort, TTYPort};

use super::loopback::Loopback;
use crate::capture::SourceUri;
use crate::capture::uri::StreamOptions;

/// Opens a wire over a pair of pseudo terminals.
///
/// The port has a name of its own, a link in the folder for temporary files. The system's name of the terminal
/// goes to the next one that is opened, and a source that looks for this port must not find that one.
pub fn open_loopback(line: StreamOptions) -> Result<Loopback> {
    let (master, slave) = TTYPort::pair()?;
    // The copies are closed in programs that this one starts, which would keep the line alive.
    let (mut master, slave) = (master.try_clone_native()?, slave.try_clone_native()?);
    master.set_timeout(ROOM_TIMEOUT)?;
    let terminal = slave
        .name()
        .ok_or_else(|| Error::other("the pseudo terminal has no name"))?;
    let link = Link::new(Path::new(&terminal))?;
    let port = link.0.to_string_lossy().into_owned();
    let writer = PtyWriter {
        _link: link,
        master,
        _slave: slave,
    };
    Ok(Loopback {
        writer: Box::new(writer),
        uri: SourceUri::Serial { port, line },
    })
}

/// A terminal that says it has room takes so many bytes (Linux: its buffers come in pieces of 256); a longer write
/// would block for good when nobody reads.
const LONGEST_WRITE: usize = 128;

/// How long a write waits for room. The terminal holds seconds of a line, so only a reader that is gone fills it.
const ROOM_TIMEOUT: Duration = Duration::from_millis(10);

/// The fields are dropped in order: a port that is unplugged loses its name first.
struct PtyWriter {
    _link: Link,
    master: TTYPort,
    /// Keeps the terminal in its mode while no source has it open.
    _slave: TTYPort,
}

impl Write for PtyWriter {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        let piece = &bytes[..bytes.len().min(LONGEST_WRITE)];
        match self.master.write(piece) {
            // Nobody reads and the terminal is full: these bytes are lost as on a real line.
            Err(error) if error.kind() == ErrorKind::TimedOut => Ok(piece.len()),
            result => result,
        }
    }

    /// Nothing to do: what is written is with the terminal at once.
    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}

/// A symbolic link that is removed when it is dropped.
struct Link(PathBuf);

impl Link {
    fn new(target: &Path) -> Result<Self> {
        static NUMBER: AtomicUsize = AtomicUsize::new(0);
        loop {
            let number = NUMBER.fetch_add(1, Ordering::Relaxed);
            let name = format!("ademan-wire-{}-{number}", std::process::id());
            let path = std::env::temp_dir().join(name);
            match std::os::unix::fs::symlink(target, &path) {
                Ok(()) => return Ok(Self(path)),
                // Left behind by a program that was killed.
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        if let Err(error) = std::fs::remove_file(&self.0) {
            tracing::debug!("{} is left behind: {error}", self.0.display());
        }
    }
}
