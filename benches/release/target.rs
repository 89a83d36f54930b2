//! The keyboards on which release times are measured.

use std::cell::RefCell;
use std::fs;
use std::process::Command;
use std::thread;
use std::time::Duration;

use evdev::{Device, KeyCode};

#[cfg(feature = "wayland")]
use crate::compositor::Compositor;
use crate::support::binary::ademan;
use crate::support::press::x11_code;
use crate::support::program::Program;
use crate::support::x11::XServer;
#[cfg(feature = "wayland")]
use crate::window::Window;

/// Polling interval of observers that cannot be queried.
const POLL_INTERVAL: Duration = Duration::from_micros(200);

/// The receiver of key events, with an observer.
#[allow(clippy::large_enum_variant, reason = "one instance exists")]
pub enum InputTarget {
    /// An X server, queried by another client.
    X11(XServer),
    /// A compositor, and the window that has the focus.
    #[cfg(feature = "wayland")]
    Wayland(Compositor, RefCell<Option<Window>>),
    /// The kernel, and the device that the program has created.
    Kernel(RefCell<Option<Device>>),
}

impl InputTarget {
    /// Opens the target of this name. Returns `None` with a message if it is not available.
    pub fn open(name: &str) -> Option<Self> {
        match name {
            "x11" => XServer::start().map(Self::X11),
            #[cfg(feature = "wayland")]
            "wayland" => {
                let compositor = Compositor::sway()?;
                Window::open(&compositor)?;
                Some(Self::Wayland(compositor, RefCell::default()))
            }
            "uinput"
                if fs::OpenOptions::new()
                    .write(true)
                    .open("/dev/uinput")
                    .is_ok() =>
            {
                Some(Self::Kernel(RefCell::default()))
            }
            "uinput" => skip("no access to /dev/uinput"),
            _ => skip("built without the feature `wayland`"),
        }
    }

    /// Starts the program with these arguments for this target.
    pub fn run(&self, arguments: &[&str]) -> Program {
        let mut command = ademan(arguments);
        self.configure(&mut command);
        Program::from_command(command)
    }

    /// Sets the environment of a command for this target.
    pub fn configure(&self, command: &mut Command) {
        for variable in ["DISPLAY", "WAYLAND_DISPLAY", "XDG_RUNTIME_DIR"] {
            command.env_remove(variable);
        }
        match self {
            Self::X11(server) => _ = command.env("DISPLAY", server.display()),
            #[cfg(feature = "wayland")]
            Self::Wayland(compositor, _) => {
                command.env("WAYLAND_DISPLAY", compositor.socket());
            }
            Self::Kernel(_) => {}
        }
    }

    /// Returns the name of the output.
    pub fn output(&self) -> &'static str {
        match self {
            Self::Kernel(_) => "uinput",
            _ => "desktop",
        }
    }

    /// Observes the keyboard of the program that was started last.
    pub fn observe(&self) {
        match self {
            Self::X11(_) => {}
            #[cfg(feature = "wayland")]
            Self::Wayland(compositor, window) => {
                window.replace(None);
                window.replace(Window::open(compositor));
            }
            Self::Kernel(device) => _ = device.replace(Some(find_keyboard())),
        }
    }

    /// Returns `true` if H, and no other key, is pressed.
    pub fn is_pressed(&self) -> bool {
        match self {
            Self::X11(server) => server.pressed_keys() == [x11_code("H")],
            #[cfg(feature = "wayland")]
            Self::Wayland(_, window) => events(window).last().is_some_and(|line| line == "down h"),
            Self::Kernel(device) => keys(device) == [KeyCode::KEY_H],
        }
    }

    /// Returns `true` if no key is pressed after H was.
    pub fn is_released(&self) -> bool {
        match self {
            Self::X11(server) => server.pressed_keys().is_empty(),
            #[cfg(feature = "wayland")]
            Self::Wayland(_, window) => {
                thread::sleep(POLL_INTERVAL);
                events(window).iter().any(|line| line == "up h")
            }
            Self::Kernel(device) => {
                thread::sleep(POLL_INTERVAL);
                keys(device).is_empty()
            }
        }
    }
}

fn skip(why: &str) -> Option<InputTarget> {
    println!("SKIPPED: {why}");
    None
}

#[cfg(feature = "wayland")]
fn events(window: &RefCell<Option<Window>>) -> Vec<String> {
    let window = window.borrow();
    window.as_ref().expect("an observed keyboard").events()
}

/// Returns the pressed keys of a device; none if it was removed, as the kernel has released them.
fn keys(device: &RefCell<Option<Device>>) -> Vec<KeyCode> {
    let device = device.borrow();
    let state = device
        .as_ref()
        .expect("an observed keyboard")
        .get_key_state();
    state.map_or_else(|_| Vec::new(), |keys| keys.iter().collect())
}

/// Returns the keyboard of the program as soon as there is only one: the keyboard of the previous program may still exist.
fn find_keyboard() -> Device {
    loop {
        let is_own = |(_, device): &(_, Device)| device.name() == Some("Ademan keyboard");
        let mut found: Vec<_> = evdev::enumerate().filter(is_own).collect();
        if found.len() == 1 {
            return found.remove(0).1;
        }
        thread::sleep(POLL_INTERVAL);
    }
}
