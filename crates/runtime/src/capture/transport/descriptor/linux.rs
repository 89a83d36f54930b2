//! Descriptors of Linux.

use std::fs::{self, File};
use std::io::{Read, Result};
use std::net::TcpStream;
use std::os::fd::AsFd;
use std::os::unix::fs::MetadataExt;

use rustix::fs::{Mode, OFlags, open};
use rustix::net::{RecvFlags, recv};

use crate::capture::connection::ByteStream;
use crate::capture::poll::Readiness;

/// Directory of the kernel's pseudo-terminals.
const PSEUDO_TERMINALS: &str = "/dev/pts";

/// Link to the standard input of this process.
const STANDARD_INPUT: &str = "/proc/self/fd/0";

/// Opens `port` for reading, without blocking, before the port is locked: `serialport` does not expose its
/// descriptor. Returns `None` on failure.
pub fn open_to_read(port: &str) -> Option<File> {
    let flags = OFlags::RDONLY | OFlags::NONBLOCK | OFlags::NOCTTY | OFlags::CLOEXEC;
    open(port, flags, Mode::empty()).ok().map(File::from)
}

/// Opens the standard input. The file bypasses the buffer of [`std::io::stdin`], whose content `poll` cannot see.
///
/// It is opened a second time, because other processes that use it do not expect it to be non-blocking. A socket cannot be
/// opened in this way.
pub fn open_stdin() -> Result<(Box<dyn ByteStream>, Option<Readiness>)> {
    if let Some(file) = open_to_read(STANDARD_INPUT) {
        let readiness = Readiness::new(&file);
        return Ok((Box::new(file), readiness));
    }
    let file = File::from(std::io::stdin().as_fd().try_clone_to_owned()?);
    let readiness = Readiness::new(&file);
    Ok((Box::new(SharedFile(file)), readiness))
}

/// File that other processes may read, too.
struct SharedFile(File);

impl Read for SharedFile {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        self.0.read(buffer)
    }
}

impl ByteStream for SharedFile {
    fn may_block(&self) -> bool {
        true
    }
}

/// Reads what has arrived, whether or not the socket blocks.
pub fn read_available(stream: &TcpStream, buffer: &mut [u8]) -> Result<usize> {
    let (length, _) = recv(stream, buffer, RecvFlags::DONTWAIT)?;
    Ok(length)
}

/// Identity of a pseudo-terminal: its number is given to the next terminal after it has ended.
#[derive(Clone, Debug, PartialEq)]
pub struct TerminalIdentity {
    /// Inode and change time (seconds, nanoseconds) of a link; `None` for the terminal's own name.
    link: Option<(u64, i64, i64)>,
}

impl TerminalIdentity {
    /// Reads the identity of `port`. Returns `None` if it is not a pseudo-terminal.
    pub fn read(port: &str) -> Option<Self> {
        if !fs::canonicalize(port).ok()?.starts_with(PSEUDO_TERMINALS) {
            return None;
        }
        let metadata = fs::symlink_metadata(port).ok()?;
        let change = (metadata.ino(), metadata.ctime(), metadata.ctime_nsec());
        Some(Self {
            link: metadata.file_type().is_symlink().then_some(change),
        })
    }
}

#[cfg(test)]
mod tests {
    use std::thread::sleep;
    use std::time::Duration;

    use super::*;

    #[test]
    fn a_replaced_link_has_another_identity() {
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("glove");
        let identity = || TerminalIdentity::read(link.to_str().unwrap());
        assert_eq!(identity(), None);
        let (_master, slave) = serialport::TTYPort::pair().unwrap();
        let terminal = serialport::SerialPort::name(&slave).unwrap();
        std::os::unix::fs::symlink(&terminal, &link).unwrap();
        let first = identity();
        assert!(first.is_some());
        assert_eq!(identity(), first);
        fs::remove_file(&link).unwrap();
        sleep(Duration::from_millis(20));
        std::os::unix::fs::symlink(&terminal, &link).unwrap();
        assert_ne!(identity(), first);
        let own = TerminalIdentity::read(&terminal);
        assert_eq!(own, Some(TerminalIdentity { link: None }));
        assert_eq!(TerminalIdentity::read("/dev/null"), None);
    }
}
