//! The whole way onto a Wayland desktop: `sway` without a screen, `foot` as the program that is typed into, `wev` as
//! the one that tells what reaches a window. Nothing stays down, however it ends.
//!
//! `cargo test --features wayland --test wayland`; on Debian: `sway foot wev weston`.

#[path = "../support/mod.rs"]
mod support;

#[path = "../desktop/glove.rs"]
#[allow(dead_code, reason = "the tests on X11 use more of it")]
mod glove;
#[path = "../desktop/press.rs"]
#[allow(dead_code, reason = "the tests on X11 use more of it")]
mod press;
#[path = "../desktop/program.rs"]
#[allow(dead_code, reason = "the tests on X11 use more of it")]
mod program;

mod compositor;
mod ends;
mod floods;
mod pointer;
mod refusals;
mod text;
mod window;
