//! Release times: how long a key stays pressed after a failure, as median and maximum per cause.
//!
//! The program, with a glove on a pseudo terminal, holds H, and an independent observer watches the keyboard until no key
//! is pressed. Each measurement starts a new program. The goals are bounds that a user would notice.
//!
//! `cargo bench --bench release` measures each cause 200 times on an X server, which takes some minutes. `-- wayland 20`
//! measures 20 times on a compositor (feature `wayland`), and `-- uinput` on kernel devices, where they are available:
//! `tests/outputs/vm/run release 20`. `-- busy 20` measures on a busy machine, with and without the priority that the
//! program takes; it uses all processors for seconds and needs root. As a test (`cargo test --bench release`) it measures each cause once.

#[cfg(not(target_os = "linux"))]
fn main() {
    println!("SKIPPED: the watchdog needs Linux");
}

#[cfg(target_os = "linux")]
#[path = "../tests/support/mod.rs"]
mod support;

#[cfg(all(target_os = "linux", feature = "wayland"))]
#[path = "../tests/outputs/wayland/compositor.rs"]
#[allow(dead_code)]
mod compositor;
#[cfg(all(target_os = "linux", feature = "wayland"))]
#[path = "../tests/outputs/wayland/window.rs"]
#[allow(dead_code)]
mod window;

/// Prints an error as the binary does.
#[cfg(target_os = "linux")]
macro_rules! complain {
    ($($message:tt)*) => {
        crate::messages::print_error(&format!($($message)*))
    };
}
#[cfg(target_os = "linux")]
#[path = "../src/bin/ademan/failure.rs"]
#[allow(dead_code)]
mod failure;
#[cfg(target_os = "linux")]
#[path = "../src/bin/ademan/messages/mod.rs"]
#[allow(dead_code, unused_imports)]
mod messages;
#[cfg(all(test, target_os = "linux"))]
#[path = "../src/bin/ademan/own_process.rs"]
mod own_process;
#[cfg(target_os = "linux")]
#[path = "../src/bin/ademan/panics.rs"]
#[allow(dead_code, unused_imports)]
mod panics;
#[cfg(target_os = "linux")]
#[path = "../src/bin/ademan/signals.rs"]
#[allow(dead_code)]
mod signals;

#[cfg(target_os = "linux")]
#[path = "release/panic.rs"]
mod panic;
#[cfg(target_os = "linux")]
#[path = "release/busy.rs"]
mod busy;
#[cfg(target_os = "linux")]
#[path = "release/causes.rs"]
mod causes;
#[cfg(target_os = "linux")]
#[path = "release/load.rs"]
mod load;
#[cfg(target_os = "linux")]
#[path = "release/target.rs"]
mod target;
#[cfg(target_os = "linux")]
#[path = "release/scenario.rs"]
mod scenario;

#[cfg(target_os = "linux")]
fn main() {
    causes::main();
}
