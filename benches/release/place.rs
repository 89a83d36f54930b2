//! Where keys go down, and who watches them there.

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

/// How long to wait before somebody who cannot be asked is looked at again.
const PAUSE: Duration = Duration::from_micros(200);

/// Keyboards of a system, seen from outside.
#[allow(clippy::large_enum_variant, reason = "there is just one")]
pub enum Place {
    /// An X server, asked by another client.
    X11(XServer),
    /// A compositor, and the window that has the focus.
    #[cfg(feature = "wayland")]
    Wayland(Compositor, RefCell<Option<Window>>),
    /// The kernel, and the device that the program has made.
    Kernel(RefCell<Option<Device>>),
}

impl Place {
    /// The place of this name, or says why not and gives `None`.
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
            "uinput" => skip("there is no /dev/uinput for this user"),
            _ => skip("built without it; `--features wayland`"),
        }
    }

    /// The program with these arguments, for an output at this place.
    pub fn run(&self, arguments: &[&str]) -> Program {
        let mut command = ademan(arguments);
        self.show_to(&mut command);
        Program::from_command(command)
    }

    /// Lets a program find this place, and no other.
    pub fn show_to(&self, command: &mut Command) {
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

    /// The name of the output.
    pub fn output(&self) -> &'static str {
        match self {
            Self::Kernel(_) => "uinput",
            _ => "desktop",
        }
    }

    /// From now on the keyboard of the program that has just been started is watched.
    pub fn watch(&self) {
        match self {
            Self::X11(_) => {}
            #[cfg(feature = "wayland")]
            Self::Wayland(compositor, window) => {
                window.replace(None);
                window.replace(Window::open(compositor));
            }
            Self::Kernel(device) => _ = device.replace(Some(the_keyboard())),
        }
    }

    /// Whether H is down, and nothing else.
    pub fn holds(&self) -> bool {
        match self {
            Self::X11(server) => server.pressed_keys() == [x11_code("H")],
            #[cfg(feature = "wayland")]
            Self::Wayland(_, window) => heard(window).last().is_some_and(|line| line == "down h"),
            Self::Kernel(device) => keys(device) == [KeyCode::KEY_H],
        }
    }

    /// Whether nothing is down any more, once H was.
    pub fn is_free(&self) -> bool {
        match self {
            Self::X11(server) => server.pressed_keys().is_empty(),
            #[cfg(feature = "wayland")]
            Self::Wayland(_, window) => {
                thread::sleep(PAUSE);
                heard(window).iter().any(|line| line == "up h")
            }
            Self::Kernel(device) => {
                thread::sleep(PAUSE);
                keys(device).is_empty()
            }
        }
    }
}

fn skip(why: &str) -> Option<Place> {
    println!("SKIPPED: {why}");
    None
}

#[cfg(feature = "wayland")]
fn heard(window: &RefCell<Option<Window>>) -> Vec<String> {
    let window = window.borrow();
    window.as_ref().expect("it is watched").heard()
}

/// The keys that are down on a device; none on one that is gone, as the kernel lets go of them.
fn keys(device: &RefCell<Option<Device>>) -> Vec<KeyCode> {
    let device = device.borrow();
    let state = device.as_ref().expect("it is watched").get_key_state();
    state.map_or_else(|_| Vec::new(), |keys| keys.iter().collect())
}

/// The program's keyboard, once there is just one: that of the last program may be on its way out.
fn the_keyboard() -> Device {
    loop {
        let of_program = |(_, device): &(_, Device)| device.name() == Some("Ademan keyboard");
        let mut found: Vec<_> = evdev::enumerate().filter(of_program).collect();
        if found.len() == 1 {
            return found.remove(0).1;
        }
        thread::sleep(PAUSE);
    }
}
