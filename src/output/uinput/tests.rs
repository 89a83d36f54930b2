//! Devices that write down what they are given.

use super::*;
use crate::contact::TargetId;
use crate::device::Axis;
use crate::output::tests::{down, event, key, up};
use crate::output::watchdog::HEARTBEAT_INTERVAL;
use evdev::InputEvent;
use std::fs;
use std::os::fd::OwnedFd;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::sleep;
use std::time::{Duration, Instant};

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

    fn devices(&self, needs: &[Capability]) -> Uinput<Stand> {
        let needs = needs.iter().copied().collect();
        let stand = |declared: &DeviceSpec| Ok(Stand(self.clone(), declared.kind.name()));
        Uinput::on(&needs, stand).unwrap()
    }

    fn keyboard(&self, codes: &[&str]) -> Uinput<Stand> {
        let codes: Vec<_> = codes.iter().map(|name| code(name)).collect();
        self.devices(&codes)
    }
}

impl DeviceNode for Stand {
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

    fn try_clone_fd(&self) -> io::Result<OwnedFd> {
        Ok(std::io::pipe()?.1.into())
    }
}

fn code(name: &str) -> Capability {
    Capability::Key(key(name))
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
    assert_eq!(keyboard.dropped_presses(), 1);
}

#[test]
fn each_device_gets_its_part_of_a_frame() {
    let desk = Desk::default();
    let mut devices = desk.devices(&[
        code("A"),
        code("MouseLeft"),
        code("PadEast"),
        Capability::RelativeMotion,
        Capability::AbsoluteMotion,
        Capability::Axis(Axis::LeftY),
    ]);
    let frame = [
        event(1, EventKind::MoveTo(1.0, 0.0)),
        down(1, "MouseLeft"),
        down(1, "PadEast"),
        event(1, EventKind::Axis(Axis::LeftY, 1.0)),
        down(1, "A"),
        event(1, EventKind::MoveBy(-3, 0)),
        event(1, EventKind::Depth(TargetId(1), 0.5)),
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
    let mut devices = desk.devices(&[
        code("MouseLeft"),
        Capability::RelativeMotion,
        Capability::AbsoluteMotion,
    ]);
    let frames = [
        [down(1, "MouseLeft"), event(1, EventKind::MoveTo(0.0, 1.0))],
        [up(2, "MouseLeft"), event(2, EventKind::MoveBy(1, 0))],
        [event(3, EventKind::MoveBy(1, 0)), down(3, "MouseLeft")],
        [event(4, EventKind::MoveTo(1.0, 1.0)), up(4, "MouseLeft")],
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
    let mut mouse = desk.devices(&[Capability::Scroll]);
    for turn in [(0, 60), (0, 90), (-240, 0), (0, -150)] {
        mouse
            .send(&[event(1, EventKind::Scroll(turn.0, turn.1))])
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
    let mut devices = desk.devices(&[Capability::AbsoluteMotion, Capability::Axis(Axis::LeftX)]);
    let frame = [
        event(1, EventKind::MoveTo(f32::NAN, 0.5)),
        event(1, EventKind::MoveBy(5, 5)),
        event(1, EventKind::Axis(Axis::TurnX, 1.0)),
        event(1, EventKind::Axis(Axis::LeftY, 1.0)),
        event(1, EventKind::Character('a')),
    ];
    devices.send(&frame).unwrap();
    devices.close().unwrap();
    assert_eq!(desk.frames(), [""; 0]);
    assert_eq!(devices.dropped_presses(), 0);
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
    let mut pad = desk.devices(&[code("PadSouth"), Capability::Axis(Axis::LeftX)]);
    let stick = |value| event(1, EventKind::Axis(Axis::LeftX, value));
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
    let error = Uinput::open(&"k".repeat(70), &Capabilities::default())
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
        Capability::RelativeMotion,
        Capability::AbsoluteMotion,
        Capability::Scroll,
        Capability::Axis(Axis::LeftX),
    ];
    let mut devices = Uinput::open("Ademan test", &Capabilities::from_iter(needs)).unwrap();
    let frame = [
        down(1, "F12"),
        event(1, EventKind::Axis(Axis::LeftX, 0.5)),
        up(2, "F12"),
    ];
    devices.send(&frame).unwrap();
    devices.close().unwrap();
}

/// A guardian that writes down what it is told, and lets go of nothing.
struct Notebook {
    folder: tempfile::TempDir,
    losses: Arc<AtomicUsize>,
}

impl Notebook {
    fn new() -> Self {
        Self {
            folder: tempfile::tempdir().unwrap(),
            losses: Arc::default(),
        }
    }

    fn launch(&self) -> WatchdogSettings {
        let losses = self.losses.clone();
        let path = self.path().display().to_string();
        // Ready, what it is handed, and then every word.
        let script = format!(
            "printf . >&0; head -c 5 >/dev/null; echo $$ >{path}.process; exec cat >>{path}"
        );
        WatchdogSettings {
            program: "sh".into(),
            arguments: vec!["-c".into(), script.into()],
            on_lost: Arc::new(move || _ = losses.fetch_add(1, Ordering::Relaxed)),
        }
    }

    fn path(&self) -> PathBuf {
        self.folder.path().join("words")
    }

    /// The first letters of the words, once there are as many.
    fn words(&self, count: usize) -> String {
        let read = || fs::read(self.path()).unwrap_or_default();
        wait_for("words", || read().len() >= 3 * count);
        read().chunks(3).map(|word| char::from(word[0])).collect()
    }

    fn kill(&self) {
        let path = format!("{}.process", self.path().display());
        let process = fs::read_to_string(&path).unwrap();
        fs::remove_file(path).unwrap();
        let process = rustix::process::Pid::from_raw(process.trim().parse().unwrap()).unwrap();
        rustix::process::kill_process(process, rustix::process::Signal::KILL).unwrap();
    }

    fn is_ready(&self) -> bool {
        Path::new(&format!("{}.process", self.path().display())).exists()
    }
}

fn wait_for(what: &str, condition: impl Fn() -> bool) {
    let start = Instant::now();
    while !condition() {
        assert!(start.elapsed() < Duration::from_secs(10), "no {what}");
        sleep(Duration::from_millis(1));
    }
}

#[test]
fn a_guardian_hears_of_what_goes_down_before_and_of_what_came_up_afterwards() {
    let notebook = Notebook::new();
    let desk = Desk::default();
    let mut devices = desk.devices(&[code("A"), Capability::Axis(Axis::LeftX)]);
    devices.guard(&notebook.launch()).unwrap();
    let stick = |value| event(1, EventKind::Axis(Axis::LeftX, value));
    devices.send(&[down(1, "A"), down(1, "Z")]).unwrap();
    // What is not needed is not pressed, and so it is not down.
    assert_eq!(notebook.words(3), "ddu");
    desk.fails(4);
    devices.send(&[up(2, "A"), stick(1.0)]).unwrap_err();
    devices.send(&[stick(0.5)]).unwrap();
    sleep(HEARTBEAT_INTERVAL);
    devices.send(&[]).unwrap();
    devices.close().unwrap();
    assert_eq!(notebook.words(7), "dduxacu");
    sleep(HEARTBEAT_INTERVAL);
    devices.send(&[]).unwrap();
    drop(devices);
    assert_eq!(notebook.words(7), "dduxacu");
}

#[test]
fn without_a_guardian_nothing_stays_down_and_nothing_goes_down_until_there_is_another_one() {
    let notebook = Notebook::new();
    let desk = Desk::default();
    let mut keyboard = desk.keyboard(&["A", "B"]);
    keyboard.guard(&notebook.launch()).unwrap();
    wait_for("guardian", || notebook.is_ready());
    keyboard.send(&[down(1, "A")]).unwrap();
    notebook.kill();
    let is_up = || desk.0.lock().unwrap().1.len() == 2;
    let start = Instant::now();
    while !is_up() {
        assert!(start.elapsed() < Duration::from_secs(10));
        keyboard.send(&[]).unwrap();
    }
    keyboard.send(&[down(2, "B")]).unwrap();
    assert_eq!(desk.frames(), ["keyboard: key 30=1", "keyboard: key 30=0"]);
    assert_eq!(keyboard.dropped_presses(), 1);
    wait_for("second guardian", || notebook.is_ready());
    assert_eq!(notebook.losses.load(Ordering::Relaxed), 1);
    while desk.0.lock().unwrap().1.is_empty() {
        assert!(start.elapsed() < Duration::from_secs(20));
        keyboard.send(&[down(3, "B")]).unwrap();
    }
    notebook.kill();
    let error = loop {
        assert!(start.elapsed() < Duration::from_secs(30));
        if let Err(error) = keyboard.send(&[]) {
            break error.to_string();
        }
    };
    assert!(error.contains("a second time"), "{error}");
    assert_eq!(desk.frames(), ["keyboard: key 48=1", "keyboard: key 48=0"]);
}
