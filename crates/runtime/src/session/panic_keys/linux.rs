//! The keyboards of a Linux machine: `/dev/input/event*`.

use std::fs;
use std::io::{self, PipeReader, PipeWriter};
use std::mem::MaybeUninit;
use std::os::fd::{AsFd, OwnedFd};
use std::path::{Path, PathBuf};
use std::thread;

use evdev::{Device, EventSummary};
use rustix::event::{PollFd, PollFlags, poll};
use rustix::fs::inotify::{self, CreateFlags, Reader, WatchFlags};
use rustix::io::Errno;

use super::key_combination::KeyCombination;
use crate::priority;
use ademan_core::device::KeyCode;

/// Prefix of the names of the devices that this program creates. Their keys are ignored.
const OWN_PREFIX: &str = "Ademan ";

/// Directory of the device nodes.
const NODES: &str = "/dev/input";

/// Events after which a node may be readable: udev sets its permissions some time after its creation.
const NODE_EVENTS: WatchFlags = WatchFlags::CREATE
    .union(WatchFlags::ATTRIB)
    .union(WatchFlags::MOVED_TO);

/// Ends the thread when it is dropped.
pub(super) type Cancel = PipeWriter;

/// Checks that the keyboards can be watched.
pub(super) fn check(keys: &[KeyCode]) -> Result<(), String> {
    open(keys).map(drop)
}

/// Watches the keyboards on a thread of its own until the result is dropped.
pub(super) fn watch(keys: &[KeyCode], stop: impl Fn() + Send + 'static) -> Result<Cancel, String> {
    follow(open(keys)?, stop).map_err(|error| error.to_string())
}

fn follow(mut monitor: KeyboardMonitor, stop: impl Fn() + Send + 'static) -> io::Result<Cancel> {
    let (cancelled, cancel) = io::pipe()?;
    let run = move || {
        // An emergency stop does not wait for other programs.
        priority::raise_thread_priority();
        monitor.report(&stop);
        while let Ok(is_watching) = monitor.wait(&cancelled, &stop) {
            if !is_watching {
                return;
            }
        }
        tracing::error!("panic_keys: the keyboards can no longer be watched");
    };
    thread::Builder::new()
        .name("panic keys".into())
        .spawn(run)?;
    Ok(cancel)
}

/// Opens the keyboards that have these keys.
fn open(keys: &[KeyCode]) -> Result<KeyboardMonitor, String> {
    let inotify_error = |error: Errno| format!("cannot watch {NODES}: {error}");
    let inotify =
        inotify::init(CreateFlags::CLOEXEC | CreateFlags::NONBLOCK).map_err(inotify_error)?;
    inotify::add_watch(&inotify, NODES, NODE_EVENTS).map_err(inotify_error)?;
    let mut monitor = KeyboardMonitor {
        combination: KeyCombination::new(keys),
        is_complete: false,
        inotify,
        keyboards: Vec::new(),
        next_id: 0,
    };
    let denied = monitor.open_new();
    if monitor.keyboards.is_empty() {
        return Err(match denied {
            0 => format!("no keyboard in {NODES} has these keys"),
            _ => format!(
                "no permission to read the keyboards in {NODES}; a udev rule with TAG+=\"uaccess\" or the group \
                 `input` gives it, and with it the permission to read all that is typed"
            ),
        });
    }
    Ok(monitor)
}

/// An open keyboard.
struct Keyboard {
    id: u64,
    path: PathBuf,
    device: Device,
}

/// The keyboards that have keys of the combination.
struct KeyboardMonitor {
    combination: KeyCombination,
    /// `true` if the combination was completed and that is not reported.
    is_complete: bool,
    inotify: OwnedFd,
    keyboards: Vec<Keyboard>,
    /// Number of keyboards opened so far.
    next_id: u64,
}

impl KeyboardMonitor {
    /// Opens the keyboards that are not open yet. Returns the number of nodes without permission.
    fn open_new(&mut self) -> usize {
        let nodes = fs::read_dir(NODES).into_iter().flatten().flatten();
        let mut denied = 0;
        for path in nodes.map(|node| node.path()).filter(|path| is_node(path)) {
            if self.keyboards.iter().any(|keyboard| keyboard.path == path) {
                continue;
            }
            match Device::open(&path) {
                Ok(device) => self.add(path, device),
                Err(error) => {
                    denied += usize::from(error.kind() == io::ErrorKind::PermissionDenied);
                }
            }
        }
        denied
    }

