//! Prints the table of swiped words of `docs/typing-measured.md` as Markdown: phrases that the models have not seen, swiped by
//! simulated people.
//!
//! `cargo run --release -p ademan-text --example swipes -- [--phrases 200] [--people 10] [--tuning]`; with `--tuning`, phrases and people
//! are those on which costs may be tuned.

#[path = "../tests/support/mod.rs"]
mod support;

use ademan_text::Model;
use support::arguments::Sample;
use support::swipes::{Hits, NearestShape, intervals, measure};

fn main() {
    let Some(sample) = Sample::from_arguments(200, 10) else {
        return;
    };
    let model = Model::from_bytes(ademan_text::languages::ENGLISH).expect("the model");
    let reference = NearestShape::new(&model);
    println!(
        "{} phrases, {} people\n",
        sample.phrases.len(),
        sample.seeds.end - sample.seeds.start
    );
    println!(
        "| scatter | words | nearest shape | one of three | decoded, each word alone | one of three | decoded | one of three |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for scatter in [1.0, 3.0, 5.0, 8.0] {
        let measured = measure(
            &model,
            &reference,
            &sample.phrases,
            scatter,
            sample.seeds.clone(),
        );
        let words: usize = measured.decoded.iter().map(|hits| hits.words).sum();
        let cells = [&measured.nearest, &measured.alone, &measured.decoded].map(|hits| cells(hits));
        println!("| {scatter} mm | {words} | {} |", cells.join(" | "));
    }
}

/// Returns both rates with their intervals.
fn cells(phrases: &[Hits]) -> String {
    let mut total = Hits::default();
    for hits in phrases {
        total.merge(hits);
    }
    let pairs = total.percent().into_iter().zip(intervals(phrases));
    let cells = pairs.map(|(rate, [low, high])| format!("{rate:.1} ({low:.1}–{high:.1})"));
    cells.collect::<Vec<_>>().join(" | ")
}
