//! The keyboards of a Linux machine: `/dev/input/event*`.

use std::fs;
use std::io;
use std::mem::MaybeUninit;
use std::os::fd::{AsFd, OwnedFd};
use std::path::{Path, PathBuf};
use std::thread;

use evdev::{Device, EventSummary};
use rustix::event::{PollFd, PollFlags, poll};
use rustix::fs::inotify::{self, CreateFlags, Reader, WatchFlags};
use rustix::io::Errno;

use super::key_combination::KeyCombination;
use crate::device::KeyCode;

/// How the names of the program's own keyboards begin: what it presses itself stops nothing.
const OWN: &str = "Ademan ";

/// Where the kernel puts the nodes of what can be pressed.
const NODES: &str = "/dev/input";

/// A node is made, and given its rights a moment later.
const MAY_BE_READABLE: WatchFlags = WatchFlags::CREATE
    .union(WatchFlags::ATTRIB)
    .union(WatchFlags::MOVED_TO);

/// Watches on a thread of its own, until the program ends.
pub(super) fn watch(keys: &[KeyCode], stop: impl Fn() + Send + 'static) -> Result<(), String> {
    let no_notice = |error: Errno| format!("{NODES} cannot be watched: {error}");
    let notices = inotify::init(CreateFlags::CLOEXEC | CreateFlags::NONBLOCK).map_err(no_notice)?;
    inotify::add_watch(&notices, NODES, MAY_BE_READABLE).map_err(no_notice)?;
    let mut keyboards = KeyboardMonitor {
        chord: KeyCombination::new(keys),
        notices,
        open: Vec::new(),
        opened: 0,
    };
    let denied = keyboards.look();
    if keyboards.open.is_empty() {
        return Err(match denied {
            0 => format!("there is no keyboard with these keys in {NODES}"),
            _ => format!(
                "this user may not read the keyboards in {NODES}: a rule of udev with TAG+=\"uaccess\" or the \
                 group `input` gives that right, and with it that of reading what everybody types"
            ),
        });
    }
    let wait = move || {
        while keyboards.wait(&stop).is_ok() {}
        tracing::error!("panic_keys: the keyboards cannot be watched any more");
    };
    let thread = thread::Builder::new().name("stop keys".into());
    thread
        .spawn(wait)
        .map(drop)
        .map_err(|error| error.to_string())
}

struct Keyboard {
    number: u64,
    path: PathBuf,
    device: Device,
}

struct KeyboardMonitor {
    chord: KeyCombination,
    notices: OwnedFd,
    open: Vec<Keyboard>,
    /// How many have been opened so far.
    opened: u64,
}

impl KeyboardMonitor {
    /// Opens the keyboards that are not open yet; how many may not be.
    fn look(&mut self) -> usize {
        let nodes = fs::read_dir(NODES).into_iter().flatten().flatten();
        let mut denied = 0;
        for path in nodes.map(|node| node.path()).filter(|path| is_node(path)) {
            if self.open.iter().any(|keyboard| keyboard.path == path) {
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
        let is_own = device.name().is_some_and(|name| name.starts_with(OWN));
        let has = |key: &KeyCode| {
            let code = evdev::KeyCode::new(key.event_code());
            device
                .supported_keys()
                .is_some_and(|keys| keys.contains(code))
        };
        if is_own || !self.chord.keys.iter().any(has) || device.set_nonblocking(true).is_err() {
            return;
        }
        self.opened += 1;
        self.open.push(Keyboard {
            number: self.opened,
            path,
            device,
        });
    }

    /// Waits until something happens to a keyboard, and takes note of it.
    fn wait(&mut self, stop: &impl Fn()) -> Result<(), Errno> {
        let devices = self.open.iter().map(|keyboard| keyboard.device.as_fd());
        let mut sources: Vec<_> = std::iter::once(self.notices.as_fd())
            .chain(devices)
            .map(|source| PollFd::from_borrowed_fd(source, PollFlags::IN))
            .collect();
        match poll(&mut sources, None) {
            Ok(_) | Err(Errno::INTR) => {}
            Err(error) => return Err(error),
        }
        let is_told = |source: &PollFd| !source.revents().is_empty();
        let is_new = is_told(&sources[0]);
        let told: Vec<_> = sources[1..].iter().map(is_told).collect();
        drop(sources);
        let mut place = 0;
        let mut is_complete = false;
        for is_told in told {
            if is_told && !self.read(place, &mut is_complete) {
                let gone = self.open.remove(place);
                self.chord.remove_keyboard(gone.number);
            } else {
                place += 1;
            }
        }
        if is_complete {
            stop();
        }
        if is_new {
            self.empty_notices();
            self.look();
        }
        Ok(())
    }

    /// Takes what a keyboard has to say; whether it is still there.
    fn read(&mut self, place: usize, is_complete: &mut bool) -> bool {
        let keyboard = &mut self.open[place];
        let events = match keyboard.device.fetch_events() {
            Ok(events) => events,
            Err(error) => return error.kind() == io::ErrorKind::WouldBlock,
        };
        for event in events {
            // 0 is up, 1 down, 2 the repetition of what is down.
            let EventSummary::Key(_, code, state @ (0 | 1)) = event.destructure() else {
                continue;
            };
            if let Some(key) = KeyCode::from_event_code(code.code()) {
                *is_complete |= self.chord.update(keyboard.number, key, state == 1);
            }
        }
        true
    }

    fn empty_notices(&self) {
        let mut room = [MaybeUninit::uninit(); 1024];
        let mut notices = Reader::new(&self.notices, &mut room);
        while notices.next().is_ok() {}
    }
}

fn is_node(path: &Path) -> bool {
    let name = path.file_name().and_then(|name| name.to_str());
    name.is_some_and(|name| name.starts_with("event"))
}
