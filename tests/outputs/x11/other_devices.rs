//! Corrections while somebody also types on another keyboard, or clicks with another mouse, in the same window.

use std::time::Duration;

use ademan::device::{EventKind, OutputEvent};
use ademan::output::{Desktop, Sink};
use x11rb::connection::{Connection, RequestConnection};
use x11rb::protocol::xinput::{
    self, ConnectionExt as _, DEVICE_BUTTON_PRESS_EVENT, DEVICE_BUTTON_RELEASE_EVENT,
    DEVICE_KEY_PRESS_EVENT, DEVICE_KEY_RELEASE_EVENT, Device, DeviceId, DeviceType, XIDeviceInfo,
};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;

use super::bursts::{A, CONTROL, events, open, pressed, tap};
use super::slow_display::SlowDisplay;
use super::{arrives, repeat};
use crate::support::key_log::{Input, KeyLog};
use crate::support::x11::{InputWindow, XServer, wait_at_most, wait_for};

/// Keys of a PC keyboard.
const BACKSPACE: Input = Input::Key(22);
const B: Input = Input::Key(56);
/// The left button of a mouse.
const LEFT: Input = Input::Button(1);

/// Attempts: a busy machine drops presses that wait for too long.
const ATTEMPTS: usize = 10;

/// The keyboard and the mouse of the server, which is none of the devices that XTEST adds.
struct OtherDevices {
    client: RustConnection,
    root: u32,
    first_event: u8,
    keyboard: DeviceId,
    mouse: DeviceId,
}

impl OtherDevices {
    fn connect(server: &XServer) -> Self {
        let (client, screen) = x11rb::connect(Some(server.display())).expect("the server answers");
        let extension = client.extension_information(xinput::X11_EXTENSION_NAME);
        let extension = extension.expect("the server runs").expect("X Input");
        let version = client.xinput_xi_query_version(2, 2);
        let version = version.expect("the server runs").reply();
        version.expect("the server answers");
        let devices = client.xinput_xi_query_device(Device::ALL);
        let devices = devices.expect("the server runs").reply();
        let devices = devices.expect("the server answers").infos;
        let id = |kind: DeviceType| {
            let is_own = |it: &&XIDeviceInfo| it.type_ == kind && it.name.starts_with(b"Xvfb");
            let device = devices.iter().find(is_own);
            device.expect("a device of Xvfb").deviceid
        };
        Self {
            root: client.setup().roots[screen].root,
            first_event: extension.first_event,
            keyboard: id(DeviceType::SLAVE_KEYBOARD),
            mouse: id(DeviceType::SLAVE_POINTER),
            client,
        }
    }

    /// Presses and releases a key or a button.
    fn tap(&self, input: Input) {
        let (device, kinds, detail) = match input {
            Input::Key(code) => (
                self.keyboard,
                [DEVICE_KEY_PRESS_EVENT, DEVICE_KEY_RELEASE_EVENT],
                code as u8,
            ),
            Input::Button(button) => (
                self.mouse,
                [DEVICE_BUTTON_PRESS_EVENT, DEVICE_BUTTON_RELEASE_EVENT],
                button,
            ),
        };
        for kind in kinds {
            let (kind, device) = (self.first_event + kind, device as u8);
            let fake = self
                .client
                .xtest_fake_input(kind, detail, 0, self.root, 0, 0, device);
            let fake = fake.expect("the server runs").check();
            fake.expect("the server has the device");
        }
    }
}

fn correction() -> Vec<OutputEvent> {
    [tap("Backspace"), tap("A")].concat()
}

/// A sink that a text decoder follows, and that has typed B and A.
struct Scene {
    server: XServer,
    sink: Desktop,
    log: KeyLog,
    generation: u32,
    _window: InputWindow,
}

impl Scene {
    /// Types both keys. Returns `None` without an X server.
    fn start() -> Option<Self> {
        for _ in 0..ATTEMPTS {
            let scene = Self::attempt()?;
            if scene.has_pressed(2) {
                assert_eq!(pressed(&scene.log), [B, A]);
                return Some(scene);
            }
        }
        panic!("nothing is typed");
    }

    fn attempt() -> Option<Self> {
        let server = XServer::start()?;
        let window = InputWindow::open(&server);
        let (mut sink, log) = (open(server.display()), KeyLog::start(&server));
        let generation = sink.text_field().generation;
        // The watch starts with the first key, at the latest before the second one.
        for key in [tap("B"), tap("A")] {
            sink.send(&key).expect("it is open");
        }
        Some(Self {
            server,
            sink,
            log,
            generation,
            _window: window,
        })
    }

