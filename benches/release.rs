//! How long keys stay down after something went wrong: the worst of many times, for each cause.
//!
//! The real program with a glove on a pseudo terminal holds H, and somebody who knows nothing of the program watches
//! the keyboard until nothing is down. Each time it is another program; nothing of the last one is left. Goals are
//! bounds that a user would notice. `cargo bench --bench release` does it 200 times for each cause on an X server,
//! which takes some minutes; `-- wayland 20` less often at a compositor (feature `wayland`), `-- uinput` on devices of
//! the kernel where there may be some: `tests/outputs/vm/run release 20`. As a test (`cargo test --bench release`) it is done
//! once.

#[cfg(not(target_os = "linux"))]
fn main() {
    println!("SKIPPED: a guardian is there on Linux");
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

/// As the program says what it has to say.
#[cfg(target_os = "linux")]
macro_rules! say {
    ($($text:tt)*) => { eprintln!("ademan: {}", format!($($text)*)) };
}
#[cfg(target_os = "linux")]
#[path = "../src/bin/ademan/failure.rs"]
#[allow(dead_code)]
mod failure;
#[cfg(target_os = "linux")]
#[path = "../src/bin/ademan/panics.rs"]
#[allow(dead_code, unused_imports)]
mod panics;
#[cfg(target_os = "linux")]
#[path = "../src/bin/ademan/signals.rs"]
#[allow(dead_code)]
mod signals;

#[cfg(target_os = "linux")]
#[path = "release/breaking.rs"]
mod breaking;
#[cfg(target_os = "linux")]
#[path = "release/causes.rs"]
mod causes;
#[cfg(target_os = "linux")]
#[path = "release/load.rs"]
mod load;
#[cfg(target_os = "linux")]
#[path = "release/place.rs"]
mod place;
#[cfg(target_os = "linux")]
#[path = "release/scene.rs"]
mod scene;

#[cfg(target_os = "linux")]
fn main() {
    causes::main();
}
