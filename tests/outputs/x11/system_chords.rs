//! Chords that act on the system, from switches that hold their keys.

use super::{is_pressing, repeat};
use crate::support::press::x11_code;
use crate::support::program::Program;
use crate::support::x11::XServer;

/// The layout with the switches `Delete`, `Control` and `Alt`.
const LAYOUT: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/tests/scenarios/system-chords.ron"
);

/// The orders of the switches.
const ORDERS: [&str; 3] = [
    "tap Delete; tap Control; tap Alt",
    "tap Alt; tap Delete; tap Control",
    "tap Control; tap Alt; tap Delete",
];

#[test]
fn switches_in_any_order_leave_control_and_alt_pressed_but_not_delete() {
    let Some(server) = XServer::start() else {
        return;
    };
    for order in ORDERS {
        println!("{order}");
        let source = format!("script:{order}; wait 60000");
        let arguments = [
            "run", "--layout", LAYOUT, "--source", &source, "--output", "desktop",
        ];
        let modifiers = ["ControlLeft", "AltLeft"].map(x11_code);
        repeat(|| {
            let mut program = Program::start(&server, arguments);
            let has_pressed = is_pressing(&server, &program, &modifiers);
            if has_pressed {
                program.wait_for_line("1 key suppressed that would act on the system", 1);
            }
            program.signal(&["TERM"]);
            program.wait_for_exit();
            assert_eq!(server.pressed_keys(), [0; 0], "{order}");
            has_pressed
        });
    }
}
