//! Release of keys and buttons at the end of a run, however it ends.

use std::time::Duration;

use tempfile::TempDir;

use super::compositor::Compositor;
use super::window::Window;
use crate::support::glove::Glove;
use crate::support::press::Press;
use crate::support::program::{Program, WATCHDOG_LOST};
use crate::support::x11::{wait_at_most, wait_for};
use crate::x11::ends::layout_with_a_button;
use crate::x11::start_until;

/// A run with a glove.
pub(super) struct GloveRun {
    pub(super) program: Program,
    pub(super) glove: Glove,
    _folder: TempDir,
}

impl GloveRun {
    /// Starts a run whose wearer keeps the hand clear of all keys.
    pub(super) fn start(compositor: &Compositor, press: &Press, arguments: &[&str]) -> Self {
        let (folder, glove, source) = Glove::in_new_folder(press.clear());
        let run = ["run", "--output", "desktop", "--source", &source];
        let program = compositor.run([&run, arguments].concat());
        program.wait_for_line("armed", 1);
        Self {
            program,
            glove,
            _folder: folder,
        }
    }

    /// Repeats a press until the last event of the window is `line`.
    fn hold(&self, press: &Press, window: &Window, line: &str) {
        let is_held = self.is_held_at_last(press, window, line);
        assert!(is_held, "{:#?}", self.program.stderr_lines());
    }

    /// Repeats a press as [`hold`](Self::hold) does. Returns `false` if the run loses its watchdog, as on a busy machine: no press
    /// arrives until it is resumed.
    fn is_held_at_last(&self, press: &Press, window: &Window, line: &str) -> bool {
        let mut is_held = false;
        let is_over = wait_for(|| {
            self.glove.play(&press.approach);
            wait_at_most(Duration::from_secs(5), || {
                is_held = window.events().last().is_some_and(|last| last == line);
                is_held || self.program.count_lines(WATCHDOG_LOST) > 0
            })
        });
        assert!(is_over, "{:#?}", window.events());
        is_held
    }
}

/// A run whose wearer holds Shift and H, a second one as another keyboard, and a window that receives their events.
pub(super) struct Typing {
    pub(super) window: Window,
    pub(super) typing: GloveRun,
    other: GloveRun,
    pub(super) compositor: Compositor,
}

impl Typing {
    pub(super) fn start() -> Option<Self> {
        let press = Press::for_text("H");
        let is_holding = |it: &Self| it.typing.is_held_at_last(&press, &it.window, "down H");
        start_until(|| Self::start_armed(&press), is_holding)
    }

    /// Starts the runs and waits until they are armed.
    fn start_armed(press: &Press) -> Option<Self> {
        let compositor = Compositor::sway()?;
        let window = Window::open(&compositor)?;
        let other = GloveRun::start(&compositor, press, &[]);
        let typing = GloveRun::start(&compositor, press, &[]);
        Some(Self {
            window,
            typing,
            other,
            compositor,
        })
    }

    /// Ends the run by a signal. Returns the later events of the window and the exit code.
    fn end_by(&mut self, signal: &str) -> (Vec<String>, Option<i32>) {
        let before = self.window.events().len();
        self.typing.program.signal(&[signal]);
        let code = self.typing.program.wait_for_exit().code();
        let since = || self.window.events()[before..].to_vec();
        let are_released = || {
            ["up H", "up Shift_L"]
                .iter()
                .all(|up| since().contains(&(*up).to_owned()))
        };
        assert!(wait_for(are_released), "{:#?}", self.window.events());
        println!("{signal}: {:?}", since());
        (since(), code)
    }
}

#[test]
fn all_keys_are_released_after_sigterm() {
    let Some(mut typing) = Typing::start() else {
        return;
    };
    let (_, code) = typing.end_by("TERM");
    assert_eq!(code, Some(0));
    let events = typing.window.events_until("held -");
    assert!(
        events.ends_with(&["up H", "up Shift_L", "held -"].map(String::from)),
        "{events:#?}"
    );
}

#[test]
fn all_keys_are_released_after_a_kill_and_shift_does_not_affect_the_next_key() {
    let Some(mut typing) = Typing::start() else {
        return;
    };
    let (_, code) = typing.end_by("KILL");
    assert_eq!(code, None);
    typing
        .other
        .hold(&Press::for_text("h"), &typing.window, "down h");
    let events = typing.window.events();
    assert!(
        events.ends_with(&["held -", "down h"].map(String::from)),
        "{events:#?}"
    );
}

#[test]
fn all_keys_are_released_while_the_program_is_stopped_and_it_types_again_afterwards() {
    let Some(mut typing) = Typing::start() else {
        return;
    };
    typing.typing.program.signal(&["STOP"]);
    assert!(
        typing.window.has_all_releases(),
        "{:#?}",
        typing.window.events()
    );
    typing
        .typing
        .program
        .wait_for_line("released its keys (2)", 1);
    // Shift does not affect the next key, although its keyboard still exists.
    typing
        .other
        .hold(&Press::for_text("h"), &typing.window, "down h");
    typing.other.glove.play(&Press::for_text("h").lift);
    assert!(
        typing.window.receives("up h"),
        "{:#?}",
        typing.window.events()
    );
    typing.typing.program.signal(&["CONT"]);
    typing.typing.program.wait_for_line("stalled", 1);
    let press = Press::for_text("H");
    typing.typing.glove.play(&press.lift);
    typing.typing.program.wait_for_line("armed", 2);
    typing.typing.hold(&press, &typing.window, "down H");
    let (_, code) = typing.end_by("TERM");
    assert_eq!(code, Some(0));
}

/// Starts a window, and a run whose wearer holds the left mouse button.
fn start_with_button() -> Option<(Compositor, Window, GloveRun)> {
    let folder = tempfile::tempdir().expect("a folder");
    let layout = layout_with_a_button(folder.path()).display().to_string();
    let press = Press::for_text("h");
    let start_armed = || {
        let compositor = Compositor::sway()?;
        let window = Window::open(&compositor)?;
        let typing = GloveRun::start(&compositor, &press, &["--layout", &layout]);
        Some((compositor, window, typing))
    };
    start_until(start_armed, |(_, window, typing)| {
        typing.is_held_at_last(&press, window, "button 272 down")
    })
}

#[test]
fn all_buttons_are_released_after_sigterm() {
    let Some((_compositor, window, mut typing)) = start_with_button() else {
        return;
    };
    typing.program.signal(&["TERM"]);
    assert_eq!(typing.program.wait_for_exit().code(), Some(0));
    assert!(window.receives("button 272 up"), "{:#?}", window.events());
}

#[test]
fn all_buttons_are_released_while_the_program_is_stopped() {
    let Some((_compositor, window, mut typing)) = start_with_button() else {
        return;
    };
    typing.program.signal(&["STOP"]);
    assert!(window.receives("button 272 up"), "{:#?}", window.events());
    typing.program.signal(&["CONT", "TERM"]);
    assert_eq!(typing.program.wait_for_exit().code(), Some(0));
}

#[test]
fn all_buttons_are_released_after_a_kill() {
    let Some((_compositor, window, mut typing)) = start_with_button() else {
        return;
    };
    typing.program.signal(&["KILL"]);
    assert_eq!(typing.program.wait_for_exit().code(), None);
    assert!(window.receives("button 272 up"), "{:#?}", window.events());
}
