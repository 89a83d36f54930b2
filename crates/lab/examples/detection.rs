//! Tables of what the detection of taps costs: wrong characters without a decoder beside the errors of the nearest keys of the
//! same taps, for each tier and each way to use the fingers.
//!
//! ```sh
//! cargo run --release -p ademan-lab --example detection -- qwerty-flat ideal 40 [SEED]
//! ```

use std::error::Error;
use std::num::NonZeroUsize;
use std::sync::atomic::AtomicBool;

use ademan_core::document::Document;
use ademan_lab::measures::{Conditions, Interval, PersonScore, score, summarize};
use ademan_lab::people::{People, Tier, population};
use ademan_lab::phrases::{Corpus, PhraseSet};
use ademan_lab::sim::fluent::SourceKind;

/// Phrases that each person types.
const PHRASES: usize = 10;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let mut next = |default: &str| arguments.next().unwrap_or_else(|| default.to_owned());
    let (layout, source, count) = (next("qwerty-flat"), next("ideal"), next("40"));
    let seed: u64 = next("0").parse()?;
    let tiers = next("T0,T1,T2,T3,T4,Toff,own");
    let document = if layout.ends_with(".ron") {
        Document::new(layout.clone(), std::fs::read_to_string(&layout)?)
    } else {
        Document::shipped(&layout)?
    };
    let source: SourceKind = source.parse()?;
    println!("{layout}, source {source}, {count} people, {PHRASES} phrases each, seed {seed}");
    println!(
        "| tier | fingers | characters | wrong, % | inserted | missing | replaced | nearest keys, % | as shown, % | difference |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for name in tiers.split(',') {
        let tier = match name {
            "own" => None,
            tier => Some(tier.parse::<Tier>()?),
        };
        let people = population(&People::Drawn(count.parse()?), tier, seed);
        let conditions = Conditions {
            document: &document,
            people: &people,
            corpus: &Corpus::shipped(PhraseSet::En),
            phrases: PHRASES,
            source,
            seed,
            jobs: std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN),
        };
        let scores = score(&conditions, &AtomicBool::new(false), |_| {})?;
        for style in ["index", "four", "ten", "all"] {
            let own = scores
                .iter()
                .filter(|it| style == "all" || it.style == style);
            row(name, style, &own.cloned().collect::<Vec<_>>());
        }
    }
    Ok(())
}

fn row(tier: &str, style: &str, scores: &[PersonScore]) {
    if scores.is_empty() {
        return;
    }
    let summary = summarize(scores);
    let percent = |rate: Interval| 100.0 * rate.value;
    let nearest = summary.nearest_cer.map_or(f64::NAN, percent);
    let shown = summary.shown_cer.map_or(f64::NAN, percent);
    let cer = percent(summary.cer);
    println!(
        "| {tier} | {style} | {} | {cer:.2} ({:.2} to {:.2}) | {:.2} | {:.2} | {:.2} | {nearest:.2} | {shown:.2} | {:+.2} |",
        summary.characters,
        100.0 * summary.cer.low,
        100.0 * summary.cer.high,
        percent(summary.insertions),
        percent(summary.deletions),
        percent(summary.substitutions),
        cer - nearest,
    );
}
