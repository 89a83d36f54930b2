//! Prints the table of swiped words of `docs/typing.md` as Markdown: phrases that the models have not seen, swiped by simulated people.
//!
//! `cargo run --release -p ademan-text --example swipes -- [--phrases 200] [--people 10] [--tuning]`; with `--tuning`, phrases and people
//! are those on which costs may be tuned.

#[path = "../tests/support/mod.rs"]
mod support;

use ademan_text::Model;
use support::phrases::phrases;
use support::swipes::{Hits, NearestShape, intervals, measure};

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let number = |name: &str, default: usize| {
        let index = arguments.iter().position(|argument| argument == name);
        let value = index.and_then(|index| arguments.get(index + 1));
        value.map_or(default, |value| value.parse().expect("a number"))
    };
    let is_tuning = arguments.iter().any(|argument| argument == "--tuning");
    let Some(mut phrases) = phrases(!is_tuning) else {
        return;
    };
    phrases.truncate(number("--phrases", 200));
    let people = number("--people", 10) as u64;
    let first = if is_tuning { 1_000 } else { 0 };
    let model = Model::from_bytes(ademan_text::languages::ENGLISH).expect("the model");
    let reference = NearestShape::new(&model);
    println!("{} phrases, {people} people\n", phrases.len());
    println!(
        "| scatter | words | nearest shape | one of three | decoded, each word alone | one of three | decoded | one of three |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for scatter in [1.0, 3.0, 5.0, 8.0] {
        let measured = measure(&model, &reference, &phrases, scatter, first..first + people);
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
