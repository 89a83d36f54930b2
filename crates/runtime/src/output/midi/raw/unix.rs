//! Raw devices of Unix, such as `/dev/snd/midiC1D0` and `/dev/midi1`.

use std::fmt::Display;
use std::io;
use std::os::unix::fs::FileTypeExt;
use std::path::Path;

use rustix::fs::{Access, FileType, Mode, OFlags};
use rustix::io::Errno;

use crate::output::midi::thread::Writer;
use ademan_core::message::escape_path;

/// The reason why other files are refused.
const NO_DEVICE: &str = "it is neither a device nor a pipe";

/// Opens a device or pipe for writing. The error states the cause and the remedy.
pub fn open(path: &Path) -> Result<Writer, String> {
    // A pipe without a reader would keep the program waiting.
    let flags = OFlags::WRONLY | OFlags::NONBLOCK | OFlags::NOCTTY | OFlags::CLOEXEC;
    let device = rustix::fs::open(path, flags, Mode::empty()).map_err(|error| {
        if error == Errno::NXIO && is_pipe(path) {
            let path = escape_path(path);
            format!("cannot open {path}: no program reads this pipe yet; start it first")
        } else {
            cannot_open(path, &io::Error::from(error))
        }
    })?;
    let stat = rustix::fs::fstat(&device);
    let stat = stat.map_err(|error| cannot_open(path, &io::Error::from(error)))?;
    match FileType::from_raw_mode(stat.st_mode) {
        FileType::CharacterDevice | FileType::Fifo => {}
        _ => return Err(cannot_open(path, &NO_DEVICE)),
    }
    Ok(Box::new(move |bytes| {
        Ok(rustix::io::write(&device, bytes)?)
    }))
}

/// Checks that there is a device or pipe that may be written, without opening it.
pub fn check(path: &Path) -> Result<(), String> {
    let metadata = path.metadata().map_err(|error| cannot_open(path, &error))?;
    let kind = metadata.file_type();
    if !kind.is_char_device() && !kind.is_fifo() {
        return Err(cannot_open(path, &NO_DEVICE));
    }
    let allowed = rustix::fs::access(path, Access::WRITE_OK);
    allowed.map_err(|error| cannot_open(path, &io::Error::from(error)))
}

/// Returns the cause and the remedy.
fn cannot_open(path: &Path, reason: &dyn Display) -> String {
    format!(
        "cannot open {}: {reason}; `amidi -l` lists the ALSA devices, of which hw:1,0 is /dev/snd/midiC1D0",
        escape_path(path)
    )
}

fn is_pipe(path: &Path) -> bool {
    path.metadata().is_ok_and(|it| it.file_type().is_fifo())
}
