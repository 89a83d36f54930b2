//! A day of a run, compressed in time: somebody types, and every half minute something goes wrong.
//!
//! That is 24 hours of a glove at 9600 baud, with 2 880 faults. `ADEMAN_SOAK_BAUD=115200` lets it send twelve times as
//! many frames, `ADEMAN_SOAK_HOURS` makes the day shorter or longer, and `ADEMAN_SOAK_SEED` chooses another one; with
//! `-- --nocapture` the account is printed.
//!
//! The glove's bytes go through the decoder of its line, its readings through the engine, all under an oracle.
//! Nothing here waits: the clock is the schedule's.

mod account;
mod day;
mod hands;
mod schedule;

use std::num::NonZeroU32;
use std::sync::{Mutex, PoisonError};

use crate::support::oracle::{Oracle, OutputRules};
use ademan::capture::{Hc11Format, SourceUri, StreamFormat, open};
use ademan::output;
use ademan::pipeline::PipelineSettings;
use ademan::session::{CommandReceiver, run_pipeline};
use ademan::snapshot::Snapshot;

use self::day::SoakRun;
use self::hands::SoakSetup;

/// Memory is looked at: nothing else may happen in the process meanwhile.
static ALONE: Mutex<()> = Mutex::new(());

/// One every 30 s.
const FAULTS_PER_HOUR: f64 = 120.0;

fn number<T: std::str::FromStr>(name: &str, default: T) -> T {
    let value = std::env::var(name).ok();
    value.map_or(default, |value| {
        value.parse().unwrap_or_else(|_| panic!("{name}={value}"))
    })
}

fn line() -> Hc11Format {
    Hc11Format {
        baud: NonZeroU32::new(number("ADEMAN_SOAK_BAUD", 9600)).expect("a baud"),
        ..Hc11Format::default()
    }
}

#[test]
fn nothing_is_lost_left_down_or_piled_up_in_a_day_of_faults() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let hours: f64 = number("ADEMAN_SOAK_HOURS", 24.0);
    let seed = number("ADEMAN_SOAK_SEED", 1);
    let hands = SoakSetup::new(line());
    let faults = (hours * FAULTS_PER_HOUR).round() as usize;
    let mut day = SoakRun::new(&hands, seed);
    let account = day.play(hours, faults);
    println!("{account}");
    account.check();
    assert_eq!(account.faults(), faults);
    assert!(account.presses() as f64 > 200.0 * hours, "it hardly typed");
}

#[test]
fn what_a_damaged_line_brings_goes_through_the_loop_of_a_run_and_is_accounted_for() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let hands = SoakSetup::new(line());
    let mut bytes = Vec::new();
    let mut day = SoakRun::new(&hands, 2);
    day.keep(&mut bytes);
    let account = day.play(0.1, 40);
    account.check();
    drop(day);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("glove.bin");
    std::fs::write(&path, &bytes).expect("the bytes can be written");
    let format = StreamFormat::from(hands.line);
    let source: SourceUri = format!("file:{}{format}", path.display())
        .parse()
        .expect("a file");
    let assembly = &hands.assembly;
    let mut nowhere = output::open("none", &assembly.required_capabilities()).expect("nowhere");
    let mut oracle = Oracle::new(
        assembly.layouts().map(OutputRules::from_layout),
        PipelineSettings::default(),
    );
    let mut observe = |frame: &Snapshot| {
        let judgement = oracle.check(frame);
        judgement.unwrap_or_else(|violation| panic!("{violation}: {:?}", frame.events));
    };
    let mut pipeline = assembly.pipeline();
    let source = open(&source).expect("the file opens");
    let run = run_pipeline(
        source,
        &mut pipeline,
        &mut *nowhere,
        &CommandReceiver::disconnected(),
        &mut observe,
    );
    let tally = run.expect("a run").stats;
    assert!(!oracle.has_pressed(), "something is down at the end");
    let counts = tally.source;
    assert_eq!(counts.bytes, bytes.len() as u64);
    assert_eq!(counts.bytes, 66 * counts.readings + counts.skipped_bytes);
    let rejected: u64 = tally.rejected.iter().sum();
    assert_eq!(counts.readings, tally.accepted + rejected + counts.dropped);
    assert!(tally.accepted > 1_000 && rejected > 10, "{tally:?}");
}
