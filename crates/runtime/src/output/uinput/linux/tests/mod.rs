//! Devices that record their reports.

mod watchdog;

use super::*;
use crate::output::tests::{down, event, key, up};
use ademan_core::contact::TargetId;
use ademan_core::device::Axis;
use evdev::InputEvent;
use std::os::fd::OwnedFd;
use std::sync::{Arc, Mutex};

/// Records the reports of all its devices, after a number of failures.
#[derive(Clone, Default)]
struct Recorder(Arc<Mutex<Recorded>>);

#[derive(Default)]
struct Recorded {
    failures: usize,
    reports: Vec<String>,
}

/// The node of a recorded device.
struct RecordedNode {
    recorder: Recorder,
    name: &'static str,
}

impl Recorder {
    /// Removes and returns the reports.
    fn reports(&self) -> Vec<String> {
        std::mem::take(&mut self.0.lock().unwrap().reports)
    }

    fn report_count(&self) -> usize {
        self.0.lock().unwrap().reports.len()
    }

    /// Makes the next reports fail.
    fn fail(&self, count: usize) {
        self.0.lock().unwrap().failures = count;
    }
}

/// Creates devices and the recorder of their reports.
fn devices(required: &[Capability]) -> (Recorder, Uinput<RecordedNode>) {
    let recorder = Recorder::default();
    let required = required.iter().copied().collect();
    let node = |spec: &DeviceSpec| {
        Ok(RecordedNode {
            recorder: recorder.clone(),
            name: spec.kind.name(),
        })
    };
    let uinput = Uinput::with_nodes(&required, node).unwrap();
    (recorder, uinput)
}

fn keyboard(keys: &[&str]) -> (Recorder, Uinput<RecordedNode>) {
    let keys: Vec<_> = keys.iter().map(|name| code(name)).collect();
    devices(&keys)
}

impl DeviceNode for RecordedNode {
    fn write_report(&mut self, events: &[InputEvent]) -> io::Result<()> {
        let recorded = &mut *self.recorder.0.lock().unwrap();
        if recorded.failures > 0 {
            recorded.failures -= 1;
            return Err(io::ErrorKind::WouldBlock.into());
        }
        let text = |event: &InputEvent| {
            let kind = ["syn", "key", "rel", "abs"][usize::from(event.event_type().0)];
            format!("{kind} {}={}", event.code(), event.value())
        };
        let events: Vec<_> = events.iter().map(text).collect();
        let report = format!("{}: {}", self.name, events.join(", "));
        recorded.reports.push(report);
        Ok(())
    }

    fn try_clone_fd(&self) -> io::Result<OwnedFd> {
        Ok(std::io::pipe()?.1.into())
    }
}

fn code(name: &str) -> Capability {
    Capability::Key(key(name))
}

#[test]
fn a_step_is_one_report_and_a_key_that_is_not_required_is_dropped() {
    let (recorder, mut keyboard) = keyboard(&["ShiftLeft", "A"]);
    keyboard
        .send(&[down(1, "ShiftLeft"), down(1, "A"), down(1, "MetaLeft")])
        .unwrap();
    keyboard.send(&[up(2, "MetaLeft")]).unwrap();
    keyboard.send(&[up(3, "A")]).unwrap();
    assert_eq!(
        recorder.reports(),
        ["keyboard: key 42=1, key 30=1", "keyboard: key 30=0"]
    );
    assert_eq!(keyboard.dropped_presses(), 1);
}

#[test]
fn each_device_receives_its_part_of_a_step_in_order() {
    let (recorder, mut devices) = devices(&[
        code("A"),
        code("MouseLeft"),
        code("PadEast"),
        Capability::RelativeMotion,
        Capability::AbsoluteMotion,
        Capability::Axis(Axis::LeftY),
    ]);
    let events = [
        event(1, EventKind::MoveTo(1.0, 0.0)),
        down(1, "MouseLeft"),
        down(1, "PadEast"),
        event(1, EventKind::Axis(Axis::LeftY, 1.0)),
        down(1, "A"),
        event(1, EventKind::MoveBy(-3, 0)),
        event(1, EventKind::Depth(TargetId(1), 0.5)),
    ];
    devices.send(&events).unwrap();
    let expected = [
        "pointer: abs 0=65535, abs 1=0",
        "mouse: key 272=1",
        "gamepad: key 305=1, abs 1=-32767",
        "keyboard: key 30=1",
        "mouse: rel 0=-3",
    ];
    assert_eq!(recorder.reports(), expected);
    devices.close().unwrap();
    let expected_at_end = [
        "gamepad: key 305=0, abs 1=0",
        "mouse: key 272=0",
        "keyboard: key 30=0",
    ];
    assert_eq!(recorder.reports(), expected_at_end);
}

