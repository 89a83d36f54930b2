//! The injector of the watchdog, which only releases keys.

use std::fs::File;
use std::io::{self, ErrorKind, Write};
use std::time::Instant;

use rustix::event::{PollFd, PollFlags, poll};

use crate::output::character_key::CharacterKey;
use crate::output::desktop::connect;
use crate::output::desktop::injector::Injector;
use crate::output::desktop::pending_motion::StatelessAction;
use crate::output::uinput::{UinputNode, center_axes, release_key};
use crate::output::watchdog::ReleaseTarget;
use crate::output::watchdog_process::release_thread::Releaser;
use ademan_core::device::pressed_keys::{KeyDirection, PressedKeys};
use ademan_core::device::{KeyCode, KeyKind};

/// An injector that releases keys on a [`ReleaseTarget`] and never presses one.
pub struct KeyReleaser {
    connection: Connection,
    start: Instant,
}

enum Connection {
    Display(Box<dyn Injector>),
    /// The connection to a compositor for keys, the id of its virtual keyboard, and a connection for buttons.
    WaylandKeyboard(File, u32, Box<dyn Injector>),
    /// The devices, and whether each has axes.
    Devices(Vec<(UinputNode, bool)>),
}

impl KeyReleaser {
    /// Connects to a target, duplicating its file descriptors.
    pub fn connect(target: &ReleaseTarget) -> Result<Self, String> {
        // It moves no pointer, so the compositor need not support one.
        let display = || connect(None, false);
        let failed = |error: io::Error| error.to_string();
        let connection = match target {
            ReleaseTarget::Display => Connection::Display(display()?),
            ReleaseTarget::WaylandKeyboard(connection, id) => {
                let connection = connection.try_clone().map_err(failed)?;
                Connection::WaylandKeyboard(connection.into(), *id, display()?)
            }
            ReleaseTarget::Devices(devices) => {
                let nodes = devices.iter().map(|device| {
                    let node = UinputNode::from_fd(device.node.try_clone()?);
                    Ok((node, device.has_axes))
                });
                Connection::Devices(nodes.collect::<io::Result<_>>().map_err(failed)?)
            }
        };
        Ok(Self {
            connection,
            start: Instant::now(),
        })
    }
}

impl Releaser for KeyReleaser {
    fn center_axes(&mut self) {
        if let Connection::Devices(nodes) = &mut self.connection {
            for (node, _) in nodes.iter_mut().filter(|(_, has_axes)| *has_axes) {
                // A device that rejects the events has no other remedy.
                let _ = center_axes(node);
            }
        }
    }
}

impl Injector for KeyReleaser {
    fn inject(&mut self, key: KeyCode, _: KeyDirection) -> Result<(), String> {
        let failed = |error: io::Error| error.to_string();
        match &mut self.connection {
            Connection::WaylandKeyboard(connection, id, _) if key.kind() == KeyKind::Keyboard => {
                let time = self.start.elapsed().as_millis() as u32;
                let requests = release_requests(*id, time, key);
                write_to_nonblocking(connection, &requests).map_err(failed)
            }
            Connection::Display(display) | Connection::WaylandKeyboard(_, _, display) => {
                display.inject(key, KeyDirection::Release)
            }
            // The kernel ignores the release of a key that is not pressed on a device.
            Connection::Devices(nodes) => {
                let released = nodes.iter_mut().map(|(node, _)| release_key(node, key));
                released.fold(Ok(()), Result::and).map_err(failed)
            }
        }
    }

    fn perform(&mut self, _: StatelessAction) -> Result<(), String> {
        Err("the watchdog only releases keys".into())
    }

    fn remove_character_keys(&mut self, keys: &[CharacterKey]) -> Result<(), String> {
        match &mut self.connection {
            Connection::Display(display) => display.remove_character_keys(keys),
            Connection::WaylandKeyboard(..) | Connection::Devices(_) => Ok(()),
        }
    }

    fn query_pressed(&mut self, keys: &PressedKeys) -> Result<Option<PressedKeys>, String> {
        match &mut self.connection {
            Connection::Display(display) => display.query_pressed(keys),
            // Releases follow the presses of the client on the same connection or device.
            Connection::WaylandKeyboard(..) | Connection::Devices(_) => Ok(None),
        }
    }
}

