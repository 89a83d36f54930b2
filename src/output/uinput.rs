//! A keyboard device made by the Linux kernel's `uinput` module.
//!
//! What the program presses goes through the kernel like the keys of any keyboard: X11, Wayland and
//! the console take it alike. When the program ends in any way, even killed, the kernel removes the
//! device and lets go of its keys (`uinput_destroy_device`, `input_dev_release_keys`).

use std::collections::BTreeSet;
use std::io;
use std::thread;

use arrayvec::ArrayVec;
use evdev::uinput::VirtualDevice;
use evdev::{AttributeSet, EventType, InputEvent};

use super::held::Held;
use super::{OutputError, RETRIES, RETRY_PAUSE, Sink};
use crate::device::{Action, KeyCode, OutputEvent};

const OUTPUT: &str = "uinput";

/// The longest name of a device, in bytes: `UINPUT_MAX_NAME_SIZE` less what ends it.
const NAME_LIMIT: usize = 78;

/// Device not configured and no such device: what opening the node gives when nothing is behind it.
const NOTHING_BEHIND_NODE: [i32; 2] = [6, 19];

/// The events of one frame as the kernel takes them: every key at most once down and once up.
type Frame = ArrayVec<InputEvent, { 2 * Held::CAPACITY }>;

/// Takes frames of events; the kernel's device, or a stand-in for it.
pub trait Node: Send {
    /// Delivers the events of one frame and what ends a frame.
    fn emit(&mut self, events: &[InputEvent]) -> io::Result<()>;
}

impl Node for VirtualDevice {
    fn emit(&mut self, events: &[InputEvent]) -> io::Result<()> {
        VirtualDevice::emit(self, events)
    }
}

/// An output that is a keyboard of its own, with just the keys of a layout.
///
/// It does not repeat keys: whoever receives them does.
pub struct Uinput<N: Node = VirtualDevice> {
    node: N,
    declared: AttributeSet<evdev::KeyCode>,
    held: Held,
    refused: u64,
}

impl Uinput {
    /// Makes a keyboard called `name` (at most 78 bytes) that has the keys `codes` and no others.
    pub fn open(name: &str, codes: &BTreeSet<KeyCode>) -> Result<Self, OutputError> {
        let refuse = |reason: String| OutputError::Open {
            output: OUTPUT.into(),
            reason,
        };
        if name.is_empty() || name.len() > NAME_LIMIT || name.contains('\0') {
            return Err(refuse(format!(
                "`{name}` does not do as the name of a device: give 1 to {NAME_LIMIT} bytes"
            )));
        }
        let declared = declared(codes);
        let node = VirtualDevice::builder()
            .and_then(|builder| builder.name(name).with_keys(&declared)?.build())
            .map_err(|error| refuse(open_reason(&error)))?;
        Ok(Self::on(node, declared))
    }
}

impl<N: Node> Uinput<N> {
    fn on(node: N, declared: AttributeSet<evdev::KeyCode>) -> Self {
        Self {
            node,
            declared,
            held: Held::default(),
            refused: 0,
        }
    }

    /// Delivers a frame; when that fails, what may still be down stays in the account.
    fn deliver(&mut self, frame: &Frame, before: &Held) -> Result<(), OutputError> {
        if frame.is_empty() {
            return Ok(());
        }
        let mut outcome = self.node.emit(frame);
        for _ in 0..RETRIES {
            if outcome.is_ok() {
                break;
            }
            thread::sleep(RETRY_PAUSE);
            outcome = self.node.emit(frame);
        }
        outcome.map_err(|error| {
            for key in before.release_order() {
                self.held.press(key);
            }
            OutputError::Send {
                output: OUTPUT.into(),
                reason: error.to_string(),
            }
        })
    }
}

impl<N: Node> Sink for Uinput<N> {
    fn send(&mut self, events: &[OutputEvent]) -> Result<(), OutputError> {
        let before = self.held.clone();
        let mut frame = Frame::new();
        for event in events {
            if let Action::KeyDown(key) = event.action
                && !self.declared.contains(kernel_code(key))
            {
                self.refused += 1;
                continue;
            }
            // Fewer events than places: a frame of a device has at most 64.
            if let Some(event) = translate(event.action, &mut self.held)
                && frame.try_push(event).is_err()
            {
                break;
            }
        }
        self.deliver(&frame, &before)
    }