#[test]
fn a_button_is_pressed_on_the_device_that_moved_last_and_released_there() {
    let (recorder, mut devices) = devices(&[
        code("MouseLeft"),
        Capability::RelativeMotion,
        Capability::AbsoluteMotion,
    ]);
    let steps = [
        [down(1, "MouseLeft"), event(1, EventKind::MoveTo(0.0, 1.0))],
        [up(2, "MouseLeft"), event(2, EventKind::MoveBy(1, 0))],
        [event(3, EventKind::MoveBy(1, 0)), down(3, "MouseLeft")],
        [event(4, EventKind::MoveTo(1.0, 1.0)), up(4, "MouseLeft")],
    ];
    for events in steps {
        devices.send(&events).unwrap();
    }
    let expected = [
        "pointer: key 272=1, abs 0=0, abs 1=65535",
        "pointer: key 272=0",
        "mouse: rel 0=1",
        "mouse: rel 0=1, key 272=1",
        "pointer: abs 0=65535, abs 1=65535",
        "mouse: key 272=0",
    ];
    assert_eq!(recorder.reports(), expected);
}

#[test]
fn a_click_of_one_step_is_two_reports() {
    let (recorder, mut mouse) = devices(&[
        code("MouseLeft"),
        code("MouseRight"),
        Capability::RelativeMotion,
    ]);
    let events = [
        event(1, EventKind::MoveBy(3, 0)),
        down(1, "MouseLeft"),
        down(1, "MouseRight"),
        up(1, "MouseLeft"),
        down(1, "MouseLeft"),
    ];
    mouse.send(&events).unwrap();
    let expected = [
        "mouse: rel 0=3, key 272=1, key 273=1",
        "mouse: key 272=0",
        "mouse: key 272=1",
    ];
    assert_eq!(recorder.reports(), expected);
}

#[test]
fn the_wheel_reports_high_resolution_rotation_and_completed_detents() {
    let (recorder, mut mouse) = devices(&[Capability::Scroll]);
    for (x, y) in [(0, 60), (0, 90), (-240, 0), (0, -150)] {
        mouse.send(&[event(1, EventKind::Scroll(x, y))]).unwrap();
    }
    let expected = [
        "mouse: rel 11=60",
        "mouse: rel 11=90, rel 8=1",
        "mouse: rel 12=-240, rel 6=-2",
        "mouse: rel 11=-150, rel 8=-1",
    ];
    assert_eq!(recorder.reports(), expected);
}

#[test]
fn nan_and_events_that_are_not_required_are_ignored() {
    let (recorder, mut devices) =
        devices(&[Capability::AbsoluteMotion, Capability::Axis(Axis::LeftX)]);
    let events = [
        event(1, EventKind::MoveTo(f32::NAN, 0.5)),
        event(1, EventKind::MoveBy(5, 5)),
        event(1, EventKind::Axis(Axis::TurnX, 1.0)),
        event(1, EventKind::Axis(Axis::LeftY, 1.0)),
        event(1, EventKind::Character('a')),
    ];
    devices.send(&events).unwrap();
    devices.close().unwrap();
    assert_eq!(recorder.reports(), [""; 0]);
    assert_eq!(devices.dropped_presses(), 1, "the character");
}

#[test]
fn closing_and_dropping_release_keys_modifiers_last() {
    let (recorder, mut keyboard) = keyboard(&["ShiftLeft", "A", "B"]);
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
    assert_eq!(recorder.reports(), expected);
}

#[test]
fn a_report_is_tried_four_times_and_a_failed_release_is_repeated_on_closing() {
    let (recorder, mut pad) = devices(&[code("PadSouth"), Capability::Axis(Axis::LeftX)]);
    let stick = |value| event(1, EventKind::Axis(Axis::LeftX, value));
    recorder.fail(3);
    pad.send(&[down(1, "PadSouth"), stick(-1.0)]).unwrap();
    recorder.fail(4);
    let error = pad.send(&[up(2, "PadSouth"), stick(0.0)]).unwrap_err();
    assert!(error.to_string().starts_with("the output `uinput` failed"));
    pad.close().unwrap();
    let expected = [
        "gamepad: key 304=1, abs 0=-32767",
        "gamepad: key 304=0, abs 0=0",
    ];
    assert_eq!(recorder.reports(), expected);
}

