//! The example scripts: `examples/scripts/NAME.txt`, played on the layout `NAME`, gives the events in `NAME.out`.
//!
//! After an intended change: `ADEMAN_WRITE=1 cargo test --test pipeline examples`, and review the difference.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use crate::support::checked::CheckedPipeline;
use ademan::capture::{Hc11Format, Source, SourceEvent};
use ademan::contact::TargetNames;
use ademan::device::{EventKind, Events};
use ademan::files::Load;
use ademan::hand::Side;
use ademan::layout::Layout;
use ademan::output::transcript::EventLine;
use ademan::setup::{OtherHand, Setup};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/scripts")
}

/// The continuous values since the last other event, such as the value of a slider: the first and the last, or the sum. Of an
/// axis also the largest deflection between them.
#[derive(Default)]
struct Ranges {
    order: Vec<String>,
    values: BTreeMap<String, (String, String)>,
    deflections: BTreeMap<String, f32>,
    sums: BTreeMap<&'static str, (i32, i32)>,
}

impl Ranges {
    /// Adds a continuous event; returns `false` for other events.
    fn push(&mut self, event: EventKind, names: &TargetNames) -> bool {
        let (name, value) = match event {
            EventKind::MoveBy(x, y) => return self.add("move", x, y),
            EventKind::Scroll(x, y) => return self.add("scroll", x, y),
            EventKind::MoveTo(x, y) => ("place".to_owned(), format!("{x:.2} {y:.2}")),
            EventKind::Axis(axis, value) => {
                let name = format!("axis {axis}");
                let largest = self.deflections.entry(name.clone()).or_default();
                if value.abs() > largest.abs() {
                    *largest = value;
                }
                (name, format!("{value:+.2}"))
            }
            EventKind::Depth(target, depth) => (
                format!("depth {}", names.get(target)),
                format!("{depth:.2}"),
            ),
            EventKind::Value(target, value) => (
                format!("value {}", names.get(target)),
                format!("{value:.2}"),
            ),
            _ => return false,
        };
        match self.values.get_mut(&name) {
            Some((_, last)) => *last = value,
            None => {
                self.order.push(name.clone());
                self.values.insert(name, (value.clone(), value));
            }
        }
        true
    }

    fn add(&mut self, name: &'static str, x: i32, y: i32) -> bool {
        let sum = self.sums.entry(name).or_default();
        *sum = (sum.0 + x, sum.1 + y);
        true
    }

    /// Removes all values and returns a line for each.
    fn take_lines(&mut self) -> Vec<String> {
        let ranges = std::mem::take(self);
        let line = |name: &String| {
            let (first, last) = &ranges.values[name];
            let largest = ranges.deflections.get(name);
            let largest = largest.map(|value| format!("{value:+.2}"));
            let largest = largest.filter(|value| value != first && value != last);
            match (largest, first == last) {
                (Some(largest), _) => format!("{name} {first} … {largest} … {last}"),
                (None, true) => format!("{name} {first}"),
                (None, false) => format!("{name} {first} … {last}"),
            }
        };
        let sums = ranges.sums.iter();
        let sums = sums.map(|(name, (x, y))| format!("{name} {x:+} {y:+} in all"));
        ranges.order.iter().map(line).chain(sums).collect()
    }
}

/// Plays a script and returns its events.
fn play(layout: &str, script: &Path) -> String {
    let uses_left = Layout::load(layout).is_ok_and(|layout| layout.uses_hand(Side::Left));
    let setup = Setup {
        layout: layout.into(),
        other_hand: uses_left.then(OtherHand::default),
        ..Setup::default()
    };
    let loaded = setup.load_files().expect("a shipped layout");
    let path = script.to_str().expect("a path in UTF-8");
    let hand = loaded.scripted(path, &Hc11Format::default(), 0.0, 0);
    let mut hand = hand.unwrap_or_else(|error| panic!("{error}"));
    let mut pipeline = CheckedPipeline::new(&loaded);
    let (mut lines, mut ranges, mut events) = (Vec::new(), Ranges::default(), Events::new());
    while let Ok(SourceEvent::Reading(reading)) = hand.next() {
        events.clear();
        let step = pipeline.step(&reading, &mut events);
        let commands = step.map(|step| step.commands.clone()).unwrap_or_default();
        for issued in &commands {
            lines.extend(ranges.take_lines());
            lines.push(issued.command.to_string());
        }
        for event in &events {
            if !ranges.push(event.kind, pipeline.target_names()) {
                lines.extend(ranges.take_lines());
                let line = EventLine(event, pipeline.target_names()).to_string();
                lines.push(line[13..].to_owned());
            }
        }
    }
    lines.extend(ranges.take_lines());
    events.clear();
    pipeline.stop(&mut events);
    let pressed = events
        .iter()
        .filter(|event| matches!(event.kind, EventKind::KeyUp(_)));
    assert_eq!(
        pressed.count(),
        0,
        "{layout}: a key stays pressed at the end"
    );
    lines.join("\n") + "\n"
}

#[test]
fn every_script_gives_its_transcript() {
    let mut scripts = 0;
    for entry in fs::read_dir(folder()).expect("the folder of scripts") {
        let path = entry.expect("a file").path();
        if path.extension().is_none_or(|extension| extension != "txt") {
            continue;
        }
        scripts += 1;
        let layout = path.file_stem().expect("a name").to_str().expect("letters");
        let found = play(layout, &path);
        let out = path.with_extension("out");
        if std::env::var_os("ADEMAN_WRITE").is_some() {
            fs::write(&out, &found).expect("the transcript can be written");
        }
        let expected = fs::read_to_string(&out).unwrap_or_default();
        assert_eq!(found, expected, "{layout}");
    }
    assert!(scripts >= 7, "only {scripts} scripts");
}
