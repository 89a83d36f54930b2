//! The speed of the lab: typing through the whole pipeline as multiples of real time, contact alone, and a large score with its memory.
//!
//! Times are of the processor, so that other programs on the machine matter less; the time of the clock is beside them where threads
//! count. The rows of a table are interleaved; the figure of a row is the best of its rounds. Without `--bench` (as in
//! `cargo test --benches`) each runs once and is small.

use std::hint::black_box;
use std::num::NonZeroUsize;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use ademan_core::capture::Sample;
use ademan_core::document::Document;
use ademan_core::estimate::JointAngles;
use ademan_core::hand::{Finger, Side};
use ademan_core::kinematics::ArmModel;
use ademan_core::layout::{Fit, Layout};
use ademan_core::time::Timestamp;
use ademan_lab::batch::{HandBatch, LANES, LaneAngles};
use ademan_lab::measures::{Conditions, PersonScore, score, summarize};
use ademan_lab::people::{Participant, People, population};
use ademan_lab::phrases::{Corpus, PhraseSet};
use ademan_lab::sim::TypingKeys;
use ademan_lab::sim::fluent::{FluentHand, HandSetup, SourceKind, StartPosture, Tap};

const ROUNDS: usize = 5;
const ROWS: [(&str, SourceKind, usize); 7] = [
    ("qwerty-flat", SourceKind::Ideal, 1),
    ("qwerty-flat", SourceKind::Ideal, 2),
    ("qwerty-flat", SourceKind::Camera, 1),
    ("qwerty-flat", SourceKind::Glove, 1),
    ("qwerty-two-flat", SourceKind::Ideal, 1),
    ("chords-bend", SourceKind::Ideal, 1),
    ("chords-bend", SourceKind::Glove, 1),
];

fn main() {
    let is_test = !std::env::args().any(|argument| argument == "--bench");
    large_score(is_test);
    chain(is_test);
    contact_alone(is_test);
}

/// A run with its times.
#[derive(Clone)]
struct Timed {
    scores: Vec<PersonScore>,
    clock: Duration,
    processor: Duration,
}

fn run(
    layout: &str,
    (source, jobs): (SourceKind, usize),
    people: &[Participant],
    phrases: usize,
) -> Timed {
    let document = Document::shipped(layout).expect("a shipped layout");
    let conditions = Conditions {
        document: &document,
        people,
        corpus: &Corpus::shipped(PhraseSet::En),
        phrases,
        source,
        seed: 1,
        jobs: NonZeroUsize::new(jobs).expect("more than 0"),
    };
    let (start, used) = (Instant::now(), processor_time());
    let scores = score(&conditions, &AtomicBool::new(false), |_| {}).expect("a score");
    black_box(summarize(&scores));
    Timed {
        scores,
        clock: start.elapsed(),
        processor: processor_time() - used,
    }
}

/// Returns the time of the processor that this process has used.
fn processor_time() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    time.try_into().expect("it is not negative")
}

/// Returns the largest memory of this process so far, in MB; `None` if the system does not tell.
fn peak_memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kilobytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kilobytes / 1024.0)
}

/// The score of many people, with its summary: the first, so that the memory is its own.
fn large_score(is_test: bool) {
    let (people, phrases) = if is_test { (2, 1) } else { (50, 100) };
    let everybody = population(&People::Drawn(people), None, 1);
    let timed = run("qwerty-flat", (SourceKind::Ideal, 2), &everybody, phrases);
    let memory = peak_memory().map_or("unknown".to_owned(), |it| format!("{it:.0} MB"));
    println!("| score of qwerty-flat | clock, 2 threads | processor | of it by two | memory |");
    println!("|---|---|---|---|---|");
    println!(
        "| {people} people × {phrases} phrases | {:.1} s | {:.1} s | {:.1} s | {memory} |\n",
        timed.clock.as_secs_f64(),
        timed.processor.as_secs_f64(),
        timed.processor.as_secs_f64() / 2.0
    );
}