    fn close(&mut self) -> Result<(), OutputError> {
        let before = self.held.clone();
        let frame: Frame = before
            .release_order()
            .filter_map(|key| translate(Action::KeyUp(key), &mut self.held))
            .collect();
        self.deliver(&frame, &before)
    }

    fn refused_presses(&self) -> u64 {
        self.refused
    }
}

impl<N: Node> Drop for Uinput<N> {
    fn drop(&mut self) {
        let _ = self.close();
    }
}

/// The keys that the device is to have.
fn declared(codes: &BTreeSet<KeyCode>) -> AttributeSet<evdev::KeyCode> {
    codes.iter().map(|&key| kernel_code(key)).collect()
}

fn kernel_code(key: KeyCode) -> evdev::KeyCode {
    evdev::KeyCode(key.event_code())
}

/// What the kernel is told of an action; `None` when it changes nothing about what is down.
fn translate(action: Action, held: &mut Held) -> Option<InputEvent> {
    let (key, value) = match action {
        Action::KeyDown(key) => held.press(key).then_some((key, 1))?,
        Action::KeyUp(key) => held.release(key).then_some((key, 0))?,
        _ => return None,
    };
    Some(InputEvent::new(EventType::KEY.0, key.event_code(), value))
}

/// Why the node cannot be opened and what to do about it.
fn open_reason(error: &io::Error) -> String {
    let absent = error
        .raw_os_error()
        .is_some_and(|code| NOTHING_BEHIND_NODE.contains(&code));
    if absent || error.kind() == io::ErrorKind::NotFound {
        return "/dev/uinput is not there; load the kernel module: `sudo modprobe uinput` \
                (at every start: put `uinput` into /etc/modules-load.d/uinput.conf)"
            .into();
    }
    if error.kind() == io::ErrorKind::PermissionDenied {
        return "no permission to use /dev/uinput; give it to a group of its own: \
                `sudo groupadd --system uinput`, `sudo usermod --append --groups uinput $USER`, put the line \
                `KERNEL==\"uinput\", GROUP=\"uinput\", MODE=\"0660\", OPTIONS+=\"static_node=uinput\"` \
                into /etc/udev/rules.d/60-uinput.rules, and start the machine anew"
            .into();
    }
    format!("/dev/uinput: {error}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::TargetId;
    use crate::output::tests::{down, key, up};
    use std::sync::{Arc, Mutex};

    /// Keeps what it is given, after failing as often as it is told to.
    #[derive(Clone, Default)]
    struct Desk(Arc<Mutex<(usize, Vec<String>)>>);

    impl Desk {
        fn failing(times: usize) -> Self {
            Self(Arc::new(Mutex::new((times, Vec::new()))))
        }

        fn frames(&self) -> Vec<String> {
            self.0.lock().unwrap().1.clone()
        }

        fn keyboard(&self, codes: &[&str]) -> Uinput<Self> {
            let codes = codes.iter().map(|name| key(name)).collect();
            Uinput::on(self.clone(), declared(&codes))
        }
    }

    impl Node for Desk {
        fn emit(&mut self, events: &[InputEvent]) -> io::Result<()> {
            let (failures, frames) = &mut *self.0.lock().unwrap();
            if *failures > 0 {
                *failures -= 1;
                return Err(io::ErrorKind::WouldBlock.into());
            }
            let of_event = |event: &InputEvent| format!("{}={}", event.code(), event.value());
            frames.push(events.iter().map(of_event).collect::<Vec<_>>().join(" "));
            Ok(())
        }
    }

    #[test]
    fn only_the_keys_of_the_layout_are_declared() {
        let codes = declared(&BTreeSet::from([key("Q"), key("ArrowUp")]));
        let codes: Vec<_> = codes.iter().map(|code| code.0).collect();
        assert_eq!(codes, [16, 103]);
    }

    #[test]
    fn a_frame_goes_out_as_one_and_a_key_that_is_not_declared_does_not() {
        let desk = Desk::default();
        let mut keyboard = desk.keyboard(&["ShiftLeft", "A"]);
        keyboard
            .send(&[down(1, "ShiftLeft"), down(1, "A"), down(1, "MetaLeft")])
            .unwrap();
        keyboard.send(&[up(2, "MetaLeft")]).unwrap();
        keyboard.send(&[up(3, "A")]).unwrap();
        assert_eq!(desk.frames(), ["42=1 30=1", "30=0"]);
        assert_eq!(keyboard.refused_presses(), 1);
    }

    #[test]
    fn a_depth_is_nothing_to_a_keyboard() {
        let mut held = Held::default();
        assert_eq!(
            translate(Action::Depth(TargetId(1), 0.5), &mut held).map(|event| event.code()),
            None
        );
    }

    #[test]
    fn closing_and_dropping_let_go_with_modifiers_last() {
        let desk = Desk::default();
        let mut keyboard = desk.keyboard(&["ShiftLeft", "A", "B"]);
        keyboard
            .send(&[down(1, "ShiftLeft"), down(1, "A"), down(1, "B")])
            .unwrap();
        keyboard.close().unwrap();
        keyboard.send(&[down(2, "A")]).unwrap();
        drop(keyboard);
        assert_eq!(
            desk.frames(),
            ["42=1 30=1 48=1", "48=0 30=0 42=0", "30=1", "30=0"]
        );
    }

    #[test]
    fn a_frame_is_tried_four_times_and_a_release_that_failed_is_not_forgotten() {
        let desk = Desk::default();
        let mut keyboard = desk.keyboard(&["A"]);
        desk.0.lock().unwrap().0 = 3;
        keyboard.send(&[down(1, "A")]).unwrap();
        desk.0.lock().unwrap().0 = 4;
        let error = keyboard.send(&[up(2, "A")]).unwrap_err();
        assert!(error.to_string().starts_with("the output `uinput` failed"));
        keyboard.close().unwrap();
        assert_eq!(desk.frames(), ["30=1", "30=0"]);
    }

    #[test]
    fn a_press_that_failed_is_let_go_of_because_nobody_knows_whether_it_arrived() {
        let desk = Desk::failing(4);
        let mut keyboard = desk.keyboard(&["A"]);
        keyboard.send(&[down(1, "A")]).unwrap_err();
        keyboard.close().unwrap();
        assert_eq!(desk.frames(), ["30=0"]);
    }

    #[test]
    fn an_error_at_opening_says_what_to_do() {
        let reason = |kind: io::ErrorKind| open_reason(&kind.into());
        assert!(reason(io::ErrorKind::NotFound).contains("modprobe uinput"));
        assert!(open_reason(&io::Error::from_raw_os_error(19)).contains("modprobe uinput"));
        let denied = reason(io::ErrorKind::PermissionDenied);
        assert!(denied.contains("KERNEL==\"uinput\", GROUP=\"uinput\""));
        assert!(!denied.contains("as root"));
        assert_eq!(reason(io::ErrorKind::TimedOut), "/dev/uinput: timed out");
    }

    #[test]
    fn a_name_that_is_too_long_is_refused() {
        let error = Uinput::open(&"k".repeat(79), &BTreeSet::new())
            .err()
            .unwrap();
        assert!(error.to_string().contains("1 to 78 bytes"), "{error}");
    }

    #[test]
    fn the_kernel_takes_the_device_where_there_is_one() {
        let node = std::fs::OpenOptions::new().write(true).open("/dev/uinput");
        if let Err(error) = node {
            println!("SKIPPED: /dev/uinput cannot be written here: {error}");
            return;
        }
        let mut keyboard = Uinput::open("Ademan test", &BTreeSet::from([key("F12")])).unwrap();
        keyboard.send(&[down(1, "F12"), up(2, "F12")]).unwrap();
        keyboard.close().unwrap();
    }
}
