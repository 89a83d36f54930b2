//! Loopback over a pseudo-terminal, which is a serial port to the source.

use std::io::{Error, ErrorKind, Result, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use serialport::{SerialPort, TTYPort};

use super::Loopback;
use crate::capture::SourceUri;
use crate::capture::protocol::StreamFormat;
use crate::capture::transport::{StreamUri, serial};
use ademan_core::message::escape_path;

/// Opens a loopback over a pair of pseudo-terminals.
///
/// The port name is a link in the folder for temporary files, because the system gives the terminal's own name to
/// the next terminal that is opened, which a reconnecting source must not open.
pub fn open_loopback(format: impl Into<StreamFormat>) -> Result<Loopback> {
    let (master, slave) = TTYPort::pair()?;
    // The clones are closed in child processes, which would otherwise keep the connection open.
    let (mut master, slave) = (master.try_clone_native()?, slave.try_clone_native()?);
    master.set_timeout(WRITE_TIMEOUT)?;
    let terminal = slave
        .name()
        .ok_or_else(|| Error::other("the pseudo-terminal has no name"))?;
    let link = Link::new(Path::new(&terminal))?;
    let address = link.0.to_string_lossy().into_owned();
    let writer = PtyWriter {
        _link: link,
        master,
        _slave: slave,
    };
    Ok(Loopback {
        writer: Box::new(writer),
        uri: SourceUri::Stream(StreamUri::new(&serial::TRANSPORT, address, format)),
    })
}

/// Bytes that fit into a terminal that is ready for writing (Linux allocates its buffers in pieces of 256). A longer
/// write could block indefinitely without a reader.
const MAX_WRITE: usize = 128;

/// Longest wait for room. The buffer holds seconds of a serial line, so it is full only without a reader.
const WRITE_TIMEOUT: Duration = Duration::from_millis(10);

/// Writing end. The fields are dropped in order: a port that is unplugged loses its name first.
struct PtyWriter {
    _link: Link,
    master: TTYPort,
    /// Keeps the terminal's settings while no source has it open.
    _slave: TTYPort,
}

impl Write for PtyWriter {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        let piece = &bytes[..bytes.len().min(MAX_WRITE)];
        match self.master.write(piece) {
            // The buffer is full and has no reader: these bytes are lost.
            Err(error) if error.kind() == ErrorKind::TimedOut => Ok(piece.len()),
            result => result,
        }
    }

    /// Does nothing: written bytes are in the terminal's buffer at once.
    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}

/// Symbolic link that is removed when it is dropped.
struct Link(PathBuf);

impl Link {
    fn new(target: &Path) -> Result<Self> {
        static NUMBER: AtomicUsize = AtomicUsize::new(0);
        loop {
            let number = NUMBER.fetch_add(1, Ordering::Relaxed);
            let name = format!("ademan-loopback-{}-{number}", std::process::id());
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
            tracing::debug!("cannot remove {}: {error}", escape_path(&self.0));
        }
    }
}
