//! A run of typing with a fault every 30 seconds, without waiting.
//!
//! The run has 24 hours of a glove at 9600 baud and 2 880 faults. `ADEMAN_SOAK_BAUD=115200` sends twelve times as many
//! packets, `ADEMAN_SOAK_HOURS` sets the length, and `ADEMAN_SOAK_SEED` the seed; `-- --nocapture` prints the statistics.
//!
//! The bytes of the glove go through its decoder, its readings through a pipeline with an oracle. The schedule provides the
//! time.

mod run;
mod schedule;
mod setup;
mod stats;

use std::num::NonZeroU32;
use std::sync::{Mutex, PoisonError};

use crate::support::oracle::{Oracle, OutputRules};
use ademan::capture::{Hc11Format, SourceUri, StreamFormat, open};
use ademan::output;
use ademan::pipeline::PipelineSettings;
use ademan::session::{CommandReceiver, run_pipeline};
use ademan::snapshot::StepView;

use self::run::SoakRun;
use self::setup::SoakSetup;

/// The lock of the tests that measure the memory of the process.
static MEMORY: Mutex<()> = Mutex::new(());

/// One fault every 30 s.
const FAULTS_PER_HOUR: f64 = 120.0;

fn number<T: std::str::FromStr>(name: &str, default: T) -> T {
    let value = std::env::var(name).ok();
    value.map_or(default, |value| {
        value.parse().unwrap_or_else(|_| panic!("{name}={value}"))
    })
}

fn format() -> Hc11Format {
    Hc11Format {
        baud: NonZeroU32::new(number("ADEMAN_SOAK_BAUD", 9600)).expect("a baud"),
        ..Hc11Format::default()
    }
}

#[test]
fn a_day_of_faults_loses_no_reading_leaves_no_key_pressed_and_needs_no_more_memory() {
    let _lock = MEMORY.lock().unwrap_or_else(PoisonError::into_inner);
    let hours: f64 = number("ADEMAN_SOAK_HOURS", 24.0);
    let seed = number("ADEMAN_SOAK_SEED", 1);
    let setup = SoakSetup::new(format());
    let faults = (hours * FAULTS_PER_HOUR).round() as usize;
    let mut run = SoakRun::new(&setup, seed);
    let stats = run.play(hours, faults);
    println!("{stats}");
    stats.check();
    assert_eq!(stats.faults(), faults);
    assert!(stats.presses() as f64 > 200.0 * hours, "too few presses");
}

#[test]
fn the_event_loop_counts_every_reading_of_a_damaged_line() {
    let _lock = MEMORY.lock().unwrap_or_else(PoisonError::into_inner);
    let setup = SoakSetup::new(format());
    let mut bytes = Vec::new();
    let mut run = SoakRun::new(&setup, 2);
    run.copy_bytes(&mut bytes);
    let stats = run.play(0.1, 40);
    stats.check();
    drop(run);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("glove.bin");
    std::fs::write(&path, &bytes).expect("disk space");
    let format = StreamFormat::from(setup.format);
    let source: SourceUri = format!("file:{}{format}", path.display())
        .parse()
        .expect("a file");
    let loaded = &setup.loaded;
    let mut null_output =
        output::open("none", &loaded.required_capabilities()).expect("the null output");
    let mut oracle = Oracle::new(
        loaded.layouts().map(OutputRules::from_layout),
        PipelineSettings::default(),
    );
    let mut observe = |step: &StepView| {
        let outcome = oracle.check(step);
        outcome.unwrap_or_else(|violation| panic!("{violation}: {:?}", step.events));
    };
    let mut pipeline = loaded.pipeline();
    let source = open(&source).expect("the file opens");
    let ended = run_pipeline(
        source,
        &mut pipeline,
        &mut *null_output,
        &CommandReceiver::disconnected(),
        &mut observe,
    );
    let pipeline_stats = ended.expect("a session").stats;
    assert!(!oracle.has_pressed(), "a key stays pressed at the end");
    let source_stats = pipeline_stats.source;
    assert_eq!(source_stats.bytes, bytes.len() as u64);
    assert_eq!(
        source_stats.bytes,
        66 * source_stats.readings + source_stats.skipped_bytes
    );
    let rejected: u64 = pipeline_stats.rejected.iter().sum();
    assert_eq!(
        source_stats.readings,
        pipeline_stats.accepted + rejected + source_stats.dropped
    );
    assert!(
        pipeline_stats.accepted > 1_000 && rejected > 0,
        "{pipeline_stats:?}"
    );
}
