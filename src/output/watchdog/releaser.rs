//! What a guardian lets go of keys with.

use std::fs::File;
use std::io::{self, Write};
use std::time::Instant;

use enigo::Direction;

use super::super::pending_motion::StatelessAction;
use super::super::platform;
use super::super::uinput::{UinputNode, center_axes, release_key};
use super::super::worker::Injector;
use super::{ReleaseTarget, stuck_keys};
use crate::device::{KeyCode, KeyKind};

/// Lets go of keys, and of nothing else: whatever it is told, it presses none.
pub struct KeyReleaser {
    ways: Ways,
    start: Instant,
}

enum Ways {
    Display(Box<dyn Injector>),
    Keyboard(File, u32, Box<dyn Injector>),
    Devices(Vec<(UinputNode, bool)>),
}

impl KeyReleaser {
    /// With these means, which stay usable for others.
    pub fn connect(means: &ReleaseTarget) -> Result<Self, String> {
        // It presses nothing, so it makes do without a pointer where the program does.
        let display = || platform::open(None, false);
        let failed = |error: io::Error| error.to_string();
        let ways = match means {
            ReleaseTarget::Display => Ways::Display(display()?),
            ReleaseTarget::WaylandKeyboard(connection, number) => {
                let connection = connection.try_clone().map_err(failed)?;
                Ways::Keyboard(connection.into(), *number, display()?)
            }
            ReleaseTarget::Devices(devices) => {
                let nodes = devices.iter().map(|device| {
                    let node = UinputNode::from_fd(device.node.try_clone()?);
                    Ok((node, device.has_axes))
                });
                Ways::Devices(nodes.collect::<io::Result<_>>().map_err(failed)?)
            }
        };
        Ok(Self {
            ways,
            start: Instant::now(),
        })
    }

    /// Lets go of the keys of a character that was being written. A compositor takes both ends of such a key at once,
    /// and devices write none.
    pub fn release_stuck_keys(&self) -> Result<(), String> {
        match self.ways {
            Ways::Display(_) => stuck_keys::release_stuck_keys(),
            Ways::Keyboard(..) | Ways::Devices(_) => Ok(()),
        }
    }

    /// Brings the axes of devices back to their rest.
    pub fn center_axes(&mut self) {
        if let Ways::Devices(nodes) = &mut self.ways {
            for (node, _) in nodes.iter_mut().filter(|(_, has_axes)| *has_axes) {
                // Of a device that does not take it there is nothing else to try.
                let _ = center_axes(node);
            }
        }
    }
}

impl Injector for KeyReleaser {
    fn inject(&mut self, key: KeyCode, _: Direction) -> Result<(), String> {
        let failed = |error: io::Error| error.to_string();
        match &mut self.ways {
            Ways::Keyboard(connection, number, _) if key.kind() == KeyKind::Keyboard => {
                let time = self.start.elapsed().as_millis() as u32;
                let request = release(*number, time, key);
                connection.write_all(&request).map_err(failed)
            }
            Ways::Display(display) | Ways::Keyboard(_, _, display) => {
                display.inject(key, Direction::Release)
            }
            // The kernel ignores a key that is not down on a device.
            Ways::Devices(nodes) => {
                let released = nodes.iter_mut().map(|(node, _)| release_key(node, key));
                released.fold(Ok(()), Result::and).map_err(failed)
            }
        }
    }

    fn perform(&mut self, _: StatelessAction) -> Result<(), String> {
        Err("a guardian only lets go".into())
    }
}

/// The requests that let go of a key of the virtual keyboard with this number, as the compositor reads them: number,
/// length and request, arguments (`zwp_virtual_keyboard_v1`: `key` is request 1, `modifiers` request 2). A keyboard
/// itself knows what its keys are good for, so the modifiers come up beside the key.
fn release(keyboard: u32, time: u32, key: KeyCode) -> Vec<u8> {
    let request = |number: u32, arguments: &[u32]| {
        let length = 8 + 4 * arguments.len() as u32;
        let words = [keyboard, length << 16 | number];
        let words = words.iter().chain(arguments);
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
    use crate::output::watchdog::target::DeviceHandle;
    use std::io::Read;
    use std::os::fd::OwnedFd;

    fn words(bytes: &[u8]) -> Vec<u32> {
        let word = |word: &[u8; 4]| u32::from_ne_bytes(*word);
        bytes.as_chunks().0.iter().map(word).collect()
    }

    #[test]
    fn a_key_of_a_compositor_comes_up_and_a_modifier_stops_to_count() {
        let a = release(7, 40, key("A"));
        assert_eq!(words(&a), [7, 20 << 16 | 1, 40, 30, 0]);
        let shift = release(7, 41, key("ShiftLeft"));
        let modifiers = [7, 24 << 16 | 2, 0, 0, 0, 0];
        let expected = [&[7, 20 << 16 | 1, 41, 42, 0], &modifiers[..]].concat();
        assert_eq!(words(&shift), expected);
    }

    #[test]
    fn devices_are_told_to_let_go_and_only_axes_that_rest_are_centred() {
        let (mut keyboard, node) = std::io::pipe().unwrap();
        let (mut gamepad, other) = std::io::pipe().unwrap();
        let device = |node, has_axes| DeviceHandle {
            node: OwnedFd::from(node),
            has_axes,
        };
        let means = ReleaseTarget::Devices(vec![device(node, false), device(other, true)]);
        let mut hands = KeyReleaser::connect(&means).unwrap();
        drop(means);
        hands.inject(key("A"), Direction::Press).unwrap();
        hands.center_axes();
        drop(hands);
        let told = |pipe: &mut std::io::PipeReader| {
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
        let up = [(1, 30, 0), (0, 0, 0)];
        assert_eq!(told(&mut keyboard), up);
        let of_gamepad = told(&mut gamepad);
        assert_eq!(of_gamepad[..2], up);
        assert!(of_gamepad[2..].contains(&(3, 0, 0)), "{of_gamepad:?}");
        assert!(
            of_gamepad.iter().all(|event| event.2 == 0),
            "{of_gamepad:?}"
        );
    }
}
