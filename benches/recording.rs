//! Readings per second of a replay, a recording and a trace, and the size of an hour.
//!
//! Prints a table; each row also as a multiple of the time that the pipeline alone takes in the same run. Without `--bench` (as
//! in `cargo test --benches`) it runs each row once on few readings.

#[path = "../tests/support/recording.rs"]
#[expect(dead_code, reason = "tests use the rest")]
mod support;

use std::path::Path;
use std::time::{Duration, Instant};

use ademan::capture::recording::Replay;
use ademan::capture::{Hc11Format, Reading, Source, SourceEvent};
use ademan::device::Events;
use ademan::output;
use ademan::session::{Session, SessionOptions};
use ademan::setup::{LoadedSetup, Setup};
use ademan::trace::Stage;

use support::record_source;

/// Readings per hour of a glove on the fastest line.
const PER_HOUR: f64 = 175.0 * 3600.0;

const TEXT: &str =
    "the quick brown fox jumps over the lazy dog and pack my box with five dozen jugs ";

fn main() {
    let is_test = !std::env::args().any(|argument| argument == "--bench");
    let (texts, rounds) = if is_test { (1, 1) } else { (40, 9) };
    let setup = setup();
    let folder = tempfile::tempdir().expect("a folder");

    println!("| recording of an hour at 175 Hz | MB | bytes of a reading |");
    println!("|---|---|---|");
    for (what, noise) in [("a steady sensor", 0.0), ("noise of 1 count", 1.0)] {
        let path = folder.path().join(format!("{what}.mcap"));
        let readings = record(&path, &setup, texts.min(4), noise);
        let per_reading = size(&path) as f64 / readings as f64;
        let megabytes = per_reading * PER_HOUR / 1e6;
        println!("| {what} | {megabytes:.1} | {per_reading:.0} |");
    }

    let path = folder.path().join("long.mcap");
    let readings = record(&path, &setup, texts, 0.0);
    let copy = folder.path().join("copy.mcap");
    let mut rows: Vec<Row> = vec![
        Row::new("the pipeline alone", Box::new(|| steps(&setup, &path))),
        Row::new("decoding", Box::new(|| decode(&path))),
        Row::new("replay to `none`", Box::new(|| replay(&path, None))),
        Row::new("record", Box::new(|| replay(&path, Some(&copy)))),
    ];
    for &stage in Stage::ALL {
        let path = &path;
        let name = format!("`trace {stage}`");
        rows.push(Row::new(name, Box::new(move || trace(path, stage))));
    }
    for _ in 0..rounds {
        for row in &mut rows {
            row.times.push((row.run)());
        }
    }
    println!("\n| work on {readings} readings | readings per second | times the pipeline alone |");
    println!("|---|---|---|");
    let pipeline = rows[0].median();
    for row in &mut rows {
        let median = row.median();
        let rate = readings as f64 / median.as_secs_f64();
        let ratio = median.as_secs_f64() / pipeline.as_secs_f64();
        println!("| {} | {rate:.0} | {ratio:.2} |", row.name);
    }
}

struct Row<'a> {
    name: String,
    run: Box<dyn Fn() -> Duration + 'a>,
    times: Vec<Duration>,
}

impl<'a> Row<'a> {
    fn new(name: impl Into<String>, run: Box<dyn Fn() -> Duration + 'a>) -> Self {
        Self {
            name: name.into(),
            run,
            times: Vec::new(),
        }
    }

    fn median(&mut self) -> Duration {
        self.times.sort_unstable();
        self.times[self.times.len() / 2]
    }
}

fn setup() -> LoadedSetup {
    let setup = Setup {
        arm_immediately: true,
        ..Setup::default()
    };
    setup.load_files().expect("the default setup")
}

/// Records a hand that types. Returns the number of readings.
fn record(path: &Path, setup: &LoadedSetup, texts: usize, noise: f64) -> u64 {
    let typist = setup.typist(&TEXT.repeat(texts), &Hc11Format::default(), noise, 1);
    let typist = typist.expect("the hand can type the text");
    record_source(path, setup, typist).stats.source.readings
}

fn size(path: &Path) -> u64 {
    std::fs::metadata(path).expect("the recording").len()
}

fn decode(path: &Path) -> Duration {
    let begun = Instant::now();
    let mut replay = Replay::open(path).expect("the recording");
    while replay.next().expect("a reading") != SourceEvent::End {}
    begun.elapsed()
}

fn steps(setup: &LoadedSetup, path: &Path) -> Duration {
    let mut replay = Replay::open(path).expect("the recording");
    let mut readings: Vec<Reading> = Vec::new();
    while let SourceEvent::Reading(reading) = replay.next().expect("a reading") {
        readings.push(reading);
    }
    let (mut pipeline, mut events) = (setup.pipeline(), Events::new());
    let begun = Instant::now();
    for reading in &readings {
        events.clear();
        let _ = pipeline.step(reading, &mut events);
    }
    begun.elapsed()
}

fn options(path: &Path) -> (LoadedSetup, SessionOptions) {
    let setup = setup();
    let options = SessionOptions {
        source: Some(Box::new(Replay::open(path).expect("the recording"))),
        output: output::open("none", &setup.required_capabilities()).ok(),
        ..SessionOptions::default()
    };
    (setup, options)
}

fn replay(path: &Path, record_to: Option<&Path>) -> Duration {
    if let Some(recording) = record_to {
        // It is not there before the first round.
        let _ = std::fs::remove_file(recording);
    }
    let (setup, mut options) = options(path);
    options.record_to = record_to.map(Path::to_owned);
    let begun = Instant::now();
    let session = Session::start(setup, options).expect("a session");
    session.join().expect("a run");
    begun.elapsed()
}

/// Formats all results of a stage, as `ademan trace` does.
fn trace(path: &Path, stage: Stage) -> Duration {
    let (setup, mut options) = options(path);
    options.lossless_snapshots = true;
    let begun = Instant::now();
    let session = Session::start(setup, options).expect("a session");
    let (mut buffer, mut bytes) = (Vec::new(), 0);
    for snapshot in session.snapshots() {
        let Ok(()) = stage.for_each_json(&snapshot, &mut buffer, |_, json| {
            bytes += json.len();
            Ok::<_, std::convert::Infallible>(())
        });
    }
    session.join().expect("a run");
    std::hint::black_box(bytes);
    begun.elapsed()
}
