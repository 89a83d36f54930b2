//! A display that answers late, as over a network, lacks an extension, or reads half of what a client wrote: a socket that passes
//! bytes on after a delay.

use std::fs;
use std::io::{Read, Write};
use std::net::Shutdown;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use crossbeam_channel::unbounded;

use crate::support::x11::XServer;

/// The folder of the sockets of displays.
const FOLDER: &str = "/tmp/.X11-unix";

/// Number of displays that this process has created.
static DISPLAYS: AtomicU32 = AtomicU32::new(0);

/// A change of what is passed on. Returns the number of bytes to pass on: less than all cut the connection there.
type Filter = fn(&mut [u8]) -> usize;

/// A display whose requests and replies take a time each. Its threads end with their connections.
pub struct SlowDisplay {
    display: String,
    path: PathBuf,
}

impl SlowDisplay {
    /// Creates a display that passes everything on to a server.
    pub fn start(server: &XServer, delay: Duration) -> Self {
        Self::with_filter(server, delay, |part| part.len())
    }

    /// Creates a display that passes everything on to a server at once, and has no X Input extension.
    pub fn without_input_extension(server: &XServer) -> Self {
        Self::with_filter(server, Duration::ZERO, |part| {
            let name = b"XInputExtension";
            let mut starts = 0..part.len().saturating_sub(name.len() - 1);
            if let Some(start) = starts.find(|&start| part[start..].starts_with(name)) {
                part[start] = b'-';
            }
            part.len()
        })
    }

    /// Creates a display that reads no more of a connection after the first key that goes down and comes up in one write.
    pub fn that_reads_half(server: &XServer) -> Self {
        Self::with_filter(server, Duration::ZERO, |part| {
            // `FakeInput` of XTEST: 9 words with the minor opcode 2, and a press or a release.
            let is_input = |request: &[u8], kind| request[1..5] == [2, 9, 0, kind];
            let mut starts = (0..part.len().saturating_sub(71)).step_by(4);
            let is_tap = |start: &usize| {
                let (press, release) = part[*start..start + 72].split_at(36);
                is_input(press, 2) && is_input(release, 3) && press[5] == release[5]
            };
            starts.find(is_tap).map_or(part.len(), |start| start + 36)
        })
    }

    /// Creates a display whose requests pass a filter.
    fn with_filter(server: &XServer, delay: Duration, filter: Filter) -> Self {
        let path_of = |number: &str| PathBuf::from(FOLDER).join(format!("X{number}"));
        let created = DISPLAYS.fetch_add(1, Ordering::Relaxed);
        let number = server.display().trim_start_matches(':');
        let (target, slow) = (
            path_of(number),
            format!("{}", 20_000 + (std::process::id() + created) % 40_000),
        );
        let path = path_of(&slow);
        let listener = UnixListener::bind(&path).expect("a socket beside the one of the server");
        thread::spawn(move || {
            for client in listener.incoming().map_while(Result::ok) {
                let accepted = UnixStream::connect(&target).expect("the server accepts it");
                let ends = [&client, &accepted].map(|end| end.try_clone().expect("a descriptor"));
                let [to_client, to_server] = ends;
                pass_on(client, to_server, delay, filter);
                pass_on(accepted, to_client, delay, |part| part.len());
            }
        });
        Self {
            display: format!(":{slow}"),
            path,
        }
    }

    /// Returns the name of the display.
    pub fn display(&self) -> &str {
        &self.display
    }
}

impl Drop for SlowDisplay {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.path);
    }
}

/// Starts two threads that pass on what arrives and passes the filter, each part after the delay.
fn pass_on(mut from: UnixStream, mut to: UnixStream, delay: Duration, filter: Filter) {
    let (sender, parts) = unbounded::<(Instant, Vec<u8>)>();
    thread::spawn(move || {
        let (mut buffer, mut is_cut) = ([0; 1 << 16], false);
        while let Ok(length @ 1..) = from.read(&mut buffer) {
            if is_cut {
                continue;
            }
            let passed = filter(&mut buffer[..length]);
            is_cut = passed < length;
            let part = (Instant::now() + delay, buffer[..passed].to_vec());
            if sender.send(part).is_err() {
                return;
            }
        }
    });
    thread::spawn(move || {
        for (time, part) in parts {
            thread::sleep(time.saturating_duration_since(Instant::now()));
            if to.write_all(&part).is_err() {
                break;
            }
        }
        let _ = to.shutdown(Shutdown::Both);
    });
}