/// Writes to a connection that the client made non-blocking, and waits while a compositor that hangs does not read.
fn write_to_nonblocking(connection: &mut File, mut bytes: &[u8]) -> io::Result<()> {
    while !bytes.is_empty() {
        match connection.write(bytes) {
            Ok(written) => bytes = &bytes[written..],
            Err(error) if error.kind() == ErrorKind::WouldBlock => {
                poll(&mut [PollFd::new(connection, PollFlags::OUT)], None)?;
            }
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}

/// Returns the Wayland requests that release a key of the virtual keyboard with this object id: id, length and opcode,
/// then arguments (`zwp_virtual_keyboard_v1`: `key` has opcode 1, `modifiers` opcode 2). The client of a virtual
/// keyboard computes the modifier state, so the release of a modifier clears it.
fn release_requests(keyboard: u32, time: u32, key: KeyCode) -> Vec<u8> {
    let request = |opcode: u32, arguments: &[u32]| {
        let length = 8 + 4 * arguments.len() as u32;
        let header = [keyboard, length << 16 | opcode];
        let words = header.iter().chain(arguments);
        words
            .flat_map(|word| word.to_ne_bytes())
            .collect::<Vec<_>>()
    };
    let mut requests = request(1, &[time, key.event_code().into(), 0]);
    if key.is_modifier() {
        requests.extend(request(2, &[0; 4]));
    }
    requests
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::tests::key;
    use crate::output::watchdog::DeviceHandle;
    use std::io::Read;
    use std::os::fd::OwnedFd;

    fn words(bytes: &[u8]) -> Vec<u32> {
        let word = |word: &[u8; 4]| u32::from_ne_bytes(*word);
        bytes.as_chunks().0.iter().map(word).collect()
    }

    #[test]
    fn the_release_of_a_modifier_clears_the_modifier_state() {
        let a = release_requests(7, 40, key("A"));
        assert_eq!(words(&a), [7, 20 << 16 | 1, 40, 30, 0]);
        let shift = release_requests(7, 41, key("ShiftLeft"));
        let modifiers = [7, 24 << 16 | 2, 0, 0, 0, 0];
        let expected = [&[7, 20 << 16 | 1, 41, 42, 0], &modifiers[..]].concat();
        assert_eq!(words(&shift), expected);
    }

    #[test]
    fn keys_are_released_on_every_device_and_axes_centered_on_those_that_have_axes() {
        let (mut keyboard, node) = std::io::pipe().unwrap();
        let (mut gamepad, other) = std::io::pipe().unwrap();
        let device = |end, has_axes| DeviceHandle {
            node: OwnedFd::from(end),
            has_axes,
        };
        let target = ReleaseTarget::Devices(vec![device(node, false), device(other, true)]);
        let mut releaser = KeyReleaser::connect(&target).unwrap();
        drop(target);
        releaser.inject(key("A"), KeyDirection::Press).unwrap();
        releaser.center_axes();
        drop(releaser);
        let events = |pipe: &mut std::io::PipeReader| {
            let mut bytes = Vec::new();
            pipe.read_to_end(&mut bytes).unwrap();
            let size = size_of::<evdev::InputEvent>();
            let event = |event: &[u8]| {
                let rest = &event[size - 8..];
                let short = |at: usize| u16::from_ne_bytes([rest[at], rest[at + 1]]);
                let value = i32::from_ne_bytes(rest[4..].try_into().unwrap());
                (short(0), short(2), value)
            };
            bytes.chunks(size).map(event).collect::<Vec<_>>()
        };
        let release = [(1, 30, 0), (0, 0, 0)];
        assert_eq!(events(&mut keyboard), release);
        let gamepad_events = events(&mut gamepad);
        assert_eq!(gamepad_events[..2], release);
        assert!(
            gamepad_events[2..].contains(&(3, 0, 0)),
            "{gamepad_events:?}"
        );
        assert!(
            gamepad_events.iter().all(|event| event.2 == 0),
            "{gamepad_events:?}"
        );
    }
}