#[test]
fn a_failed_press_is_released_as_it_may_have_arrived() {
    let (recorder, mut keyboard) = keyboard(&["A"]);
    recorder.fail(4);
    keyboard.send(&[down(1, "A")]).unwrap_err();
    keyboard.close().unwrap();
    assert_eq!(recorder.reports(), ["keyboard: key 30=0"]);
}

#[test]
fn a_failed_device_does_not_keep_releases_from_the_others() {
    let (recorder, mut devices) = devices(&[code("A"), code("PadSouth")]);
    devices.send(&[down(1, "A"), down(1, "PadSouth")]).unwrap();
    recorder.reports();
    recorder.fail(4);
    devices.close().unwrap_err();
    assert_eq!(recorder.reports(), ["keyboard: key 30=0"]);
    devices.close().unwrap();
    assert_eq!(recorder.reports(), ["gamepad: key 304=0"]);
}

#[test]
fn a_device_that_fails_during_a_step_does_not_keep_the_release_from_another() {
    let (recorder, mut devices) = devices(&[
        code("MouseLeft"),
        Capability::RelativeMotion,
        Capability::AbsoluteMotion,
    ]);
    let press = [event(1, EventKind::MoveTo(0.0, 0.0)), down(1, "MouseLeft")];
    devices.send(&press).unwrap();
    recorder.reports();
    // The report of the mouse is full.
    let mut release = vec![event(2, EventKind::MoveBy(1, 0)); node::MAX_EVENTS - 3];
    release.push(up(2, "MouseLeft"));
    recorder.fail(4);
    devices.send(&release).unwrap_err();
    assert_eq!(recorder.reports(), ["pointer: key 272=0"]);
}

#[test]
fn a_modifier_key_goes_down_before_a_button_and_comes_up_after_it() {
    let (recorder, mut devices) = devices(&[code("ControlLeft"), code("MouseLeft")]);
    let press = [down(1, "ControlLeft"), down(1, "MouseLeft")];
    devices.send(&press).unwrap();
    devices
        .send(&[up(2, "MouseLeft"), up(2, "ControlLeft")])
        .unwrap();
    let expected = [
        "keyboard: key 29=1",
        "mouse: key 272=1",
        "mouse: key 272=0",
        "keyboard: key 29=0",
    ];
    assert_eq!(recorder.reports(), expected);
    devices.send(&press).unwrap();
    devices.close().unwrap();
    assert_eq!(recorder.reports(), expected);
}

#[test]
fn a_long_step_arrives_complete() {
    let (recorder, mut keyboard) = keyboard(&["A"]);
    let events: Vec<_> = (0..500).flat_map(|_| [down(1, "A"), up(1, "A")]).collect();
    keyboard.send(&events).unwrap();
    let reports = recorder.reports().join(" ");
    assert_eq!(reports.matches("key 30=1").count(), 500);
    assert_eq!(reports.matches("key 30=0").count(), 500);
}

#[test]
fn an_open_error_contains_the_remedy() {
    let message = |kind: io::ErrorKind| open_message(&kind.into());
    assert!(message(io::ErrorKind::NotFound).contains("modprobe uinput"));
    assert!(open_message(&io::Error::from_raw_os_error(19)).contains("modprobe uinput"));
    let denied = message(io::ErrorKind::PermissionDenied);
    assert!(denied.contains("ademan system-files udev"), "{denied}");
    assert_eq!(message(io::ErrorKind::TimedOut), "/dev/uinput: timed out");
}

#[test]
fn a_long_name_is_rejected() {
    let error = Uinput::open(&"k".repeat(70), &Capabilities::default())
        .err()
        .unwrap();
    assert!(error.to_string().contains("1 to 69 bytes"), "{error}");
}

#[test]
fn the_kernel_accepts_every_device() {
    let node = std::fs::OpenOptions::new().write(true).open("/dev/uinput");
    if let Err(error) = node {
        println!("SKIPPED: cannot write to /dev/uinput: {error}");
        return;
    }
    let required = [
        code("F12"),
        code("PadSouth"),
        Capability::RelativeMotion,
        Capability::AbsoluteMotion,
        Capability::Scroll,
        Capability::Axis(Axis::LeftX),
    ];
    let mut devices = Uinput::open("Ademan test", &Capabilities::from_iter(required)).unwrap();
    let events = [
        down(1, "F12"),
        event(1, EventKind::Axis(Axis::LeftX, 0.5)),
        up(2, "F12"),
    ];
    devices.send(&events).unwrap();
    devices.close().unwrap();
}
