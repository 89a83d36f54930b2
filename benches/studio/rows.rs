//! The table of windows: what each shows, and what it takes of the machine.

use std::fs;
use std::path::Path;
use std::thread;
use std::time::Duration;

use super::glove::Glove;
use super::support::x11::XServer;
use super::window::Window;

/// Keys of the largest layout in a row, and rows.
const KEYS: usize = 100;

/// Distance of its keys, in millimetres.
const PITCH_MM: usize = 3;

/// Codes of its keys, which repeat.
const CODES: [&str; 4] = ["A", "S", "D", "F"];

/// Time after which a window has drawn everything once, and a glove that is silent counts as lost.
const SETTLING: Duration = Duration::from_secs(2);

/// Prints the table. A test observes each window for a moment.
pub fn print(server: &XServer, is_test: bool) {
    let time = Duration::from_millis(if is_test { 600 } else { 10_000 });
    let folder = tempfile::tempdir().expect("a folder");
    let keys = folder.path().join("keys.ron");
    write_layout(&keys);
    let keys = keys.to_str().expect("a folder with a plain name");
    println!("| window | first frame | frames per second | of a core | memory | peak |");
    println!("|---|---|---|---|---|---|");
    println!("| goal | 1 s | 20; 10 with 10 000 keys | 100 % | 250 MB | 250 MB |");
    row("the simulated hand", &Window::open(server, []), time);
    let glove = Glove::start();
    let window = Window::open(server, ["--source", &glove.source]);
    row("a glove at 175 Hz", &window, time);
    glove.fall_silent();
    row("a glove that is silent", &window, time);
    drop(window);
    let keyed_glove = Glove::start();
    let arguments = ["--source", &keyed_glove.source, "--layout", keys];
    row("10 000 keys", &Window::open(server, arguments), time);
}

fn row(name: &str, window: &Window, time: Duration) {
    thread::sleep(SETTLING.min(time));
    let usage = window.observe(time);
    println!(
        "| {name} | {:.2} s | {:.1} | {:.0} % | {:.0} MB | {:.0} MB |",
        window.opening.as_secs_f64(),
        usage.frames_per_s,
        usage.processor * 1e2,
        usage.memory_mb,
        usage.peak_mb
    );
}

/// Writes a layout of small keys around the hand.
fn write_layout(path: &Path) {
    let at_mm = |index: usize| (index * PITCH_MM) as f32 - (KEYS * PITCH_MM) as f32 / 2.0;
    let key = |index: usize| {
        let (column, row) = (index % KEYS, index / KEYS);
        let code = CODES[index % CODES.len()];
        format!(
            "(code: \"{code}\", name: \"k{index}\", at_mm: ({}, {}), size_mm: Box({size}, {size})),\n",
            at_mm(column),
            at_mm(row),
            size = PITCH_MM - 1,
        )
    };
    let keys: String = (0..KEYS * KEYS).map(key).collect();
    let pose = "(anchor: elbow, bearing_deg: 35, forward_mm: 300, height_mm: -45)";
    let text = format!("Layout(name: \"Keys\", boards: [(pose: {pose}, keys: [\n{keys}])])\n");
    fs::write(path, text).expect("space on the disk");
}
