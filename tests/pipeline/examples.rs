//! The scripts of `examples/scripts`, each played by the simulated hand on the layout that it is named
//! after, and what has to come out: `NAME.txt` in, `NAME.out` out.
//!
//! To write the `.out` files anew after a change that is meant: `ADEMAN_WRITE=1 cargo test --test pipeline examples`,
//! and read the difference.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use crate::support::checked::CheckedPipeline;
use ademan::capture::{Hc11Format, Source, SourceEvent};
use ademan::contact::TargetNames;
use ademan::device::{EventKind, Events};
use ademan::output::transcript::EventLine;
use ademan::setup::Setup;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/scripts")
}

/// What goes on for a while, such as a slider: what it is, where it was first and last or how far it went.
#[derive(Default)]
struct Ways {
    order: Vec<String>,
    ways: BTreeMap<String, (String, String)>,
    sums: BTreeMap<&'static str, (i32, i32)>,
}

impl Ways {
    /// Takes an event that goes on; `false` for one that happens once.
    fn take(&mut self, action: EventKind, names: &TargetNames) -> bool {
        let (what, place) = match action {
            EventKind::MoveBy(x, y) => return self.add("move", x, y),
            EventKind::Scroll(x, y) => return self.add("scroll", x, y),
            EventKind::MoveTo(x, y) => ("place".to_owned(), format!("{x:.2} {y:.2}")),
            EventKind::Axis(axis, place) => (format!("axis {axis}"), format!("{place:+.2}")),
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
        match self.ways.get_mut(&what) {
            Some((_, last)) => *last = place,
            None => {
                self.order.push(what.clone());
                self.ways.insert(what, (place.clone(), place));
            }
        }
        true
    }

    fn add(&mut self, what: &'static str, x: i32, y: i32) -> bool {
        let sum = self.sums.entry(what).or_default();
        *sum = (sum.0 + x, sum.1 + y);
        true
    }

    /// A line for each.
    fn finish(&mut self) -> Vec<String> {
        let ways = std::mem::take(self);
        let line = |what: &String| match &ways.ways[what] {
            (first, last) if first == last => format!("{what} {first}"),
            (first, last) => format!("{what} {first} … {last}"),
        };
        let sums = ways.sums.iter();
        let sums = sums.map(|(what, (x, y))| format!("{what} {x:+} {y:+} in all"));
        ways.order.iter().map(line).chain(sums).collect()
    }
}

fn played(layout: &str, script: &Path) -> String {
    let setup = Setup {
        layout: layout.into(),
        ..Setup::default()
    };
    let assembly = setup.load_files().expect("a shipped layout");
    let path = script.to_str().expect("a path of letters");
    let hand = assembly.scripted(path, &Hc11Format::default(), 0.0, 0);
    let mut hand = hand.unwrap_or_else(|error| panic!("{error}"));
    let mut pipeline = CheckedPipeline::new(&assembly);
    let (mut lines, mut ways, mut events) = (Vec::new(), Ways::default(), Events::new());
    while let Ok(SourceEvent::Reading(reading)) = hand.next() {
        events.clear();
        let step = pipeline.step(&reading, &mut events);
        let commands = step.map(|step| step.commands.clone()).unwrap_or_default();
        for issued in &commands {
            lines.extend(ways.finish());
            lines.push(issued.command.to_string());
        }
        for event in &events {
            if !ways.take(event.kind, pipeline.target_names()) {
                lines.extend(ways.finish());
                let line = EventLine(event, pipeline.target_names()).to_string();
                lines.push(line[13..].to_owned());
            }
        }
    }
    lines.extend(ways.finish());
    events.clear();
    pipeline.stop(&mut events);
    let left = events
        .iter()
        .filter(|event| matches!(event.kind, EventKind::KeyUp(_)));
    assert_eq!(left.count(), 0, "{layout}: something is down at the end");
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
        let found = played(layout, &path);
        let out = path.with_extension("out");
        if std::env::var_os("ADEMAN_WRITE").is_some() {
            fs::write(&out, &found).expect("the transcript can be written");
        }
        let expected = fs::read_to_string(&out).unwrap_or_default();
        assert_eq!(found, expected, "{layout}");
    }
    assert!(scripts >= 7, "only {scripts} scripts");
}
