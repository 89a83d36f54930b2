//! Raw devices of Unix, such as `/dev/snd/midiC1D0` and `/dev/midi1`.

use std::io;
use std::os::fd::OwnedFd;
use std::os::unix::fs::FileTypeExt;
use std::path::Path;
use std::thread;
use std::time::Duration;

use rustix::fs::{FileType, Mode, OFlags};
use rustix::io::Errno;

use crate::output::midi::thread::Writer;
use ademan_core::message::escape_path;

/// Time between two tries to write to a full device.
const RETRY_DELAY: Duration = Duration::from_millis(2);

/// Opens a device or pipe for writing. The error states the cause and the remedy.
pub fn open(path: &Path) -> Result<Writer, String> {
    let cannot = |reason: &dyn std::fmt::Display| {
        format!(
            "cannot open {}: {reason}; `amidi -l` lists the devices of ALSA, of which hw:1,0 is /dev/snd/midiC1D0",
            escape_path(path)
        )
    };
    // A pipe without a reader would keep the program waiting.
    let flags = OFlags::WRONLY | OFlags::NONBLOCK | OFlags::NOCTTY | OFlags::CLOEXEC;
    let device = rustix::fs::open(path, flags, Mode::empty()).map_err(|error| {
        if error == Errno::NXIO && is_pipe(path) {
            let path = escape_path(path);
            format!("cannot open {path}: no program reads this pipe yet; start it first")
        } else {
            cannot(&io::Error::from(error))
        }
    })?;
    let stat = rustix::fs::fstat(&device).map_err(|error| cannot(&io::Error::from(error)))?;
    match FileType::from_raw_mode(stat.st_mode) {
        FileType::CharacterDevice | FileType::Fifo => {}
        _ => return Err(cannot(&"it is neither a device nor a pipe")),
    }
    Ok(Box::new(move |message| write_all(&device, message)))
}

fn is_pipe(path: &Path) -> bool {
    path.metadata().is_ok_and(|it| it.file_type().is_fifo())
}

fn write_all(device: &OwnedFd, mut bytes: &[u8]) -> io::Result<()> {
    while !bytes.is_empty() {
        match rustix::io::write(device, bytes) {
            Ok(written) => bytes = &bytes[written..],
            Err(Errno::AGAIN) => thread::sleep(RETRY_DELAY),
            Err(Errno::INTR) => {}
            Err(error) => return Err(error.into()),
        }
    }
    Ok(())
}
