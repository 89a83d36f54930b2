//! The devices of the output `uinput`, with and without all their capabilities.

use super::Scene;
use super::glove::HandMotion;
use super::witness::{EvdevEvent, Evtest};

/// A layout with a control for each device.
const DEVICES: &str = "devices.ron";
const ON_DEVICES: &str = "tap H; press Pad -20 0; slide 40 0 600; slide 0 15 300; lift; tap MouseRight; \
                          press Wheel; slide 20 0 600; slide -20 0 600; lift; \
                          press Screen -20 -15; slide 40 30 600; lift; \
                          press Steer 0 14; arc -180 600; lift; press Rudder; slide 20 0 400; lift; \
                          press Stick; slide 12 0 400; slide -12 12 400; lift; tap PadSouth";

/// A layout with as few capabilities as possible.
const FEW: &str = "few.ron";
const ON_FEW: &str = "press Screen 40 -20; slide -80 40 600; lift; tap PadSouth";

const LEFT: u16 = 272;
const RIGHT: u16 = 273;
const SOUTH: u16 = 304;

pub fn all(scene: &mut Scene) {
    let [keyboard, mouse, pointer, gamepad] = play(
        scene,
        DEVICES,
        ON_DEVICES,
        ["keyboard", "mouse", "pointer", "gamepad"],
    );
    assert_eq!(keyboard.keys(&mut scene.machine), [(35, true), (35, false)]);
    moves_and_scrolls(scene, &mouse);
    points(scene, &pointer);
    scene.report("libinput recognizes the pointer, and a touch moves it before the press");
    steers(scene, &gamepad);
    scene.end_program();

    let [lone_pointer, small_gamepad] = play(scene, FEW, ON_FEW, ["pointer", "gamepad"]);
    points(scene, &lone_pointer);
    is_joystick(scene, &small_gamepad);
    scene.report("a pointer without a mouse and a gamepad with one button are recognized");
    scene.end_program();
}

/// Plays a script, which ends with a tap on the gamepad, on a layout of this folder.
fn play<const N: usize>(
    scene: &mut Scene,
    layout: &str,
    script: &str,
    devices: [&str; N],
) -> [Evtest; N] {
    let here = format!("{}/tests/outputs/vm/{layout}", env!("CARGO_MANIFEST_DIR"));
    let motion = HandMotion::scripted(&here, script);
    scene.start_program(&format!("/etc/{layout}"));
    let evtests = devices.map(|device| scene.evtest(&format!("Ademan {device}")));
    scene.arm(&motion, 1);
    scene.glove.play(motion.all());
    let gamepad = &evtests[N - 1];
    scene.machine.wait_for("the last tap", |machine| {
        gamepad
            .keys(machine)
            .contains(&(SOUTH, false))
            .then_some(())
    });
    evtests
}

fn moves_and_scrolls(scene: &mut Scene, mouse: &Evtest) {
    let events = mouse.events(&mut scene.machine);
    assert!(
        sum(&events, "REL_X") > 40 && sum(&events, "REL_Y") < -15,
        "{events:?}"
    );
    for click in [1, -1] {
        let is_click =
            |event: &EvdevEvent| event.name == "REL_WHEEL" && event.value.signum() == click;
        assert!(events.iter().any(is_click), "{events:?}");
    }
    assert_eq!(
        mouse.keys(&mut scene.machine),
        [(RIGHT, true), (RIGHT, false)]
    );
    for part in [
        "DEVICE_ADDED Ademan mouse",
        "POINTER_MOTION",
        "POINTER_SCROLL_WHEEL",
        "BTN_RIGHT (273) pressed",
        "BTN_RIGHT (273) released",
    ] {
        scene
            .libinput
            .wait_for(&mut scene.machine, &[&mouse.node, part]);
    }
    scene.report("libinput recognizes the mouse with motion, wheel and buttons");
}

/// Checks that the button is pressed at the position of the touch, near a corner on the near side.
fn points(scene: &mut Scene, pointer: &Evtest) {
    assert_eq!(
        pointer.keys(&mut scene.machine),
        [(LEFT, true), (LEFT, false)]
    );
    let events = pointer.events(&mut scene.machine);
    let press = events.iter().position(|event| event.name == "BTN_LEFT");
    let position = |axis: &str| {
        let mut before = events.iter().take(press.unwrap_or(0));
        before
            .rfind(|event| event.name == axis)
            .map(|event| event.value)
    };
    let (x, y) = (position("ABS_X"), position("ABS_Y"));
    assert!(x.is_some() && y > Some(65_535 / 2), "{x:?} {y:?}");
    let added = scene.libinput.wait_for(
        &mut scene.machine,
        &[&pointer.node, "DEVICE_ADDED Ademan pointer"],
    );
    assert!(added.contains(" cap:p "), "{added}");
    for part in [
        "POINTER_MOTION_ABSOLUTE",
        "BTN_LEFT (272) pressed",
        "BTN_LEFT (272) released",
    ] {
        scene
            .libinput
            .wait_for(&mut scene.machine, &[&pointer.node, part]);
    }
    let lines = scene.libinput.lines(&mut scene.machine);
    let first = |part: &str| lines.iter().position(|line| line.contains(part));
    assert!(
        first("POINTER_MOTION_ABSOLUTE") < first("BTN_LEFT (272) pressed"),
        "{lines:#?}"
    );
}

fn steers(scene: &mut Scene, gamepad: &Evtest) {
    let events = gamepad.events(&mut scene.machine);
    let of = |axis: &'static str| events.iter().filter(move |event| event.name == axis);
    let farthest = |axis| {
        of(axis)
            .map(|event| event.value)
            .max_by_key(|value| value.abs())
    };
    assert!(farthest("ABS_X") > Some(20_000), "to the right: {events:?}");
    assert!(farthest("ABS_Y") < Some(-20_000), "up: {events:?}");
    assert!(farthest("ABS_WHEEL") > Some(5_000), "{events:?}");
    assert!(farthest("ABS_RUDDER") > Some(10_000), "{events:?}");
    for axis in ["ABS_X", "ABS_Y", "ABS_WHEEL", "ABS_RUDDER"] {
        assert_eq!(
            of(axis).next_back().map(|event| event.value),
            Some(0),
            "{axis}"
        );
    }
    assert_eq!(
        gamepad.keys(&mut scene.machine),
        [(SOUTH, true), (SOUTH, false)]
    );
    is_joystick(scene, gamepad);
    scene.report("udev recognizes the gamepad as a joystick, and its stick returns to the center");
}

/// Checks that udev, which games query, recognizes a joystick, and that libinput ignores it.
fn is_joystick(scene: &mut Scene, gamepad: &Evtest) {
    let node = &gamepad.node;
    let known = scene
        .machine
        .run(&format!("udevadm info /dev/input/{node}"));
    assert!(known.contains("ID_INPUT_JOYSTICK=1"), "{known}");
    let lines = scene.libinput.lines(&mut scene.machine);
    assert!(
        !lines.iter().any(|line| line.contains("Ademan gamepad")),
        "{lines:#?}"
    );
}

fn sum(events: &[EvdevEvent], axis: &str) -> i32 {
    let of_axis = events.iter().filter(|event| event.name == axis);
    of_axis.map(|event| event.value).sum()
}
