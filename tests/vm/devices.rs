//! Every device that the program makes, and what a hand does with it.

use crate::Scene;
use crate::glove::Deed;
use crate::machine::Machine;
use crate::witness::Evtest;

const DEVICES: &str = "devices.ron";
const SCREEN: &str = "screen.ron";

pub fn all(scene: &mut Scene) {
    four_devices(scene);
    a_screen_alone(scene);
}

fn four_devices(scene: &mut Scene) {
    let script = "tap H; press Pad -20 0; slide 40 0 600; slide 0 15 300; lift; tap MouseRight; \
                  press Wheel; slide 0 20 600; slide 0 -20 600; lift; \
                  press Screen -20 -15; slide 40 30 600; lift; \
                  press Stick; slide 12 0 400; slide -12 12 400; lift; tap PadSouth";
    let deed = Deed::playing(&of_test(DEVICES), script);
    scene.start_program(&in_machine(DEVICES));
    let [keyboard, mouse, pointer, gamepad] = ["keyboard", "mouse", "pointer", "gamepad"].map(|kind| scene.evtest(&format!("Ademan {kind}")));
    for (evtest, kind, capabilities) in [(&keyboard, "keyboard", "cap:k"), (&mouse, "mouse", "cap:p"), (&pointer, "pointer", "cap:p")] {
        let added = format!("{} DEVICE_ADDED Ademan {kind}", evtest.node);
        let line = scene.libinput.wait_for(&mut scene.machine, &[&added]);
        assert!(line.contains(&format!(" {capabilities}")) && !line.contains("cap:kp"), "{line}");
    }
    scene.arm(&deed, 1);
    scene.glove.play(deed.whole());
    scene.machine.wait_for("the last button", |machine| {
        let heard = gamepad.heard(machine);
        heard.iter().any(|event| event.name == "BTN_SOUTH" && event.value == 0).then_some(())
    });
    println!("{}", scene.machine.run("cat /tmp/evtest-*; cat /tmp/libinput.log; cat /tmp/ademan.log"));
    scene.end_program();
}

fn a_screen_alone(scene: &mut Scene) {
}

/// A layout beside this file, on this machine.
fn of_test(layout: &str) -> String {
    format!("{}/tests/vm/{layout}", env!("CARGO_MANIFEST_DIR"))
}

/// The same in the machine.
fn in_machine(layout: &str) -> String {
    format!("/etc/{layout}")
}