/// Typing through the whole pipeline.
fn chain(is_test: bool) {
    let (people, phrases, rounds) = if is_test { (2, 1, 1) } else { (12, 10, ROUNDS) };
    let people = population(&People::Drawn(people), None, 1);
    let mut best: Vec<Option<Timed>> = vec![None; ROWS.len()];
    for _ in 0..rounds {
        for (row, (layout, source, jobs)) in ROWS.into_iter().enumerate() {
            let timed = run(layout, (source, jobs), &people, phrases);
            let is_better = |fastest: &Timed| timed.processor < fastest.processor;
            if best[row].as_ref().is_none_or(is_better) {
                best[row] = Some(timed);
            }
        }
    }
    let best: Vec<Timed> = best.into_iter().flatten().collect();
    assert_eq!(best[0].scores, best[1].scores, "one thread and two");
    println!(
        "| layout | source | threads | × real time of a core | readings/s of a core | µs a reading |"
    );
    println!("|---|---|---|---|---|---|");
    for ((layout, source, jobs), timed) in ROWS.into_iter().zip(&best) {
        let seconds = timed.processor.as_secs_f64();
        let simulated: f64 = timed.scores.iter().map(|it| it.simulated_seconds).sum();
        let readings: u64 = timed.scores.iter().map(|it| it.readings).sum();
        println!(
            "| {layout} | {source} | {jobs} | {:.0} | {:.0} | {:.2} |",
            simulated / seconds,
            readings as f64 / seconds,
            seconds * 1e6 / readings as f64
        );
    }
    let ratio =
        |of: fn(&Timed) -> Duration| of(&best[0]).as_secs_f64() / of(&best[1]).as_secs_f64();
    println!(
        "\nefficiency of two threads: {:.2} of the processor, {:.2} of the clock\n",
        ratio(|it| it.processor),
        ratio(|it| it.clock) / 2.0
    );
}

/// Forward kinematics and contact of hands that type, eight at once: a sweep of a board without sensors, filters and devices.
fn contact_alone(is_test: bool) {
    let (readings, rounds) = if is_test { (100, 1) } else { (4_096, 20) };
    let person = &population(&People::Drawn(1), None, 1)[0];
    let arm = ArmModel::anthropometric(Side::Right, &person.own).expect("an arm");
    let document = Document::shipped("qwerty-flat").expect("a shipped layout");
    let fit = Fit::new(&arm, None).expect("a fit");
    let layout = Layout::for_hands(document, fit).expect("a layout");
    let angles = typed(person, &arm, &layout, readings);
    const BLOCKS: usize = 8;
    let mut lanes = vec![LaneAngles::default(); BLOCKS * readings];
    for (index, block) in lanes.iter_mut().enumerate() {
        for lane in 0..LANES {
            // Each hand types from another place.
            let first = (index / readings * LANES + lane) * readings / (BLOCKS * LANES);
            block.set(lane, &angles[(first + index % readings) % readings]);
        }
    }
    let times: Vec<Timestamp> = (1..=readings as u64)
        .map(|it| Timestamp(it * 5_714))
        .collect();
    let mut best = Duration::MAX;
    let mut touches = 0;
    for _ in 0..rounds {
        let mut batch = HandBatch::new(&arm, &layout.scene, BLOCKS * LANES);
        let used = processor_time();
        touches = batch.run(&times, &lanes, 1).len();
        best = best.min(processor_time() - used);
    }
    assert!(touches > 0);
    let all = (BLOCKS * LANES * readings) as f64;
    println!(
        "contact alone, {touches} touches: {:.1} million readings/s of a core",
        1e-6 * all / best.as_secs_f64()
    );
}

/// Returns the angles of a hand that types at random.
fn typed(
    person: &Participant,
    arm: &ArmModel,
    layout: &Layout,
    readings: usize,
) -> Vec<JointAngles> {
    let setup = HandSetup {
        assumed: arm,
        own: arm,
        map: None,
        source: SourceKind::Ideal,
    };
    let keys = TypingKeys::new(layout);
    let mut hand = FluentHand::new(setup, person, &keys, StartPosture::Relaxed);
    let targets: Vec<_> = layout.keys.iter().map(|key| key.face.target).collect();
    let (mut next, mut angles) = (0, Vec::new());
    let mut sample = Sample::Angles {
        angles: JointAngles::default(),
    };
    for reading in 1..=readings {
        let now = reading as f64 / 175.0;
        if hand.free_at() <= now {
            let target = targets[next * 7 % targets.len()];
            next += 1;
            let tap = Tap {
                target,
                finger: Finger::Index,
                shift: glam::Vec2::ZERO,
                wanted: now + 0.3,
                now,
                is_shallow: false,
                is_exact: false,
            };
            hand.tap(&layout.scene, tap);
        }
        if hand.sample(now, 1.0 / 175.0, &mut sample)
            && let Sample::Angles { angles: shown } = &sample
        {
            angles.push(*shown);
        }
    }
    angles
}
