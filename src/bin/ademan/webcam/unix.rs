//! The bridge as standard input.

use std::process::{Child, Stdio};

use rustix::event::{PollFd, PollFlags, poll};
use rustix::io::Errno;
use rustix::stdio::dup2_stdin;

use crate::bridge::CameraArgs;
use crate::failure::Failure;

/// Starts the bridge, waits for its first image, and makes its lines the standard input of this process.
pub fn connect(camera: &CameraArgs) -> Result<Child, Failure> {
    let mut command = camera.command()?;
    let started = command.stdout(Stdio::piped()).spawn();
    let mut bridge = started.map_err(|error| camera.no_python(&error))?;
    say!("waiting for the first image; Ctrl-C ends");
    let lines = bridge.stdout.take().expect("standard output is piped");
    let mut fds = [PollFd::new(&lines, PollFlags::IN)];
    while poll(&mut fds, None) == Err(Errno::INTR) {}
    if !fds[0].revents().contains(PollFlags::IN) {
        // It has closed its output without a line, and said why.
        let _ = bridge.wait();
        return Err(Failure::job(
            "the camera gives no image; the message of the bridge is above, and `ademan bridge webcam --run` repeats it",
        ));
    }
    dup2_stdin(&lines).map_err(|error| {
        Failure::job(format!("cannot read the lines of the bridge: {error}; `ademan bridge webcam --run | ademan run --source 'stdin:?protocol=hand-landmarks'` does the same"))
    })?;
    Ok(bridge)
}
