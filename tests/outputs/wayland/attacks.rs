//! Attacks on the program and on the compositor at the same time.

use super::compositor::Compositor;
use super::ends::{GloveRun, Typing, layout_with_a_button};
use super::window::Window;
use crate::support::press::Press;
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
fn a_button_of_a_run_that_was_killed_with_its_watchdog_is_released_by_the_command_of_the_unit() {
    let Some(compositor) = Compositor::sway() else {
        return;
    };
    let Some(window) = Window::open(&compositor) else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let layout = layout_with_a_button(&folder).display().to_string();
    let runtime = ("XDG_RUNTIME_DIR", folder.path());
    let press = Press::for_text("h");
    let mut run = GloveRun::start_in(&compositor, &press, &["--layout", &layout], Some(runtime));
    run.hold(&press, &window, "button 272 down");
    kill_both(&run);
    assert_eq!(run.program.wait_for_exit().code(), None);
    // The compositor does not release it.
    std::thread::sleep(std::time::Duration::from_secs(1));
    let events = window.events();
    println!("before the command: {events:?}");
    let mut command = compositor.ademan(["release-keys"]);
    let output = command
        .env(runtime.0, runtime.1)
        .output()
        .expect("it starts");
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(
        message.contains("released the keys of a killed run (1)"),
        "{message}"
    );
    assert!(window.receives("button 272 up"), "{:#?}", window.events());
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
