//! The whole way onto a Wayland desktop: `sway` without a screen, `foot` as the program that is typed into, `wev` as
//! the one that tells what reaches a window. Nothing stays down, however it ends.
//!
//! `cargo test --features wayland --test outputs wayland::`; on Debian: `sway foot wev weston`.

mod compositor;
mod ends;
mod floods;
mod pointer;
mod refusals;
mod text;
mod window;
