//! However it ends while a key is held: nothing stays down.

use std::path::PathBuf;
use std::time::Duration;

use tempfile::TempDir;

use super::compositor::Compositor;
use super::window::Window;
use crate::support::glove::Glove;
use crate::support::press::Press;
use crate::support::program::Program;
use crate::support::x11::{wait_at_most, wait_for};

/// A program with a glove.
struct Worn {
    program: Program,
    glove: Glove,
    _folder: TempDir,
}

impl Worn {
    /// A run whose wearer holds the hand still, above the keys.
    fn start(compositor: &Compositor, press: &Press, arguments: &[&str]) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let port = folder.path().join("glove");
        let glove = Glove::plug_in(&port, press.clear());
        let source = format!("serial:{}", port.display());
        let run = ["run", "--output", "desktop", "--source", &source];
        let program = compositor.run([&run, arguments].concat());
        program.wait_for_line("armed", 1);
        Self {
            program,
            glove,
            _folder: folder,
        }
    }

    /// Lets the wearer press until the window has heard it.
    fn hold(&self, press: &Press, window: &Window, line: &str) {
        let is_held = || {
            self.glove.play(&press.approach);
            wait_at_most(Duration::from_secs(5), || {
                window.heard().last().is_some_and(|last| last == line)
            })
        };
        assert!(wait_for(is_held), "{:#?}", window.heard());
    }
}

/// A run whose wearer holds Shift and H, a second one, whose wearer does nothing, as the user at another
/// keyboard, and a window that hears them.
struct Typing {
    window: Window,
    typing: Worn,
    other: Worn,
    _compositor: Compositor,
}

impl Typing {
    fn start() -> Option<Self> {
        let compositor = Compositor::sway()?;
        let window = Window::open(&compositor)?;
        let press = Press::for_text("H");
        let other = Worn::start(&compositor, &press, &[]);
        let typing = Worn::start(&compositor, &press, &[]);
        typing.hold(&press, &window, "down H");
        Some(Self {
            window,
            typing,
            other,
            _compositor: compositor,
        })
    }

    /// What the window hears once the run has ended by a signal, and its exit code.
    fn end_by(&mut self, signal: &str) -> (Vec<String>, Option<i32>) {
        let before = self.window.heard().len();
        self.typing.program.signal(&[signal]);
        let code = self.typing.program.wait_for_exit().code();
        let since = || self.window.heard()[before..].to_vec();
        let is_free = || {
            ["up H", "up Shift_L"]
                .iter()
                .all(|up| since().contains(&(*up).to_owned()))
        };
        assert!(wait_for(is_free), "{:#?}", self.window.heard());
        println!("{signal}: {:?}", since());
        (since(), code)
    }
}

#[test]
fn nothing_is_down_after_the_system_asked_it_to_end() {
    let Some(mut typing) = Typing::start() else {
        return;
    };
    let (_, code) = typing.end_by("TERM");
    assert_eq!(code, Some(0));
    let heard = typing.window.heard_until("held -");
    assert!(
        heard.ends_with(&["up H", "up Shift_L", "held -"].map(String::from)),
        "{heard:#?}"
    );
}

#[test]
fn nothing_is_down_after_it_was_killed_and_shift_does_not_count_for_the_next_key() {
    let Some(mut typing) = Typing::start() else {
        return;
    };
    let (_, code) = typing.end_by("KILL");
    assert_eq!(code, None);
    typing
        .other
        .hold(&Press::for_text("h"), &typing.window, "down h");
    let heard = typing.window.heard();
    assert!(
        heard.ends_with(&["held -", "down h"].map(String::from)),
        "{heard:#?}"
    );
}

#[test]
fn nothing_is_down_while_it_is_stopped_and_afterwards_it_types_on() {
    let Some(mut typing) = Typing::start() else {
        return;
    };
    typing.typing.program.signal(&["STOP"]);
    assert!(typing.window.hears("up H"), "{:#?}", typing.window.heard());
    assert!(
        typing.window.hears("held -"),
        "{:#?}",
        typing.window.heard()
    );
    typing
        .typing
        .program
        .wait_for_line("released its keys (2)", 1);
    // Shift does not count for the next key, though its keyboard is still there.
    typing
        .other
        .hold(&Press::for_text("h"), &typing.window, "down h");
    typing.other.glove.play(&Press::for_text("h").lift);
    assert!(typing.window.hears("up h"), "{:#?}", typing.window.heard());
    typing.typing.program.signal(&["CONT"]);
    typing.typing.program.wait_for_line("stalled", 1);
    let press = Press::for_text("H");
    typing.typing.glove.play(&press.lift);
    typing.typing.program.wait_for_line("armed", 2);
    typing.typing.hold(&press, &typing.window, "down H");
    let (_, code) = typing.end_by("TERM");
    assert_eq!(code, Some(0));
}

/// The default layout with the left mouse button in the place of H.
fn layout_with_a_button(folder: &TempDir) -> PathBuf {
    let path = folder.path().join("button.ron");
    let board = include_str!("../../../layouts/keyboards/qwerty-flat.ron");
    let with_button = board.replace(" G H J ", " G MouseLeft J ");
    assert_ne!(board, with_button);
    std::fs::write(&path, with_button).expect("room on the disk");
    path
}

/// A window, and a run whose wearer holds the left mouse button.
fn with_a_held_button() -> Option<(Compositor, Window, Worn)> {
    let compositor = Compositor::sway()?;
    let window = Window::open(&compositor)?;
    let folder = tempfile::tempdir().expect("a folder");
    let layout = layout_with_a_button(&folder).display().to_string();
    let press = Press::for_text("h");
    let typing = Worn::start(&compositor, &press, &["--layout", &layout]);
    typing.hold(&press, &window, "button 272 down");
    Some((compositor, window, typing))
}

#[test]
fn no_button_is_down_after_the_system_asked_it_to_end() {
    let Some((_compositor, window, mut typing)) = with_a_held_button() else {
        return;
    };
    typing.program.signal(&["TERM"]);
    assert_eq!(typing.program.wait_for_exit().code(), Some(0));
    assert!(window.hears("button 272 up"), "{:#?}", window.heard());
}

#[test]
fn no_button_is_down_while_it_is_stopped() {
    let Some((_compositor, window, mut typing)) = with_a_held_button() else {
        return;
    };
    typing.program.signal(&["STOP"]);
    assert!(window.hears("button 272 up"), "{:#?}", window.heard());
    typing.program.signal(&["CONT", "TERM"]);
    assert_eq!(typing.program.wait_for_exit().code(), Some(0));
}

#[test]
fn no_button_is_down_after_it_was_killed() {
    let Some((_compositor, window, mut typing)) = with_a_held_button() else {
        return;
    };
    typing.program.signal(&["KILL"]);
    assert_eq!(typing.program.wait_for_exit().code(), None);
    assert!(window.hears("button 272 up"), "{:#?}", window.heard());
}