    /// Waits until this many keys and buttons were pressed. Returns `false` if some were dropped.
    fn has_pressed(&self, count: usize) -> bool {
        wait_at_most(Duration::from_secs(5), || pressed(&self.log).len() >= count)
    }
}

/// Checks that an input of another device has a correction dropped and the decoder start afresh, and that the next correction is
/// executed.
fn check_that_a_correction_is_dropped_after(input: Input) {
    for _ in 0..ATTEMPTS {
        let Some(mut scene) = Scene::start() else {
            return;
        };
        OtherDevices::connect(&scene.server).tap(input);
        scene.sink.send(&correction()).expect("it is open");
        assert!(wait_for(|| scene.sink.dropped_presses() == 2));
        assert_ne!(scene.sink.text_field().generation, scene.generation);
        scene.sink.void_presses();
        scene.sink.send(&tap("A")).expect("it is open");
        scene.sink.send(&correction()).expect("it is open");
        if scene.has_pressed(6) {
            assert_eq!(pressed(&scene.log)[2..], [input, A, BACKSPACE, A]);
            return;
        }
    }
    panic!("the next correction is never executed");
}

#[test]
fn a_correction_deletes_nothing_that_another_keyboard_has_typed() {
    check_that_a_correction_is_dropped_after(B);
}

#[test]
fn a_modifier_of_another_keyboard_drops_a_correction() {
    check_that_a_correction_is_dropped_after(CONTROL);
}

#[test]
fn a_correction_deletes_nothing_after_a_click_of_another_mouse() {
    check_that_a_correction_is_dropped_after(LEFT);
}

#[test]
fn the_text_field_is_another_one_after_a_press_of_another_keyboard_without_a_correction() {
    let Some(scene) = Scene::start() else {
        return;
    };
    OtherDevices::connect(&scene.server).tap(B);
    let is_noticed = || scene.sink.text_field().generation != scene.generation;
    assert!(wait_for(is_noticed));
}

#[test]
fn the_keys_and_buttons_of_the_output_itself_drop_no_correction() {
    for _ in 0..ATTEMPTS {
        let Some(mut scene) = Scene::start() else {
            return;
        };
        for own in [tap("MouseLeft"), tap("ShiftLeft"), tap("B")] {
            scene.sink.send(&own).expect("it is open");
        }
        let scroll = events(&[EventKind::Scroll(0, 120)]);
        scene.sink.send(&scroll).expect("it is open");
        scene.sink.send(&correction()).expect("it is open");
        if scene.has_pressed(8) {
            let own = pressed(&scene.log);
            assert_eq!(own[6..], [BACKSPACE, A], "{own:?}");
            assert_eq!(scene.sink.dropped_presses(), 0);
            assert_eq!(scene.sink.text_field().generation, scene.generation);
            return;
        }
    }
    panic!("the correction is never executed");
}

#[test]
fn without_the_extension_the_output_types_and_corrects_as_it_does_elsewhere() {
    repeat(|| {
        let Some(server) = XServer::start() else {
            return true;
        };
        let display = SlowDisplay::without_input_extension(&server);
        let (mut sink, log) = (open(display.display()), KeyLog::start(&server));
        let generation = sink.text_field().generation;
        let count = || pressed(&log).len();
        let is_typed = arrives(&mut sink, &tap("B"), || count() == 1)
            && arrives(&mut sink, &tap("A"), || count() == 2);
        if !is_typed {
            return false;
        }
        OtherDevices::connect(&server).tap(B);
        let is_corrected = arrives(&mut sink, &correction(), || count() == 5);
        let arrived = pressed(&log);
        let expected = [B, A, B, BACKSPACE, A];
        assert!(expected.starts_with(&arrived), "{arrived:?}");
        assert_eq!(sink.text_field().generation, generation);
        is_corrected
    });
}

#[test]
fn other_devices_are_not_watched_without_a_decoder() {
    repeat(|| {
        let Some(server) = XServer::start() else {
            return true;
        };
        let (mut sink, log) = (open(server.display()), KeyLog::start(&server));
        if !arrives(&mut sink, &tap("A"), || pressed(&log).len() == 1) {
            return false;
        }
        OtherDevices::connect(&server).tap(B);
        let is_corrected = arrives(&mut sink, &correction(), || pressed(&log).len() == 4);
        let arrived = pressed(&log);
        let expected = [A, B, BACKSPACE, A];
        assert!(expected.starts_with(&arrived), "{arrived:?}");
        is_corrected
    });
}
