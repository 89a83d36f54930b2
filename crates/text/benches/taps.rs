//! The time from a tap to its candidates, in one run beside three references for the last five taps: the nearest word of the same length
//! in the flat list, by the same distances, which needs no search over errors; the first suggestion of SymSpell within two
//! edits of the nearest keys, which sees no positions; and a search of the word with the weights of LatinIME. Then the time from the
//! end of a swipe to its candidates.
//!
//! Run with `cargo bench -p ademan-text`; prints microseconds and ratios. `cargo test --bench taps` runs it once, with few taps.

#![allow(clippy::disallowed_types, reason = "a benchmark reads the clock")]

#[path = "../tests/support/mod.rs"]
mod support;

use std::hint::black_box;
use std::time::{Duration, Instant};

use ademan_text::{Decoder, Model, Options, Prior, Tap, TouchModel};
use support::baselines::Spelling;
use support::latin_ime::LatinIme;
use support::session::nearest;
use support::simulated::{Person, TIERS, keyboard};
use support::swipes::{NearestShape, Swiper};

const TEXT: &str = "the quick brown fox jumps over the lazy dog, and it is not what you think of the weather in the evening. ";

fn percentile(times: &mut [Duration], share: f64) -> f64 {
    times.sort_unstable();
    let index = ((times.len() - 1) as f64 * share) as usize;
    times[index].as_secs_f64() * 1e6
}

/// Returns the negated distance of the nearest word of the same length.
fn flat(words: &[Vec<usize>], centers: &[[f32; 2]], taps: &[Tap]) -> f32 {
    let same = words.iter().filter(|word| word.len() == taps.len());
    let distance = |word: &Vec<usize>| {
        let letters = word.iter().zip(taps);
        let apart = |(&key, tap): (&usize, &Tap)| {
            let [x, y] = centers[key];
            (tap.position[0] - x).powi(2) + (tap.position[1] - y).powi(2)
        };
        -letters.map(apart).sum::<f32>()
    };
    same.map(distance).fold(f32::NEG_INFINITY, f32::max)
}

fn flat_words(model: &Model) -> Vec<Vec<usize>> {
    let keyboard = keyboard();
    let mut words = Vec::new();
    let mut open = vec![(0_u32, Vec::new())];
    while let Some((node, letters)) = open.pop() {
        if model.lexicon.node(node).word().is_some() {
            words.push(letters.clone());
        }
        for child in model.lexicon.children(node) {
            let letter = model.alphabet.letter(model.lexicon.node(child).symbol());
            if let Some(key) = keyboard.index(letter) {
                let mut longer = letters.clone();
                longer.push(key);
                open.push((child, longer));
            }
        }
    }
    words
}

fn main() {
    let is_bench = std::env::args().any(|argument| argument == "--bench");
    let rounds = if is_bench { 40 } else { 1 };
    let started = Instant::now();
    let model = Model::from_bytes(black_box(ademan_text::languages::ENGLISH)).expect("the model");
    println!(
        "load and check of {} bytes: {:.2} ms",
        ademan_text::languages::ENGLISH.len(),
        started.elapsed().as_secs_f64() * 1e3
    );
    let words = flat_words(&model);
    let centers: Vec<[f32; 2]> = keyboard().keys().iter().map(|key| key.center).collect();
    let spelling = Spelling::new(&model);
    let latin_ime = LatinIme::new(model.word_list(), &keyboard());
    println!("{} words", words.len());
    for tier in TIERS {
        let mut decoder = Decoder::new(
            model.clone(),
            keyboard(),
            TouchModel::new(Prior::default()),
            Options::default(),
        );
        let mut person = Person::new(tier, 5);
        let (mut taps, mut reads) = (Vec::new(), Vec::new());
        let (mut flats, mut spelled, mut searched) = (Vec::new(), Vec::new(), Vec::new());
        for _ in 0..rounds {
            let phrase = person.types(TEXT);
            for (index, &tap) in phrase.taps.iter().enumerate() {
                let tap_started = Instant::now();
                decoder.tap(black_box(tap));
                taps.push(tap_started.elapsed());
                black_box(decoder.candidates());
                reads.push(tap_started.elapsed());
                let word = &phrase.taps[index.saturating_sub(4)..=index];
                let flat_started = Instant::now();
                black_box(flat(&words, &centers, black_box(word)));
                flats.push(flat_started.elapsed());
                let text = nearest(decoder.keyboard(), word);
                let spelling_started = Instant::now();
                black_box(spelling.read(black_box(&text)));
                spelled.push(spelling_started.elapsed());
                let search_started = Instant::now();
                black_box(latin_ime.word(black_box(word)));
                searched.push(search_started.elapsed());
            }
            decoder.commit();
        }
        let reference = percentile(&mut flats, 0.5);
        let [symspell, symspell_slow] = [0.5, 0.99].map(|share| percentile(&mut spelled, share));
        let [latin, latin_slow] = [0.5, 0.99].map(|share| percentile(&mut searched, share));
        let [tap, read] =
            [&mut taps, &mut reads].map(|times| [0.5, 0.99].map(|share| percentile(times, share)));
        println!(
            "{}: tap p50 {:.1} µs p99 {:.1} µs, with candidates p50 {:.1} µs p99 {:.1} µs; flat list p50 {reference:.1} µs, SymSpell p50 {symspell:.1} µs p99 {symspell_slow:.1} µs, LatinIME p50 {latin:.1} µs p99 {latin_slow:.1} µs, ratios {:.3} {:.3} {:.3}",
            tier.name,
            tap[0],
            tap[1],
            read[0],
            read[1],
            read[0] / reference,
            read[0] / symspell,
            read[0] / latin,
        );
    }
    swipes(&model, rounds);
}

/// Prints the time from the end of a swipe to its candidates, beside the search for the nearest shape in all words.
fn swipes(model: &Model, rounds: usize) {
    let reference = NearestShape::new(model);
    for scatter in [3.0, 5.0, 8.0] {
        let touch = TouchModel::new(Prior::default());
        let decoder = Decoder::new(model.clone(), keyboard(), touch, Options::default());
        let mut decoder = decoder.with_swipes();
        let mut person = Swiper::new(scatter, 5);
        let (mut reads, mut shapes) = (Vec::new(), Vec::new());
        for word in TEXT.repeat(rounds).split([' ', ',', '.']) {
            let Some(path) = person.swipes(word) else {
                continue;
            };
            let started = Instant::now();
            black_box(decoder.swipe(black_box(path.points()), false));
            reads.push(started.elapsed());
            let shape_started = Instant::now();
            black_box(reference.read(black_box(&path)));
            shapes.push(shape_started.elapsed());
        }
        let [[read, slow], [shape, slow_shape]] = [&mut reads, &mut shapes]
            .map(|times| [0.5, 0.99].map(|share| percentile(times, share)));
        println!(
            "swipe at {scatter} mm: p50 {read:.0} µs p99 {slow:.0} µs; nearest shape p50 {shape:.0} µs p99 {slow_shape:.0} µs, ratio {:.2}",
            read / shape
        );
    }
}
