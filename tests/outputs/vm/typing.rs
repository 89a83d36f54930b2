//! A keyboard whose glove is unplugged, and whose program is killed, while a key is held.

use super::Scene;
use super::glove::Deed;
use super::witness::Evtest;

const LAYOUT: &str = "qwerty-flat";
const KEYBOARD: &str = "Ademan keyboard";
const H: u16 = 35;

pub fn all(scene: &mut Scene) {
    let text = Deed::typing(LAYOUT, "Hola, 1!");
    let press = Deed::playing(LAYOUT, "press H; wait 500; lift");
    scene.machine.plug_in("glove");
    scene.start_program(LAYOUT);
    let evtest = scene.evtest(KEYBOARD);
    let added = format!("{} DEVICE_ADDED {KEYBOARD}", evtest.node);
    let line = scene.libinput.wait_for(&mut scene.machine, &[&added]);
    assert!(line.ends_with("cap:k"), "{line}");
    scene.report("libinput takes the keyboard for one");

    scene.arm(&text, 1);
    types(scene, &evtest, &text);
    scene.report("what is typed through a USB serial adapter comes out of the kernel, key by key");

    hold(scene, &evtest, &press);
    scene.machine.press(&["ctrl"]);
    scene.machine.press(&["ctrl", "ctrl_r"]);
    released(scene, &evtest);
    scene.wait_until_said("paused: everything is released", 1);
    scene.report("two keys of the machine's own keyboard let go of what the hand holds, and pause");
    scene.machine.run("ademan ctl resume --socket /tmp/control");
    scene.arm(&text, 2);

    hold(scene, &evtest, &press);
    scene.glove.stop_sending();
    scene.machine.unplug("glove");
    released(scene, &evtest);
    scene.report("a cable that is pulled while a key is held lets go of it");

    scene.machine.plug_in("glove");
    scene.wait_until_said("reconnected to", 1);
    scene.arm(&text, 3);
    types(scene, &evtest, &text);
    scene.report("plugged in again, it types on");

    hold(scene, &evtest, &press);
    scene.glove.stop_sending();
    scene.machine.unplug("glove");
    released(scene, &evtest);
    scene.machine.plug_in("other");
    scene.machine.wait_for("a stranger at its port", |machine| {
        machine
            .run("ls /dev/ttyUSB0")
            .starts_with('/')
            .then_some(())
    });
    scene.machine.plug_in("glove");
    scene.wait_until_said("reconnected to .* at .*/dev/ttyUSB1", 1);
    scene.arm(&text, 4);
    types(scene, &evtest, &text);
    scene.report("plugged in again with another adapter in its place, it is found under another name and types on");

    hold(scene, &evtest, &press);
    scene.machine.run("kill -STOP $(cat /tmp/ademan.pid)");
    released(scene, &evtest);
    scene.wait_until_said("does not respond; released its keys (1)", 1);
    scene.machine.run("kill -CONT $(cat /tmp/ademan.pid)");
    scene.report("a guardian lets go of what a stopped program holds");
    types(scene, &evtest, &text);
    scene.report("and when that goes on, it types on");

    hold(scene, &evtest, &press);
    scene.machine.run("kill -KILL $(cat /tmp/ademan.pid)");
    released(scene, &evtest);
    scene
        .libinput
        .wait_for(&mut scene.machine, &[&evtest.node, "DEVICE_REMOVED"]);
    scene.report("what a killed program held is let go of, and its device goes away");
    scene.glove.stop_sending();
    scene.machine.unplug("other");
    scene.machine.unplug("glove");
    scene.machine.plug_in("glove");
}

/// Types, and compares every key event.
fn types(scene: &mut Scene, evtest: &Evtest, text: &Deed) {
    let before = evtest.keys(&mut scene.machine).len();
    let expected = text.keys();
    scene.glove.play(text.whole());
    scene.machine.wait_for("all of the text", |machine| {
        (evtest.keys(machine).len() >= before + expected.len()).then_some(())
    });
    assert_eq!(evtest.keys(&mut scene.machine)[before..], expected);
}

/// Holds the key H.
fn hold(scene: &mut Scene, evtest: &Evtest, press: &Deed) {
    scene.libinput.forget(&mut scene.machine);
    scene.glove.play(press.until_held());
    scene.machine.wait_for("a key that is down", |machine| {
        (evtest.keys(machine).last() == Some(&(H, true))).then_some(())
    });
}

/// Waits until the key H is up, for the kernel and for libinput.
fn released(scene: &mut Scene, evtest: &Evtest) {
    scene.machine.wait_for("a key that is up", |machine| {
        (evtest.keys(machine).last() == Some(&(H, false))).then_some(())
    });
    let up = ["KEYBOARD_KEY", "KEY_H (35) released"];
    scene.libinput.wait_for(&mut scene.machine, &up);
}
