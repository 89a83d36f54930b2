//! The time of two steps, one for each hand, with controls of every kind.
//!
//! Compare ratios within one run of `cargo bench --bench controls`: 10 000 controls against 64.

use std::fmt::Write;
use std::hint::black_box;

use ademan::capture::{Hc11Format, Reading, Source, SourceEvent};
use ademan::device::Events;
use ademan::setup::{LoadedSetup, OtherHand, Setup};
use ademan::sim::SimulatedTypist;
use divan::Bencher;

fn main() {
    divan::main();
}

/// A text that needs only the keys of [`HALVES`].
const TYPED: &str = "the quick brown fox jumps over the lazy dog 1234567890";
const HALVES: [(&str, i32, [&str; 4]); 2] = [
    (
        "left",
        -35,
        ["1 2 3 4 5", "Q W E R T", "A S D F G", "Z X C V B"],
    ),
    (
        "right",
        35,
        [
            "6 7 8 9 0",
            "Y U I O P",
            "H J K L Semicolon",
            "N M Comma Period Space",
        ],
    ),
];

/// The other kinds of controls; `{name}`, `{at}` and `{beside}` are replaced.
const KINDS: [(&str, &str); 11] = [
    (
        "toggles",
        "(name: \"{name}\", at_mm: {at}, size_mm: Box(20, 20), hold: Key(\"F1\"))",
    ),
    (
        "sliders",
        "(name: \"{name}\", at_mm: {at}, length_mm: 20, output: ScrollY(10))",
    ),
    (
        "knobs",
        "(name: \"{name}\", at_mm: {at}, diameter_mm: 20, output: ScrollX(10))",
    ),
    (
        "levers",
        "(name: \"{name}\", at_mm: {at}, length_mm: 20, springs_back: true)",
    ),
    (
        "valves",
        "(name: \"{name}\", at_mm: {at}, diameter_mm: 20, turns: 2)",
    ),
    (
        "joysticks",
        "(name: \"{name}\", at_mm: {at}, diameter_mm: 20, pointer_px_per_s: 400)",
    ),
    (
        "scroll_rings",
        "(name: \"{name}\", at_mm: {at}, diameter_mm: 20, output: ScrollY(24))",
    ),
    (
        "radial_menus",
        "(name: \"{name}\", at_mm: {at}, diameter_mm: 30, sectors: [(name: \"a\", tap: Key(\"A\")), (name: \"b\", tap: Key(\"B\"))])",
    ),
    (
        "touch_surfaces",
        "(name: \"{name}\", at_mm: {at}, size_mm: Box(20, 20), mode: Touchpad)",
    ),
    (
        "xy_pads",
        "(name: \"{name}\", at_mm: {at}, size_mm: Box(20, 20), x: (output: ScrollX(10)))",
    ),
    (
        "radios",
        "(name: \"{name}\", options: [(name: \"{name} a\", at_mm: {at}, size_mm: Box(10, 10), hold: Key(\"F1\")), (name: \"{name} b\", at_mm: {beside}, size_mm: Box(10, 10), tap: Key(\"F2\"))])",
    ),
];

/// Returns a layout with this number of controls, half of them for each hand: keys within reach, and controls of all
/// kinds in rows behind them.
fn layout(controls: usize) -> String {
    let mut text = "Layout(name: \"bench\", boards: [".to_owned();
    for (hand, bearing, rows) in HALVES {
        let _ = write!(
            text,
            "(hand: \"{hand}\", pose: (anchor: elbow, bearing_deg: {bearing}, forward_mm: 300, \
             height_mm: -45), rows: ["
        );
        for (row, keys) in rows.iter().enumerate() {
            let y = 38 - 19 * row as i32;
            let _ = write!(text, "(at_mm: (-38, {y}), keys: \"{keys}\"),");
        }
        text.push_str("],");
        let free = ((controls - 1) / 2).saturating_sub(20);
        // A radio group counts twice, as it has two targets. Each kind occurs.
        let others = (free * KINDS.len() / (KINDS.len() + 1)).max(KINDS.len());
        for (kind, (list, form)) in KINDS.iter().enumerate() {
            let _ = write!(text, "{list}: [");
            for number in (0..others).filter(|number| number % KINDS.len() == kind) {
                let (column, row) = (number % 120, number / 120);
                let (x, y) = (32 * column as i32 - 1904, 80 + 32 * row as i32);
                let control = form
                    .replace("{name}", &format!("{hand} {number}"))
                    .replace("{at}", &format!("({x}, {y})"))
                    .replace("{beside}", &format!("({}, {y})", x + 11));
                let _ = write!(text, "{control},");
            }
            text.push_str("],");
        }
        text.push_str("),");
    }
    text.push_str(
        "], triggers: [(name: \"claw\", action: Key(\"F2\"), when: \
         Angle(dof: \"ring-mcp-flexion\", on_deg: 60, off_deg: 50))])",
    );
    text
}

fn loaded_setup(controls: usize) -> LoadedSetup {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("bench.ron");
    std::fs::write(&path, layout(controls)).expect("a file");
    let setup = Setup {
        layout: path.display().to_string(),
        other_hand: Some(OtherHand::default()),
        arm_immediately: true,
        ..Setup::default()
    };
    setup.load_files().unwrap_or_else(|error| panic!("{error}"))
}

/// Returns the readings of both hands while they type, in pairs.
fn readings(setup: &LoadedSetup) -> Vec<[Reading; 2]> {
    let typist = setup.typist(TYPED, &Hc11Format::default(), 0.0, 0);
    let mut typist: SimulatedTypist = typist.expect("the text is on the board");
    let mut next = || match typist.next() {
        Ok(SourceEvent::Reading(reading)) => Some(reading),
        _ => None,
    };
    std::iter::from_fn(|| Some([next()?, next()?])).collect()
}

/// Two readings, one of each hand, from reading to events.
#[divan::bench(args = [64, 100, 10_000])]
fn both_hands(bencher: Bencher, controls: usize) {
    let setup = loaded_setup(controls);
    let readings = readings(&setup);
    let mut pipeline = setup.pipeline();
    let mut events = Events::new();
    let (mut index, mut pass) = (0, 0);
    let span = readings.last().expect("a text")[0].time.0;
    bencher.bench_local(|| {
        for reading in &readings[index] {
            let mut reading = reading.clone();
            reading.time.0 += pass * span;
            events.clear();
            let _ = black_box(pipeline.step(&reading, &mut events));
        }
        index += 1;
        if index == readings.len() {
            index = 0;
            pass += 1;
        }
    });
}
