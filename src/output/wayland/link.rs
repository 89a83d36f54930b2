//! The connection itself: what the compositor offers, and messages that have to arrive.

use std::env;
use std::ffi::OsStr;
use std::fs::File;
use std::io::{self, ErrorKind};
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::path::PathBuf;
use std::thread;
use std::time::{Duration, Instant};

use wayland_client::backend::WaylandError;
use wayland_client::globals::{GlobalList, GlobalListContents, registry_queue_init};
use wayland_client::protocol::wl_keyboard::{self, KeymapFormat, WlKeyboard};
use wayland_client::protocol::wl_registry::{self, WlRegistry};
use wayland_client::protocol::wl_seat::{self, Capability, WlSeat};
use wayland_client::{Connection, Dispatch, EventQueue, Proxy, QueueHandle, WEnum, delegate_noop};
use wayland_protocols_misc::zwp_virtual_keyboard_v1::client::{
    zwp_virtual_keyboard_manager_v1::ZwpVirtualKeyboardManagerV1,
    zwp_virtual_keyboard_v1::ZwpVirtualKeyboardV1,
};
use wayland_protocols_wlr::virtual_pointer::v1::client::{
    zwlr_virtual_pointer_manager_v1::ZwlrVirtualPointerManagerV1,
    zwlr_virtual_pointer_v1::ZwlrVirtualPointerV1,
};

use crate::advice;

/// How long a compositor may leave messages unread before it counts as gone.
const PATIENCE: Duration = Duration::from_secs(5);

/// How long to wait before it is offered them again.
const PAUSE: Duration = Duration::from_millis(1);

/// A connection to a compositor that has a seat and lets programs be keyboards.
pub struct CompositorConnection {
    connection: Connection,
    queue: EventQueue<Heard>,
    globals: GlobalList,
    heard: Heard,
    seat: WlSeat,
    keyboards: ZwpVirtualKeyboardManagerV1,
    failure: Option<String>,
}

/// What the compositor has said.
#[derive(Default)]
struct Heard {
    has_keyboard: bool,
    keymap: Option<(File, u32)>,
}

impl CompositorConnection {
    /// Connects to the compositor with this name, as `WAYLAND_DISPLAY` has it: a file in the runtime folder of
    /// the user, or anywhere.
    pub fn open(name: &OsStr) -> Result<Self, String> {
        let folder = env::var_os("XDG_RUNTIME_DIR").map(PathBuf::from);
        let socket = folder.unwrap_or_default().join(name);
        let silent = |error: &dyn std::fmt::Display| {
            advice::no_compositor(&socket, &error.to_string()).to_string()
        };
        let stream = UnixStream::connect(&socket).map_err(|error| silent(&error))?;
        let connection = Connection::from_socket(stream).map_err(|error| silent(&error))?;
        let (globals, queue) =
            registry_queue_init::<Heard>(&connection).map_err(|error| silent(&error))?;
        let handle = queue.handle();
        let seat = globals.bind(&handle, 1..=3, ());
        let keyboards = globals.bind(&handle, 1..=1, ());
        let keyboards = keyboards.map_err(|_| advice::no_virtual_keyboard(None).to_string())?;
        Ok(Self {
            seat: seat.map_err(|_| silent(&"it has no seat"))?,
            keyboards,
            connection,
            queue,
            globals,
            heard: Heard::default(),
            failure: None,
        })
    }

    /// The keymap of the seat: a file and its size; `None` when the seat has no keyboard.
    pub fn seat_keymap(&mut self) -> Result<Option<(File, u32)>, String> {
        self.wait_until_taken()?;
        if !self.heard.has_keyboard {
            return Ok(None);
        }
        let keyboard = self.seat.get_keyboard(&self.queue.handle(), ());
        self.wait_until_taken()?;
        // Nobody would read what else it has to say.
        if keyboard.version() >= 3 {
            keyboard.release();
        }
        Ok(self.heard.keymap.take())
    }

    /// A new keyboard at the seat. It needs a keymap before its first key.
    pub fn make_keyboard(&self) -> Result<ZwpVirtualKeyboardV1, String> {
        let handle = self.queue.handle();
        Ok(self
            .keyboards
            .create_virtual_keyboard(&self.seat, &handle, ()))
    }

