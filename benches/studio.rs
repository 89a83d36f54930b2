//! The window of Studio: time to the first frame, frames per second, processor time and memory, and the delay of events
//! with and without it.
//!
//! The program draws on an X server without a graphics card (`LIBGL_ALWAYS_SOFTWARE`), so the figures stand for the
//! slowest machine. Mesa counts the frames (`GALLIUM_HUD`). A glove types on a pseudo terminal.
//!
//! Prints tables. Without `--bench` (as in `cargo test --benches`) each row takes a moment only. Needs `--features studio`.

#[cfg(target_os = "linux")]
#[path = "../tests/support/mod.rs"]
mod support;

#[cfg(target_os = "linux")]
#[path = "studio/glove.rs"]
mod glove;

#[cfg(target_os = "linux")]
#[path = "studio/latency.rs"]
mod latency;

#[cfg(target_os = "linux")]
#[path = "support/packets.rs"]
mod packets;

#[cfg(target_os = "linux")]
#[path = "studio/rows.rs"]
mod rows;

#[cfg(target_os = "linux")]
#[path = "studio/window.rs"]
mod window;

#[cfg(target_os = "linux")]
fn main() {
    let has = |name| std::env::args().any(|argument| argument == name);
    let is_test = !has("--bench");
    if has(latency::ARGUMENT) {
        return latency::measure(is_test);
    }
    let Some(server) = support::x11::XServer::with_screen(window::SCREEN) else {
        return;
    };
    rows::print(&server, is_test);
    latency::print(&server, is_test);
}

#[cfg(not(target_os = "linux"))]
fn main() {
    println!("studio: SKIPPED: it needs Linux");
}
