//! Prints tables of `docs/typing-measured.md` as Markdown: what `--learned` is worth to a person who comes back, and what words of
//! the person are worth and cost.
//!
//! `cargo run --release -p ademan-text --example returning -- [--phrases 500] [--people 60] [--tuning]`

#[path = "../tests/support/mod.rs"]
mod support;

use ademan_core::document::Document;
use ademan_text::correction::Restored;
use ademan_text::filter::Learned;
use ademan_text::{Corrector, Decoder, Keyboard, Mode, Model, Options};
use support::arguments::Sample;
use support::phrases::unknown;
use support::session::{Errors, Phrase, type_into};
use support::simulated::{Person, TIERS, Tier, keyboard};

/// The phrases of which a person is learned, and the first phrases of the next run.
const BEFORE: usize = 60;
const FIRST: usize = 10;
/// The words of a person.
const OWN_WORDS: usize = 100;

struct Bench<'m> {
    model: Model<'m>,
    keyboard: Keyboard,
    phrases: Vec<String>,
    seeds: std::ops::Range<u64>,
}

fn main() {
    let Some(sample) = Sample::from_arguments(500, 60) else {
        return;
    };
    let bench = Bench {
        model: Model::from_bytes(ademan_text::languages::ENGLISH).expect("the model"),
        keyboard: keyboard(),
        phrases: sample.phrases,
        seeds: sample.seeds,
    };
    bench.returning();
    bench.own_words();
    bench.pauses();
}

impl<'m> Bench<'m> {
    fn corrector(&self, learned: &Learned) -> Corrector<'m> {
        let decoder = Decoder::new(
            self.model.clone(),
            self.keyboard.clone(),
            learned.touch(),
            Options::default(),
        );
        let words = Restored::from(learned.words.clone());
        Corrector::new(decoder, Mode::Auto, words)
    }

    fn phrases(&self, first: usize, count: usize) -> impl Iterator<Item = &str> {
        let all = self.phrases.iter().map(String::as_str).cycle();
        all.skip(first).take(count)
    }

    /// Prints the errors in the first phrases of a run, of a new person and of one who was learned in a run before.
    fn returning(&self) {
        println!("| tier | new | with `--learned` |");
        println!("|---|---|---|");
        for tier in &TIERS[1..] {
            let mut errors = [Errors::default(); 2];
            for seed in self.seeds.clone() {
                let first = 70 * seed as usize;
                // The hand starts at the same place in each run, and drifts from there.
                let types = |from: usize, count: usize| -> Vec<Phrase> {
                    let mut person = Person::new(*tier, seed + 3_000);
                    let phrases = self.phrases(from, count);
                    phrases.map(|phrase| person.types(phrase)).collect()
                };
                let mut before = self.corrector(&Learned::default());
                type_into(&mut before, &types(first, BEFORE));
                let file = Document::new("me.ron", Learned::of(&before).to_ron());
                let known = Learned::parse(&file).expect("what was written is read");
                let today = types(first + BEFORE, FIRST);
                for (sum, learned) in errors.iter_mut().zip([Learned::default(), known]) {
                    let texts = type_into(&mut self.corrector(&learned), &today);
                    for (phrase, text) in today.iter().zip(&texts) {
                        sum.add(&phrase.meant, text);
                    }
                }
            }
            let [new, known] = errors.map(|sum| sum.cer());
            println!("| {} | {new:.2} | {known:.2} |", tier.name);
        }
        println!();
    }

    /// Prints the errors in words that the lexicon lacks, and in other text, without and with a list of words.
    fn own_words(&self) {
        println!("| tier | own words | listed | other text | with the list |");
        println!("|---|---|---|---|---|");
        for tier in &TIERS[..4] {
            let mut rows = [[Errors::default(); 2]; 2];
            for seed in self.seeds.clone() {
                let words = self.names(seed);
                let listed = Learned {
                    words: words.clone(),
                    ..Learned::default()
                };
                let with_names: Vec<String> = self
                    .phrases(20 * seed as usize, 20)
                    .zip(words.iter().cycle())
                    .map(|(phrase, name)| format!("{name} {phrase}"))
                    .collect();
                let names: Vec<&str> = words.iter().map(String::as_str).take(20).collect();
                let plain: Vec<&str> = self.phrases(20 * seed as usize, 20).collect();
                for (row, texts) in rows.iter_mut().zip([
                    with_names.iter().map(String::as_str).collect::<Vec<_>>(),
                    plain,
                ]) {
                    let typed = typed(*tier, seed, &texts);
                    for (sum, learned) in row.iter_mut().zip([&Learned::default(), &listed]) {
                        let read = type_into(&mut self.corrector(learned), &typed);
                        for ((phrase, text), name) in typed.iter().zip(&read).zip(&names) {
                            match phrase.meant.strip_prefix(name) {
                                Some(_) => sum.add(name, text.split(' ').next().unwrap_or("")),
                                None => sum.add(&phrase.meant, text),
                            }
                        }
                    }
                }
            }
            let [own, other] = rows.map(|row| row.map(|sum| sum.cer()));
            println!(
                "| {} | {:.2} | {:.2} | {:.2} | {:.2} |",
                tier.name, own[0], own[1], other[0], other[1]
            );
        }
    }

    /// Prints the errors of people who pause after each phrase, so that nothing before it is pending, and of those who do not.
    fn pauses(&self) {
        println!("| tier | without pauses | with a pause after each phrase |");
        println!("|---|---|---|");
        for tier in &TIERS {
            let mut errors = [Errors::default(); 2];
            for seed in self.seeds.clone() {
                let mut person = Person::new(*tier, seed + 7_000);
                let phrases = self.phrases(BEFORE * seed as usize, BEFORE);
                let typed: Vec<Phrase> = phrases.map(|phrase| person.types(phrase)).collect();
                let [going_on, pausing] = &mut errors;
                let texts = type_into(&mut self.corrector(&Learned::default()), &typed);
                for (phrase, text) in typed.iter().zip(&texts) {
                    going_on.add(&phrase.meant, text);
                }
                let mut corrector = self.corrector(&Learned::default());
                for phrase in &typed {
                    let text = type_into(&mut corrector, std::slice::from_ref(phrase));
                    pausing.add(&phrase.meant, &text[0]);
                    corrector.reset();
                }
            }
            let [going_on, pausing] = errors.map(|sum| sum.cer());
            println!("| {} | {going_on:.2} | {pausing:.2} |", tier.name);
        }
        println!();
    }

    /// Returns words of letters that the lexicon lacks.
    fn names(&self, seed: u64) -> Vec<String> {
        let mut random = fastrand::Rng::with_seed(seed);
        std::iter::repeat_with(|| unknown(&mut random, &self.model))
            .filter(|word| word.chars().all(char::is_alphabetic))
            .take(OWN_WORDS)
            .collect()
    }
}

fn typed(tier: Tier, seed: u64, texts: &[&str]) -> Vec<Phrase> {
    let mut person = Person::new(tier, seed + 5_000);
    texts.iter().map(|text| person.types(text)).collect()
}
