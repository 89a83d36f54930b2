//! The speed of simulated typing through the whole pipeline, as multiples of real time on one core, and the efficiency of two threads.
//!
//! The rows of a run are interleaved; the figure of a row is the best of its rounds.

use std::num::NonZeroUsize;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use ademan_core::document::Document;
use ademan_lab::measures::{Conditions, PersonScore, score};
use ademan_lab::people::{People, population};
use ademan_lab::phrases::{Corpus, PhraseSet};
use ademan_lab::sim::fluent::SourceKind;

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
    // `cargo test --benches` passes this flag: one round shows that all rows run.
    let is_test = std::env::args().any(|argument| argument == "--test");
    let (people, phrases, rounds) = if is_test { (2, 1, 1) } else { (12, 10, ROUNDS) };
    let people = population(&People::Drawn(people), None, 1);
    let corpus = Corpus::shipped(PhraseSet::En);
    let mut best = [Duration::MAX; ROWS.len()];
    let mut scores: Vec<Vec<PersonScore>> = vec![Vec::new(); ROWS.len()];
    for _ in 0..rounds {
        for (row, (layout, source, jobs)) in ROWS.into_iter().enumerate() {
            let document = Document::shipped(layout).expect("a shipped layout");
            let conditions = Conditions {
                document: &document,
                people: &people,
                corpus: &corpus,
                phrases,
                source,
                seed: 1,
                jobs: NonZeroUsize::new(jobs).expect("more than 0"),
            };
            let start = Instant::now();
            let scored = score(&conditions, &AtomicBool::new(false), |_| {});
            best[row] = best[row].min(start.elapsed());
            scores[row] = scored.expect("a score");
        }
    }
    println!(
        "| layout | source | threads | × real time per thread | readings/s per thread | µs a reading |"
    );
    println!("|---|---|---|---|---|---|");
    for (row, (layout, source, jobs)) in ROWS.into_iter().enumerate() {
        let seconds = best[row].as_secs_f64() * jobs as f64;
        let simulated: f64 = scores[row].iter().map(|it| it.simulated_seconds).sum();
        let readings: u64 = scores[row].iter().map(|it| it.readings).sum();
        println!(
            "| {layout} | {source} | {jobs} | {:.0} | {:.0} | {:.2} |",
            simulated / seconds,
            readings as f64 / seconds,
            seconds * 1e6 / readings as f64
        );
    }
    println!(
        "efficiency of two threads: {:.2}",
        best[0].as_secs_f64() / best[1].as_secs_f64() / 2.0
    );
}
