//! A keyboard whose glove is disconnected, and whose program is stopped and killed, while a key is pressed.

use super::Scene;
use super::glove::HandMotion;
use super::witness::Evtest;

pub const LAYOUT: &str = "qwerty-flat";
pub const KEYBOARD: &str = "Ademan keyboard";
const H: u16 = 35;

pub fn all(scene: &mut Scene) {
    let text = HandMotion::typing(LAYOUT, "Hola, 1!");
    let press = HandMotion::scripted(LAYOUT, "press H; wait 500; lift");
    scene.machine.plug_in("glove");
    scene.start_program(LAYOUT);
    let evtest = scene.evtest(KEYBOARD);
    let added = format!("{} DEVICE_ADDED {KEYBOARD}", evtest.node);
    let line = scene.libinput.wait_for(&mut scene.machine, &[&added]);
    assert!(line.ends_with("cap:k"), "{line}");
    scene.report("libinput recognizes the keyboard");

    scene.arm(&text, 1);
    types(scene, &evtest, &text);
    scene.report("text typed through a USB serial adapter arrives as key events");

    hold(scene, &evtest, &press);
    scene.machine.press(&["ctrl"]);
    scene.machine.press(&["ctrl", "ctrl_r"]);
    released(scene, &evtest);
    scene.wait_for_line("paused by the panic keys", 1);
    scene.report("panic keys release all keys and pause");
    scene.machine.run("ademan ctl resume --socket /tmp/control");
    scene.arm(&text, 2);

    hold(scene, &evtest, &press);
    scene.glove.stop_sending();
    scene.machine.unplug("glove");
    released(scene, &evtest);
    scene.report("pulling the cable releases all keys");

    scene.machine.plug_in("glove");
    scene.wait_for_line("reconnected to", 1);
    scene.arm(&text, 3);
    types(scene, &evtest, &text);
    scene.report("after a reconnection the glove types again");

    hold(scene, &evtest, &press);
    scene.glove.stop_sending();
    scene.machine.unplug("glove");
    released(scene, &evtest);
    scene.machine.plug_in("other");
    scene
        .machine
        .wait_for("another adapter at its port", |machine| {
            machine
                .run("ls /dev/ttyUSB0")
                .starts_with('/')
                .then_some(())
        });
    scene.machine.plug_in("glove");
    scene.wait_for_line("reconnected to .* at .*/dev/ttyUSB1", 1);
    scene.arm(&text, 4);
    types(scene, &evtest, &text);
    scene.report("after a reconnection at another port the glove types again");

    hold(scene, &evtest, &press);
    scene.machine.run("kill -STOP $(cat /tmp/ademan.pid)");
    released(scene, &evtest);
    scene.wait_for_line("does not respond; released its keys (1)", 1);
    scene.machine.run("kill -CONT $(cat /tmp/ademan.pid)");
    scene.report("the watchdog releases uinput keys of a stopped program");
    types(scene, &evtest, &text);
    scene.report("after SIGCONT it types again");

    hold(scene, &evtest, &press);
    scene.machine.run("kill -KILL $(cat /tmp/ademan.pid)");
    released(scene, &evtest);
    scene
        .libinput
        .wait_for(&mut scene.machine, &[&evtest.node, "DEVICE_REMOVED"]);
    scene.report("after SIGKILL all keys are released and the device is removed");
    scene.glove.stop_sending();
    scene.machine.unplug("other");
    scene.machine.unplug("glove");
    scene.machine.plug_in("glove");
}

/// Types a text and compares every key event.
fn types(scene: &mut Scene, evtest: &Evtest, text: &HandMotion) {
    let before = evtest.keys(&mut scene.machine).len();
    let expected = text.keys();
    scene.glove.play(text.all());
    scene.machine.wait_for("the whole text", |machine| {
        (evtest.keys(machine).len() >= before + expected.len()).then_some(())
    });
    assert_eq!(evtest.keys(&mut scene.machine)[before..], expected);
}

/// Holds the key H.
pub fn hold(scene: &mut Scene, evtest: &Evtest, press: &HandMotion) {
    scene.libinput.forget(&mut scene.machine);
    scene.glove.play(press.until_pressed());
    scene.machine.wait_for("a pressed key", |machine| {
        (evtest.keys(machine).last() == Some(&(H, true))).then_some(())
    });
}

/// Waits until kernel and libinput report the release of H.
pub fn released(scene: &mut Scene, evtest: &Evtest) {
    scene.machine.wait_for("a released key", |machine| {
        (evtest.keys(machine).last() == Some(&(H, false))).then_some(())
    });
    let up = ["KEYBOARD_KEY", "KEY_H (35) released"];
    scene.libinput.wait_for(&mut scene.machine, &up);
}
