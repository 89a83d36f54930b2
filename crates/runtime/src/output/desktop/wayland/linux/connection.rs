//! The connection to the compositor: its globals, and reading and writing.

use std::env;
use std::ffi::OsStr;
use std::fs::File;
use std::io::{self, ErrorKind};
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
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

/// Longest time for which a compositor may not read before the connection counts as lost.
const WRITE_TIMEOUT: Duration = Duration::from_secs(5);

/// Delay before another attempt to write.
const WRITE_RETRY_DELAY: Duration = Duration::from_millis(1);

/// A connection to a compositor that has a seat and supports virtual keyboards.
pub struct CompositorConnection {
    connection: Connection,
    queue: EventQueue<SeatState>,
    globals: GlobalList,
    seat_state: SeatState,
    seat: WlSeat,
    keyboards: ZwpVirtualKeyboardManagerV1,
    failure: Option<String>,
}

/// The state of the seat, as received from the compositor.
#[derive(Default)]
struct SeatState {
    has_keyboard: bool,
    /// The file and its size in bytes.
    keymap: Option<(File, u32)>,
}

impl CompositorConnection {
    /// Connects to the compositor of this name, which has the form of `WAYLAND_DISPLAY`: a file in the runtime folder
    /// of the user, or an absolute path.
    pub fn open(name: &OsStr) -> Result<Self, String> {
        let socket = socket(name);
        let no_answer = |error: &dyn std::fmt::Display| no_answer(&socket, error);
        let stream = UnixStream::connect(&socket).map_err(|error| no_answer(&error))?;
        let connection = Connection::from_socket(stream).map_err(|error| no_answer(&error))?;
        let (globals, queue) =
            registry_queue_init::<SeatState>(&connection).map_err(|error| no_answer(&error))?;
        let handle = queue.handle();
        let seat = globals.bind(&handle, 1..=3, ());
        let keyboards = globals.bind(&handle, 1..=1, ());
        let keyboards = keyboards.map_err(|_| advice::no_virtual_keyboard(None).to_string())?;
        Ok(Self {
            seat: seat.map_err(|_| no_answer(&"it has no seat"))?,
            keyboards,
            connection,
            queue,
            globals,
            seat_state: SeatState::default(),
            failure: None,
        })
    }

    /// Returns the keymap of the seat as a file and its size in bytes, or `None` if the seat has no keyboard.
    pub fn seat_keymap(&mut self) -> Result<Option<(File, u32)>, String> {
        self.roundtrip()?;
        if !self.seat_state.has_keyboard {
            return Ok(None);
        }
        let keyboard = self.seat.get_keyboard(&self.queue.handle(), ());
        self.roundtrip()?;
        // Later events have the keymap of the keyboard that was used last, which may be a virtual one of this or another program.
        if keyboard.version() >= 3 {
            keyboard.release();
        }
        Ok(self.seat_state.keymap.take())
    }

    /// Creates a virtual keyboard, which needs a keymap before its first key.
    pub fn create_keyboard(&self) -> ZwpVirtualKeyboardV1 {
        let handle = self.queue.handle();
        self.keyboards
            .create_virtual_keyboard(&self.seat, &handle, ())
    }

    /// Creates a virtual pointer. Returns `None` if the compositor does not support it, or an error if it
    /// `is_required`.
    pub fn create_pointer(
        &self,
        is_required: bool,
    ) -> Result<Option<ZwlrVirtualPointerV1>, String> {
        let handle = self.queue.handle();
        let pointers: Result<ZwlrVirtualPointerManagerV1, _> =
            self.globals.bind(&handle, 1..=1, ());
        match pointers {
            Ok(pointers) => {
                let pointer = pointers.create_virtual_pointer(Some(&self.seat), &handle, ());
                Ok(Some(pointer))
            }
            Err(_) if is_required => Err(no_pointer()),
            Err(_) => Ok(None),
        }
    }

    /// Duplicates the file descriptor of the connection.
    pub fn try_clone_fd(&self) -> io::Result<OwnedFd> {
        self.connection.backend().poll_fd().try_clone_to_owned()
    }

    /// Sends all requests and blocks until the compositor has processed them.
    pub fn roundtrip(&mut self) -> Result<(), String> {
        self.flush()?;
        let result = self.queue.roundtrip(&mut self.seat_state);
        result.map(drop).map_err(|error| self.fail(&error))
    }

    /// Reads pending events, so that the compositor never blocks on a full socket.
    pub fn dispatch(&mut self) -> Result<(), String> {
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
        let dispatched = self.queue.dispatch_pending(&mut self.seat_state);
        dispatched.map(drop).map_err(|error| self.fail(&error))
    }

    /// Sends all requests. Blocks while the socket is full, at most 5 s.
    pub fn flush(&mut self) -> Result<(), String> {
        if let Some(failure) = &self.failure {
            return Err(failure.clone());
        }
        let start = Instant::now();
        loop {
            match self.connection.flush() {
                Ok(()) => return Ok(()),
                Err(WaylandError::Io(error)) if error.kind() == ErrorKind::WouldBlock => {
                    if start.elapsed() > WRITE_TIMEOUT {
                        return Err(self.fail(&"it does not read"));
                    }
                    thread::sleep(WRITE_RETRY_DELAY);
                }
                Err(error) => return Err(self.fail(&error)),
            }
        }
    }

    fn fail(&mut self, reason: &dyn std::fmt::Display) -> String {
        let text = format!("the connection to the compositor failed: {reason}");
        self.failure.insert(text).clone()
    }
}

/// Returns the path of the socket of a compositor from its name.
pub fn socket(name: &OsStr) -> PathBuf {
    let folder = env::var_os("XDG_RUNTIME_DIR").map(PathBuf::from);
    folder.unwrap_or_default().join(name)
}

/// Returns the message for a compositor that does not answer at this socket.
pub fn no_answer(socket: &Path, error: &dyn std::fmt::Display) -> String {
    advice::no_compositor(socket, &error.to_string()).to_string()
}

/// Returns the message for a compositor without virtual pointers.
pub fn no_pointer() -> String {
    advice::no_virtual_pointer(None).to_string()
}

impl Dispatch<WlRegistry, GlobalListContents> for SeatState {
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

impl Dispatch<WlSeat, ()> for SeatState {
    fn event(
        state: &mut Self,
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
            state.has_keyboard = capabilities.contains(Capability::Keyboard);
        }
    }
}

impl Dispatch<WlKeyboard, ()> for SeatState {
    fn event(
        state: &mut Self,
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
            state.keymap = Some((File::from(fd), size));
        }
    }
}

delegate_noop!(SeatState: ignore ZwpVirtualKeyboardManagerV1);
delegate_noop!(SeatState: ignore ZwpVirtualKeyboardV1);
delegate_noop!(SeatState: ignore ZwlrVirtualPointerManagerV1);
delegate_noop!(SeatState: ignore ZwlrVirtualPointerV1);