    /// A new pointer at the seat; `None` where the compositor has none, unless it `is_needed`.
    pub fn make_pointer(&self, is_needed: bool) -> Result<Option<ZwlrVirtualPointerV1>, String> {
        let handle = self.queue.handle();
        let pointers: Result<ZwlrVirtualPointerManagerV1, _> =
            self.globals.bind(&handle, 1..=1, ());
        match pointers {
            Ok(pointers) => {
                let pointer = pointers.create_virtual_pointer(Some(&self.seat), &handle, ());
                Ok(Some(pointer))
            }
            Err(_) if is_needed => Err(no_pointer()),
            Err(_) => Ok(None),
        }
    }

    /// A second handle of the connection.
    pub fn handle(&self) -> io::Result<OwnedFd> {
        self.connection.backend().poll_fd().try_clone_to_owned()
    }

    /// Sends all messages and waits until the compositor has followed them.
    pub fn wait_until_taken(&mut self) -> Result<(), String> {
        self.deliver()?;
        let answer = self.queue.roundtrip(&mut self.heard);
        answer.map(drop).map_err(|error| self.fail(&error))
    }

    /// Reads what the compositor has said, if anything, so that it never waits for a reader.
    pub fn listen(&mut self) -> Result<(), String> {
        if let Some(failure) = &self.failure {
            return Err(failure.clone());
        }
        let read = match self.queue.prepare_read() {
            Some(reader) => reader.read(),
            None => Ok(0),
        };
        match read {
            Err(WaylandError::Io(error)) if error.kind() == ErrorKind::WouldBlock => {}
            Err(error) => return Err(self.fail(&error)),
            Ok(_) => {}
        }
        let dispatched = self.queue.dispatch_pending(&mut self.heard);
        dispatched.map(drop).map_err(|error| self.fail(&error))
    }

    /// Sends all messages; waits while the compositor has no room for them.
    pub fn deliver(&mut self) -> Result<(), String> {
        if let Some(failure) = &self.failure {
            return Err(failure.clone());
        }
        let start = Instant::now();
        loop {
            match self.connection.flush() {
                Ok(()) => return Ok(()),
                Err(WaylandError::Io(error)) if error.kind() == ErrorKind::WouldBlock => {
                    if start.elapsed() > PATIENCE {
                        return Err(self.fail(&"it reads nothing"));
                    }
                    thread::sleep(PAUSE);
                }
                Err(error) => return Err(self.fail(&error)),
            }
        }
    }

    fn fail(&mut self, reason: &dyn std::fmt::Display) -> String {
        let text = format!("the compositor does not go on: {reason}");
        self.failure.insert(text).clone()
    }
}

/// There is no pointer, and something needs one.
pub fn no_pointer() -> String {
    advice::no_virtual_pointer(None).to_string()
}

impl Dispatch<WlRegistry, GlobalListContents> for Heard {
    fn event(
        _: &mut Self,
        _: &WlRegistry,
        _: wl_registry::Event,
        _: &GlobalListContents,
        _: &Connection,
        _: &QueueHandle<Self>,
    ) {
    }
}

impl Dispatch<WlSeat, ()> for Heard {
    fn event(
        heard: &mut Self,
        _: &WlSeat,
        event: wl_seat::Event,
        _: &(),
        _: &Connection,
        _: &QueueHandle<Self>,
    ) {
        if let wl_seat::Event::Capabilities {
            capabilities: WEnum::Value(capabilities),
        } = event
        {
            heard.has_keyboard = capabilities.contains(Capability::Keyboard);
        }
    }
}

impl Dispatch<WlKeyboard, ()> for Heard {
    fn event(
        heard: &mut Self,
        _: &WlKeyboard,
        event: wl_keyboard::Event,
        _: &(),
        _: &Connection,
        _: &QueueHandle<Self>,
    ) {
        if let wl_keyboard::Event::Keymap {
            format: WEnum::Value(KeymapFormat::XkbV1),
            fd,
            size,
        } = event
        {
            heard.keymap = Some((File::from(fd), size));
        }
    }
}

delegate_noop!(Heard: ignore ZwpVirtualKeyboardManagerV1);
delegate_noop!(Heard: ignore ZwpVirtualKeyboardV1);
delegate_noop!(Heard: ignore ZwlrVirtualPointerManagerV1);
delegate_noop!(Heard: ignore ZwlrVirtualPointerV1);
