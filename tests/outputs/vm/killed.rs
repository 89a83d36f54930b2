//! Attacks on the processes of the program while a key of a uinput device is pressed.

use super::Scene;
use super::glove::HandMotion;
use super::typing::{KEYBOARD, LAYOUT, hold, released};

/// A pipe that is full, and that no process reads.
const FULL_PIPE: &str = "/tmp/full";

pub fn all(scene: &mut Scene) {
    let press = HandMotion::scripted(LAYOUT, "press H; wait 500; lift");
    stopped_watchdog(scene, &press);
    both_killed(scene, &press);
    blocked_stderr(scene, &press);
}

fn stopped_watchdog(scene: &mut Scene, press: &HandMotion) {
    scene.start_program(LAYOUT);
    scene.arm(press, 1);
    let evtest = scene.evtest(KEYBOARD);
    hold(scene, &evtest, press);
    scene
        .machine
        .run("kill -STOP $(cat /proc/$(cat /tmp/ademan.pid)/task/*/children)");
    released(scene, &evtest);
    scene.wait_for_line("the watchdog exited or hangs", 1);
    scene.report("the program releases uinput keys when its watchdog is stopped");
    scene.machine.run("ademan ctl resume --socket /tmp/control");
    scene.arm(press, 2);
    hold(scene, &evtest, press);
    scene.end_program();
    released(scene, &evtest);
}

fn both_killed(scene: &mut Scene, press: &HandMotion) {
    scene.start_program(LAYOUT);
    scene.arm(press, 1);
    let evtest = scene.evtest(KEYBOARD);
    hold(scene, &evtest, press);
    // The stopped program cannot release a key when the watchdog is killed first.
    scene
        .machine
        .run("kill -STOP $(cat /tmp/ademan.pid); kill -KILL $(pidof key-watchdog) $(pidof ademan)");
    released(scene, &evtest);
    scene
        .libinput
        .wait_for(&mut scene.machine, &[&evtest.node, "DEVICE_REMOVED"]);
    let log = scene.machine.run("cat /tmp/ademan.log");
    assert!(!log.contains("released its keys"), "{log}");
    scene.report("the kernel releases uinput keys when both processes are killed");
    scene.glove.stop_sending();
}

fn blocked_stderr(scene: &mut Scene, press: &HandMotion) {
    scene.machine.run(&format!(
        "mkfifo {FULL_PIPE}; sleep 3600 <>{FULL_PIPE} >/dev/null 2>&1 & timeout 2 cat /dev/zero >{FULL_PIPE}"
    ));
    scene.launch(LAYOUT, FULL_PIPE);
    scene.glove.play(press.clear());
    scene.machine.wait_for("an armed program", |machine| {
        let state = machine.run("ademan ctl state --socket /tmp/control");
        state.contains("running").then_some(())
    });
    let evtest = scene.evtest(KEYBOARD);
    hold(scene, &evtest, press);
    scene.glove.stop_sending();
    scene.machine.unplug("glove");
    released(scene, &evtest);
    scene.report("pulling the cable releases uinput keys while standard error is full");
    scene.machine.run("kill -TERM $(cat /tmp/ademan.pid)");
    scene.machine.wait_for("the end of the program", |machine| {
        machine.run("pidof ademan").is_empty().then_some(())
    });
    scene.report("one SIGTERM ends the program while standard error is full");
    scene.machine.plug_in("glove");
}
