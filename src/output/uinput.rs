//! Devices made by the Linux kernel's `uinput` module: keyboard, mouse, pointer, gamepad.
//!
//! What the program presses goes through the kernel like the keys of any keyboard: X11, Wayland and
//! the console take it alike. When the program ends in any way, even killed, the kernel removes the
//! devices and lets go of their keys (`uinput_destroy_device`, `input_dev_release_keys`).

mod declared;
mod node;
mod part;

use std::io;

use declared::{Declared, Kind};
pub use node::{KernelNode, Node};
use part::Part;

use super::{OutputError, Reach, Sink};
use crate::access::{self, Denied};
use crate::device::{Action, Need, Needs, OutputEvent};

const OUTPUT: &str = "uinput";

/// The longest name of the devices, in bytes: `UINPUT_MAX_NAME_SIZE` less what ends it and what each
/// adds to it.
const NAME_LIMIT: usize = 78 - " keyboard".len();

/// Device not configured and no such device: what opening the node gives when nothing is behind it.
const NOTHING_BEHIND_NODE: [i32; 2] = [6, 19];

/// An output that is devices of its own, with just what a layout needs.
///
/// Each is made only when it is needed, and gets the events of a frame in one system call. The
/// keyboard does not repeat keys: whoever receives them does.
pub struct Uinput<N: Node = KernelNode> {
    needs: Needs,
    parts: Vec<Part<N>>,
    /// Which of mouse and pointer has moved last, and takes the buttons. Whoever reads two devices may hear of
    /// the button before the place: a click must come from the device that brought the pointer there.
    leading: Kind,
    refused: u64,
}

impl Uinput {
    /// Makes the devices that `needs` ask for; their names are `name` (at most 69 bytes) and what they
    /// are: `Ademan keyboard`, `Ademan mouse`, `Ademan pointer`, `Ademan gamepad`.
    pub fn open(name: &str, needs: &Needs) -> Result<Self, OutputError> {
        let refuse = |reason: String| OutputError::Open {
            output: OUTPUT.into(),
            reason,
        };
        if name.is_empty() || name.len() > NAME_LIMIT || name.contains('\0') {
            return Err(refuse(format!(
                "`{name}` does not do as the name of devices: give 1 to {NAME_LIMIT} bytes"
            )));
        }
        let node = |declared: &Declared| {
            KernelNode::open(&format!("{name} {}", declared.kind.name()), declared)
        };
        Self::on(needs, node).map_err(|error| refuse(open_reason(&error)))
    }
}

impl<N: Node> Uinput<N> {
    /// On nodes that `open` makes.
    fn on(needs: &Needs, open: impl Fn(&Declared) -> io::Result<N>) -> io::Result<Self> {
        let part = |declared: Declared| Ok(Part::new(declared.clone(), open(&declared)?));
        let parts: io::Result<_> = Declared::of(needs).into_iter().map(part).collect();
        Ok(Self {
            needs: needs.clone(),
            parts: parts?,
            leading: Kind::Mouse,
            refused: 0,
        })
    }

    /// Puts an action into the frame of its device; one that is not among the needs is refused.
    fn take(&mut self, action: Action) -> io::Result<()> {
        let need = Need::of(action).filter(|need| self.needs.has(*need));
        let able = |part: &&mut Part<N>| need.is_some_and(|need| part.declared.has(need));
        let mut able = self.parts.iter_mut().filter(able);
        if let Action::KeyUp(_) = action {
            // Those that do not hold it ignore it.
            return able.try_for_each(|part| part.take(action));
        }
        let is_leading = |part: &&mut Part<N>| part.declared.kind == self.leading;
        match able.max_by_key(is_leading) {
            Some(part) => part.take(action),
            None => {
                self.refused += u64::from(matches!(action, Action::KeyDown(_)));
                Ok(())
            }
        }
    }

    /// Notes who moves the pointer in a frame, before anything is pressed there.
    fn note_leading(&mut self, events: &[OutputEvent]) {
        for event in events {
            match event.action {
                Action::MoveBy(..) => self.leading = Kind::Mouse,
                Action::MoveTo(..) => self.leading = Kind::Pointer,
                _ => {}
            }
        }
    }

