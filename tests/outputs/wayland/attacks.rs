//! Attacks on the program and on the compositor at the same time.

use super::ends::Typing;
use crate::support::process::signal;

/// Waits until the window has received the releases of both keys.
fn check_release(typing: &Typing, what: &str) {
    for up in ["up H", "up Shift_L"] {
        assert!(
            typing.window.receives(up),
            "{what}: {:#?}",
            typing.window.events()
        );
    }
}

#[test]
fn all_keys_are_released_after_program_and_watchdog_are_killed_together() {
    let Some(typing) = Typing::start() else {
        return;
    };
    let watchdogs = typing.typing.program.children();
    assert_eq!(watchdogs.len(), 1);
    // Without the watchdog, only the compositor can release the keys.
    typing.typing.program.signal(&["STOP"]);
    signal("KILL", watchdogs[0]);
    typing.typing.program.signal(&["KILL"]);
    check_release(&typing, "killed together");
}

#[test]
fn all_keys_are_released_when_a_compositor_continues_that_hung_while_the_program_was_killed() {
    let Some(mut typing) = Typing::start() else {
        return;
    };
    typing.compositor.stop();
    typing.typing.program.signal(&["KILL"]);
    assert_eq!(typing.typing.program.wait_for_exit().code(), None);
    typing.compositor.resume();
    check_release(&typing, "killed while the compositor hung");
}
