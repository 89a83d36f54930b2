//! Wayland: events arrive in other programs, and no key stays pressed, however the program ends. `sway` runs headless,
//! `foot` is the terminal that receives text, and `wev` prints the events of a window.
//!
//! `cargo test --features wayland --test outputs wayland::`; on Debian, install `sway foot wev weston`.

mod attacks;
pub mod compositor;
mod ends;
mod floods;
mod focus;
mod output_stalls;
mod pointer;
mod refusals;
mod text;
pub mod window;