    /// Does something with every device, and tells the first failure.
    fn each(&mut self, call: impl Fn(&mut Part<N>) -> io::Result<()>) -> io::Result<()> {
        let mut outcome = Ok(());
        for part in &mut self.parts {
            outcome = outcome.and(call(part));
        }
        outcome
    }
}

impl<N: Node> Sink for Uinput<N> {
    fn send(&mut self, events: &[OutputEvent]) -> Result<(), OutputError> {
        self.note_leading(events);
        let mut outcome = Ok(());
        for event in events {
            outcome = outcome.and(self.take(event.action));
        }
        outcome.and(self.each(Part::deliver)).map_err(failed)
    }

    fn reach(&self) -> Reach {
        Reach::Uinput
    }

    fn close(&mut self) -> Result<(), OutputError> {
        self.each(Part::let_go).map_err(failed)
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

fn failed(error: io::Error) -> OutputError {
    OutputError::Send {
        output: OUTPUT.into(),
        reason: error.to_string(),
    }
}

/// Whether the node is not there, or nothing behind it.
pub(crate) fn is_absent(error: &io::Error) -> bool {
    error.kind() == io::ErrorKind::NotFound
        || error
            .raw_os_error()
            .is_some_and(|code| NOTHING_BEHIND_NODE.contains(&code))
}

/// Why the node cannot be opened and what to do about it.
fn open_reason(error: &io::Error) -> String {
    if is_absent(error) {
        return access::uinput_absent().to_string();
    }
    if error.kind() == io::ErrorKind::PermissionDenied {
        return access::uinput_denied(&Denied::Unknown).to_string();
    }
    format!("/dev/uinput: {error}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::TargetId;
    use crate::device::Axis;
    use crate::output::tests::{down, event, key, up};
    use evdev::InputEvent;
    use std::sync::{Arc, Mutex};

    /// Keeps what its devices are given, after failing as often as it is told to.
    #[derive(Clone, Default)]
    struct Desk(Arc<Mutex<(usize, Vec<String>)>>);

    /// A device on a desk.
    struct Stand(Desk, &'static str);

    impl Desk {
        fn frames(&self) -> Vec<String> {
            std::mem::take(&mut self.0.lock().unwrap().1)
        }

        fn fails(&self, times: usize) {
            self.0.lock().unwrap().0 = times;
        }

        fn devices(&self, needs: &[Need]) -> Uinput<Stand> {
            let needs = needs.iter().copied().collect();
            let stand = |declared: &Declared| Ok(Stand(self.clone(), declared.kind.name()));
            Uinput::on(&needs, stand).unwrap()
        }

        fn keyboard(&self, codes: &[&str]) -> Uinput<Stand> {
            let codes: Vec<_> = codes.iter().map(|name| code(name)).collect();
            self.devices(&codes)
        }
    }

    impl Node for Stand {
        fn emit(&mut self, events: &[InputEvent]) -> io::Result<()> {
            let (failures, frames) = &mut *self.0.0.lock().unwrap();
            if *failures > 0 {
                *failures -= 1;
                return Err(io::ErrorKind::WouldBlock.into());
            }
            let of_event = |event: &InputEvent| {
                let kind = ["syn", "key", "rel", "abs"][usize::from(event.event_type().0)];
                format!("{kind} {}={}", event.code(), event.value())
            };
            let events: Vec<_> = events.iter().map(of_event).collect();
            frames.push(format!("{}: {}", self.1, events.join(", ")));
            Ok(())
        }
    }

    fn code(name: &str) -> Need {
        Need::Code(key(name))
    }

    #[test]
    fn a_frame_goes_out_as_one_and_a_key_that_is_not_needed_does_not() {
        let desk = Desk::default();
        let mut keyboard = desk.keyboard(&["ShiftLeft", "A"]);
        keyboard
            .send(&[down(1, "ShiftLeft"), down(1, "A"), down(1, "MetaLeft")])
            .unwrap();
        keyboard.send(&[up(2, "MetaLeft")]).unwrap();
        keyboard.send(&[up(3, "A")]).unwrap();
        assert_eq!(
            desk.frames(),
            ["keyboard: key 42=1, key 30=1", "keyboard: key 30=0"]
        );
        assert_eq!(keyboard.refused_presses(), 1);
    }

    #[test]
    fn each_device_gets_its_part_of_a_frame() {
        let desk = Desk::default();
        let mut devices = desk.devices(&[
            code("A"),
            code("MouseLeft"),
            code("PadEast"),
            Need::Move,
            Need::Place,
            Need::Axis(Axis::LeftY),
        ]);
        let frame = [
            event(1, Action::MoveTo(1.0, 0.0)),
            down(1, "MouseLeft"),
            down(1, "PadEast"),
            event(1, Action::Axis(Axis::LeftY, 1.0)),
            down(1, "A"),
            event(1, Action::MoveBy(-3, 0)),
            event(1, Action::Depth(TargetId(1), 0.5)),
        ];
        devices.send(&frame).unwrap();
        let expected = [
            "keyboard: key 30=1",
            "mouse: key 272=1, rel 0=-3",
            "pointer: abs 0=65535, abs 1=0",
            "gamepad: key 305=1, abs 1=-32767",
        ];
        assert_eq!(desk.frames(), expected);
        devices.close().unwrap();
        let expected = [
            "keyboard: key 30=0",
            "mouse: key 272=0",
            "gamepad: key 305=0, abs 1=0",
        ];
        assert_eq!(desk.frames(), expected);
    }

    #[test]
    fn a_button_goes_to_the_device_that_moved_last_and_comes_up_where_it_went_down() {
        let desk = Desk::default();
        let mut devices = desk.devices(&[code("MouseLeft"), Need::Move, Need::Place]);
        let frames = [
            [down(1, "MouseLeft"), event(1, Action::MoveTo(0.0, 1.0))],
            [up(2, "MouseLeft"), event(2, Action::MoveBy(1, 0))],
            [event(3, Action::MoveBy(1, 0)), down(3, "MouseLeft")],
            [event(4, Action::MoveTo(1.0, 1.0)), up(4, "MouseLeft")],
        ];
        for frame in frames {
            devices.send(&frame).unwrap();
        }
        let expected = [
            "pointer: key 272=1, abs 0=0, abs 1=65535",
            "mouse: rel 0=1",
            "pointer: key 272=0",
            "mouse: rel 0=1, key 272=1",
            "mouse: key 272=0",
            "pointer: abs 0=65535, abs 1=65535",
        ];
        assert_eq!(desk.frames(), expected);
    }

    #[test]
    fn the_wheel_tells_fine_turns_and_the_clicks_that_they_complete() {
        let desk = Desk::default();
        let mut mouse = desk.devices(&[Need::Scroll]);
        for turn in [(0, 60), (0, 90), (-240, 0), (0, -150)] {
            mouse
                .send(&[event(1, Action::Scroll(turn.0, turn.1))])
                .unwrap();
        }
        let expected = [
            "mouse: rel 11=60",
            "mouse: rel 11=90, rel 8=1",
            "mouse: rel 12=-240, rel 6=-2",
            "mouse: rel 11=-150, rel 8=-1",
        ];
        assert_eq!(desk.frames(), expected);
    }

    #[test]
    fn what_is_no_number_or_not_needed_does_not_move_anything() {
        let desk = Desk::default();
        let mut devices = desk.devices(&[Need::Place, Need::Axis(Axis::LeftX)]);
        let frame = [
            event(1, Action::MoveTo(f32::NAN, 0.5)),
            event(1, Action::MoveBy(5, 5)),
            event(1, Action::Axis(Axis::TurnX, 1.0)),
            event(1, Action::Axis(Axis::LeftY, 1.0)),
            event(1, Action::Write('a')),
        ];
        devices.send(&frame).unwrap();
        devices.close().unwrap();
        assert_eq!(desk.frames(), [""; 0]);
        assert_eq!(devices.refused_presses(), 0);
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
        let expected = [
            "keyboard: key 42=1, key 30=1, key 48=1",
            "keyboard: key 48=0, key 30=0, key 42=0",
            "keyboard: key 30=1",
            "keyboard: key 30=0",
        ];
        assert_eq!(desk.frames(), expected);
    }

    #[test]
    fn a_frame_is_tried_four_times_and_a_release_that_failed_is_not_forgotten() {
        let desk = Desk::default();
        let mut pad = desk.devices(&[code("PadSouth"), Need::Axis(Axis::LeftX)]);
        let stick = |value| event(1, Action::Axis(Axis::LeftX, value));
        desk.fails(3);
        pad.send(&[down(1, "PadSouth"), stick(-1.0)]).unwrap();
        desk.fails(4);
        let error = pad.send(&[up(2, "PadSouth"), stick(0.0)]).unwrap_err();
        assert!(error.to_string().starts_with("the output `uinput` failed"));
        pad.close().unwrap();
        let expected = [
            "gamepad: key 304=1, abs 0=-32767",
            "gamepad: key 304=0, abs 0=0",
        ];
        assert_eq!(desk.frames(), expected);
    }

    #[test]
    fn a_press_that_failed_is_let_go_of_because_nobody_knows_whether_it_arrived() {
        let desk = Desk::default();
        let mut keyboard = desk.keyboard(&["A"]);
        desk.fails(4);
        keyboard.send(&[down(1, "A")]).unwrap_err();
        keyboard.close().unwrap();
        assert_eq!(desk.frames(), ["keyboard: key 30=0"]);
    }

    #[test]
    fn a_device_that_fails_does_not_keep_the_others_from_releases() {
        let desk = Desk::default();
        let mut devices = desk.devices(&[code("A"), code("PadSouth")]);
        devices.send(&[down(1, "A"), down(1, "PadSouth")]).unwrap();
        desk.frames();
        desk.fails(4);
        devices.close().unwrap_err();
        assert_eq!(desk.frames(), ["gamepad: key 304=0"]);
        devices.close().unwrap();
        assert_eq!(desk.frames(), ["keyboard: key 30=0"]);
    }

    #[test]
    fn a_frame_of_any_length_arrives_whole() {
        let desk = Desk::default();
        let mut keyboard = desk.keyboard(&["A"]);
        let frame: Vec<_> = (0..500).flat_map(|_| [down(1, "A"), up(1, "A")]).collect();
        keyboard.send(&frame).unwrap();
        let frames = desk.frames().join(" ");
        assert_eq!(frames.matches("key 30=1").count(), 500);
        assert_eq!(frames.matches("key 30=0").count(), 500);
    }

    #[test]
    fn an_error_at_opening_says_what_to_do() {
        let reason = |kind: io::ErrorKind| open_reason(&kind.into());
        assert!(reason(io::ErrorKind::NotFound).contains("modprobe uinput"));
        assert!(open_reason(&io::Error::from_raw_os_error(19)).contains("modprobe uinput"));
        let denied = reason(io::ErrorKind::PermissionDenied);
        assert!(denied.contains("ademan setup --print udev"), "{denied}");
        assert_eq!(reason(io::ErrorKind::TimedOut), "/dev/uinput: timed out");
    }

    #[test]
    fn a_name_that_is_too_long_is_refused() {
        let error = Uinput::open(&"k".repeat(70), &Needs::default())
            .err()
            .unwrap();
        assert!(error.to_string().contains("1 to 69 bytes"), "{error}");
    }

    #[test]
    fn the_kernel_takes_every_device_where_there_is_one() {
        let node = std::fs::OpenOptions::new().write(true).open("/dev/uinput");
        if let Err(error) = node {
            println!("SKIPPED: /dev/uinput cannot be written here: {error}");
            return;
        }
        let needs = [
            code("F12"),
            code("PadSouth"),
            Need::Move,
            Need::Place,
            Need::Scroll,
            Need::Axis(Axis::LeftX),
        ];
        let mut devices = Uinput::open("Ademan test", &Needs::from_iter(needs)).unwrap();
        let frame = [
            down(1, "F12"),
            event(1, Action::Axis(Axis::LeftX, 0.5)),
            up(2, "F12"),
        ];
        devices.send(&frame).unwrap();
        devices.close().unwrap();
    }
}
