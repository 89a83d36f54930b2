//! Attacks on the program and on the compositor at the same time.

use super::ends::{GloveRun, Typing};
use crate::support::process::signal;

/// Waits until the window has received the releases of both keys.
fn check_release(typing: &Typing, what: &str) {
    assert!(
        typing.window.has_all_releases(),
        "{what}: {:#?}",
        typing.window.events()
    );
}

/// Kills a run and its watchdog. The run is stopped first: alone, it would release its keys.
fn kill_both(run: &GloveRun) {
    let [watchdog] = run.program.children()[..] else {
        panic!("one child: {:?}", run.program.children());
    };
    run.program.signal(&["STOP"]);
    signal("KILL", watchdog);
    run.program.signal(&["KILL"]);
}

#[test]
fn all_keys_are_released_after_program_and_watchdog_are_killed_together() {
    let Some(typing) = Typing::start() else {
        return;
    };
    // Without the watchdog, only the compositor can release the keys.
    kill_both(&typing.typing);
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

#[test]
fn all_keys_are_released_when_the_watchdog_is_stopped_and_the_run_pauses() {
    let Some(typing) = Typing::start() else {
        return;
    };
    let [watchdog] = typing.typing.program.children()[..] else {
        panic!("one child: {:?}", typing.typing.program.children());
    };
    signal("STOP", watchdog);
    check_release(&typing, "watchdog stopped");
    typing.typing.program.wait_for_line("paused", 2);
}