    fn add(&mut self, path: PathBuf, device: Device) {
        let is_own = device
            .name()
            .is_some_and(|name| name.starts_with(OWN_PREFIX));
        let has_key = |key: &KeyCode| {
            let code = evdev::KeyCode::new(key.event_code());
            device
                .supported_keys()
                .is_some_and(|keys| keys.contains(code))
        };
        let is_relevant = !is_own && self.combination.keys.iter().any(has_key);
        if !is_relevant || device.set_nonblocking(true).is_err() {
            return;
        }
        self.next_id += 1;
        let id = self.next_id;
        // A person may have begun before the watch, as during a change of the setup. With this answer the kernel drops the queued
        // events of keys, which it includes.
        if let Ok(held) = device.get_key_state() {
            for key in self.combination.keys.clone() {
                if held.contains(evdev::KeyCode::new(key.event_code())) {
                    self.is_complete |= self.combination.update(id, key, true);
                }
            }
        }
        self.keyboards.push(Keyboard { id, path, device });
    }

    /// Waits for events of keyboards or nodes, and handles them. Returns `false` once the watch is cancelled.
    fn wait(&mut self, cancelled: &PipeReader, stop: &impl Fn()) -> Result<bool, Errno> {
        let devices = self
            .keyboards
            .iter()
            .map(|keyboard| keyboard.device.as_fd());
        let mut poll_fds: Vec<_> = [cancelled.as_fd(), self.inotify.as_fd()]
            .into_iter()
            .chain(devices)
            .map(|fd| PollFd::from_borrowed_fd(fd, PollFlags::IN))
            .collect();
        match poll(&mut poll_fds, None) {
            Ok(_) | Err(Errno::INTR) => {}
            Err(error) => return Err(error),
        }
        let is_ready = |fd: &PollFd| !fd.revents().is_empty();
        if is_ready(&poll_fds[0]) {
            return Ok(false);
        }
        let has_new_node = is_ready(&poll_fds[1]);
        let ready: Vec<_> = poll_fds[2..].iter().map(is_ready).collect();
        drop(poll_fds);
        let mut index = 0;
        for has_data in ready {
            if has_data && !self.read(index) {
                let removed = self.keyboards.remove(index);
                self.combination.remove_keyboard(removed.id);
            } else {
                index += 1;
            }
        }
        self.report(stop);
        if has_new_node {
            self.discard_node_events();
            self.open_new();
            self.report(stop);
        }
        Ok(true)
    }

    /// Calls `stop` if the combination was completed since the previous call.
    fn report(&mut self, stop: &impl Fn()) {
        if std::mem::take(&mut self.is_complete) {
            stop();
        }
    }

    /// Reads the events of a keyboard. Returns `true` if it is still connected.
    fn read(&mut self, index: usize) -> bool {
        let keyboard = &mut self.keyboards[index];
        let events = match keyboard.device.fetch_events() {
            Ok(events) => events,
            Err(error) => return error.kind() == io::ErrorKind::WouldBlock,
        };
        for event in events {
            // 0 is a release, 1 a press, 2 an auto-repeat.
            let EventSummary::Key(_, code, value @ (0 | 1)) = event.destructure() else {
                continue;
            };
            if let Some(key) = KeyCode::from_event_code(code.code()) {
                self.is_complete |= self.combination.update(keyboard.id, key, value == 1);
            }
        }
        true
    }

    fn discard_node_events(&self) {
        let mut buffer = [MaybeUninit::uninit(); 1024];
        let mut events = Reader::new(&self.inotify, &mut buffer);
        while events.next().is_ok() {}
    }
}

fn is_node(path: &Path) -> bool {
    let name = path.file_name().and_then(|name| name.to_str());
    name.is_some_and(|name| name.starts_with("event"))
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{self, RecvTimeoutError, TryRecvError};
    use std::time::Duration;

    use super::*;

    #[test]
    fn the_thread_ends_with_the_watch() {
        let monitor = KeyboardMonitor {
            combination: KeyCombination::new(&[]),
            is_complete: false,
            inotify: inotify::init(CreateFlags::CLOEXEC | CreateFlags::NONBLOCK).unwrap(),
            keyboards: Vec::new(),
            next_id: 0,
        };
        let (pressed, presses) = mpsc::channel();
        let watch = follow(monitor, move || _ = pressed.send(())).unwrap();
        assert_eq!(presses.try_recv(), Err(TryRecvError::Empty));
        drop(watch);
        let ended = presses.recv_timeout(Duration::from_secs(60));
        assert_eq!(ended, Err(RecvTimeoutError::Disconnected));
    }
}
