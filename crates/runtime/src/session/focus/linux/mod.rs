//! The focus on Linux: of an X server with a window manager, or of sway.

mod sway;
mod x11;

use std::env;
use std::ffi::OsString;
use std::io::{self, PipeReader, PipeWriter};
use std::os::fd::BorrowedFd;
use std::thread;

use rustix::event::{PollFd, PollFlags, poll};
use rustix::io::Errno;

/// Ends the thread when it is dropped.
pub type Cancel = PipeWriter;

/// A connection to a desktop.
trait Desktop {
    /// Returns its name.
    fn name(&self) -> &'static str;

    /// Returns the socket whose data [`read`](Self::read) processes.
    fn socket(&self) -> BorrowedFd<'_>;

    /// Processes everything that has arrived. Returns the names of the application that has the focus, if one has it and another one may
    /// have had it at the call before. The first call returns the present state.
    fn read(&mut self) -> Result<Option<Vec<String>>, String>;
}

/// Starts a thread that calls `follow` with the names of the application that has the focus, at first and after each change, until `follow`
/// returns `false`, the result is dropped, or the desktop fails: then it calls `report` with the reason.
pub fn watch(
    follow: impl FnMut(&[String]) -> bool + Send + 'static,
    report: impl FnOnce(String) + Send + 'static,
) -> io::Result<Cancel> {
    let (cancelled, cancel) = io::pipe()?;
    let run = move || {
        if let Err(reason) = run(&cancelled, follow) {
            report(reason);
        }
    };
    thread::Builder::new().name("focus".into()).spawn(run)?;
    Ok(cancel)
}

fn run(cancelled: &PipeReader, mut follow: impl FnMut(&[String]) -> bool) -> Result<(), String> {
    let mut desktop = connect()?;
    loop {
        if let Some(names) = desktop.read()?
            && !follow(&names)
        {
            return Ok(());
        }
        if is_cancelled(cancelled, desktop.socket())? {
            return Ok(());
        }
    }
}

/// Waits until the desktop has sent something. Returns `true` if the session has ended instead.
fn is_cancelled(cancelled: &PipeReader, socket: BorrowedFd) -> Result<bool, String> {
    let mut descriptors = [
        PollFd::new(cancelled, PollFlags::IN),
        PollFd::from_borrowed_fd(socket, PollFlags::IN),
    ];
    match poll(&mut descriptors, None) {
        Ok(_) | Err(Errno::INTR) => Ok(!descriptors[0].revents().is_empty()),
        Err(error) => Err(io::Error::from(error).to_string()),
    }
}

/// Connects to the desktop of the session.
fn connect() -> Result<Box<dyn Desktop>, String> {
    let value = |name: &str| env::var_os(name).filter(|value: &OsString| !value.is_empty());
    match (value("WAYLAND_DISPLAY"), value("SWAYSOCK")) {
        (Some(_), Some(socket)) => Ok(Box::new(sway::Sway::connect(&socket)?)),
        (Some(_), None) => Err(
            "SWAYSOCK is not set, and of the Wayland compositors only sway tells which application has the focus; start the program from \
             its terminal or configuration"
                .into(),
        ),
        (None, _) => Ok(Box::new(x11::XServer::connect()?)),
    }
}

/// Returns the name of the desktop, and the names of the application that has the focus, if any has it.
pub fn probe() -> Result<(&'static str, Vec<String>), String> {
    let mut desktop = connect()?;
    let names = desktop.read()?;
    Ok((desktop.name(), names.unwrap_or_default()))
}
