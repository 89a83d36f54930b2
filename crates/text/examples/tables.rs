//! Prints the measured tables of `docs/typing-measured.md` as Markdown: simulated taps of phrases that the models have not seen.
//!
//! `cargo run --release -p ademan-text --example tables -- [--phrases 500] [--people 20] [--tuning]`; with `--tuning`, phrases and
//! people are those on which costs may be tuned. `--show T1` prints what was read wrong in a tier.

#[path = "../tests/support/mod.rs"]
mod support;

use ademan_text::{Keyboard, Model, Prior};
use support::arguments::{Sample, argument};
use support::baselines::{Flat, Spelling};
use support::latin_ime::LatinIme;
use support::phrases::{abbreviations, phrases, unknown_phrases, words};
use support::session::{Errors, Phrase, correct, decode, nearest, normal, read};
use support::simulated::{Person, TIERS, Tier, keyboard};
use support::statistics::{ByPhrase, Kinds};

/// The goal of each tier in percent of wrong characters.
const GOALS: [f64; 6] = [0.02, 0.10, 1.0, 2.0, 4.0, 0.3];

/// The instrument.
struct Bench<'m> {
    model: Model<'m>,
    keyboard: Keyboard,
    phrases: Vec<String>,
    seeds: std::ops::Range<u64>,
    is_tuning: bool,
    /// The tier of which wrong texts are printed.
    shown: Option<String>,
}

/// The errors of the ways to read the same taps.
struct Measured {
    nearest: ByPhrase,
    spelling: ByPhrase,
    flat: ByPhrase,
    latin_ime: ByPhrase,
    shown: ByPhrase,
    best: ByPhrase,
    corrected: ByPhrase,
    kinds: Kinds,
}

fn main() {
    let Some(sample) = Sample::from_arguments(500, 20) else {
        return;
    };
    let bench = Bench {
        model: Model::from_bytes(ademan_text::languages::ENGLISH).expect("the model"),
        keyboard: keyboard(),
        phrases: sample.phrases,
        seeds: sample.seeds,
        is_tuning: sample.is_tuning,
        shown: argument("--show"),
    };
    bench.vocabulary();
    let measured: Vec<Measured> = TIERS.iter().map(|&tier| bench.measure(tier)).collect();
    bench.characters(&measured);
    bench.words(&measured);
    bench.unknown();
    bench.short();
    bench.learning();
}

/// Returns a rate of a tier with its interval.
fn cell(errors: &ByPhrase, rate: fn(&Errors) -> f64) -> String {
    let [low, high] = errors.interval(rate);
    format!("{:.2} ({low:.2}–{high:.2})", rate(&errors.total()))
}

impl Bench<'_> {
    fn vocabulary(&self) {
        let all = self.phrases.iter().flat_map(|phrase| words(phrase));
        let (mut count, mut unknown) = (0, 0);
        for word in all {
            count += 1;
            unknown += usize::from(self.model.find(word).is_none());
        }
        println!(
            "{} phrases, {} people, {count} words, {unknown} of them ({:.2} %) unknown to the lexicon.\n",
            self.phrases.len(),
            self.seeds.end - self.seeds.start,
            100.0 * f64::from(rate(unknown, count)),
        );
    }

    fn measure(&self, tier: Tier) -> Measured {
        let fresh = || ByPhrase::new(self.phrases.len());
        let mut measured = Measured {
            nearest: fresh(),
            spelling: fresh(),
            flat: fresh(),
            latin_ime: fresh(),
            shown: fresh(),
            best: fresh(),
            corrected: fresh(),
            kinds: Kinds::default(),
        };
        let spelling = (!self.is_tuning).then(|| Spelling::new(&self.model));
        let flat = Flat::new(&self.model, &self.keyboard, tier.scatter);
        let latin_ime = LatinIme::new(self.model.word_list(), &self.keyboard);
        for seed in self.seeds.clone() {
            let mut person = Person::new(tier, seed);
            let typed: Vec<Phrase> = self
                .phrases
                .iter()
                .map(|phrase| person.types(phrase))
                .collect();
            let prior = Prior::default();
            let texts = read(&self.model, &self.keyboard, prior, &typed, true);
            let fields = correct(&self.model, &self.keyboard, prior, &typed);
            for (index, (phrase, text)) in typed.iter().zip(&texts).enumerate() {
                let naive = nearest(&self.keyboard, &phrase.taps);
                let meant = &phrase.meant;
                if self.shown.as_deref() == Some(tier.name)
                    && (normal(meant) != normal(&text.shown)
                        || normal(meant) != normal(&fields[index]))
                {
                    println!("{meant}\n  {naive}\n  {}\n  {}", text.shown, fields[index]);
                }
                measured.nearest.0[index].add(meant, &naive);
                measured.shown.0[index].add(meant, &text.shown);
                measured.best.0[index].add(meant, &text.best);
                measured.corrected.0[index].add(meant, &fields[index]);
                measured.kinds.add(&self.model, meant, &naive, &text.shown);
                if let Some(spelling) = &spelling {
                    measured.spelling.0[index].add(meant, &spelling.read(&naive));
                    measured.latin_ime.0[index].add(meant, &latin_ime.read(phrase));
                    // Slow, and as bad for one person as for many.
                    if seed == self.seeds.start {
                        measured.flat.0[index].add(meant, &flat.read(phrase));
                    }
                }
            }
        }
        measured
    }

    fn characters(&self, measured: &[Measured]) {
        println!(
            "| tier | nearest key | SymSpell | flat lexicon | LatinIME | decoded | in the text field | divided by | goal |"
        );
        println!("|---|---|---|---|---|---|---|---|---|");
        for ((tier, row), goal) in TIERS.iter().zip(measured).zip(GOALS) {
            let plain = row.nearest.total().cer();
            let [spelling, flat, latin_ime] =
                [&row.spelling, &row.flat, &row.latin_ime].map(|errors| errors.total().cer());
            println!(
                "| {} | {plain:.2} | {spelling:.2} | {flat:.2} | {latin_ime:.2} | {} | {} | {:.1} | {goal} |",
                tier.name,
                cell(&row.shown, Errors::cer),
                cell(&row.corrected, Errors::cer),
                plain / row.shown.total().cer(),
            );
        }
        println!();
    }

    fn words(&self, measured: &[Measured]) {
        println!(
            "| tier | wrong words | without margin, characters | kept | put right | made wrong | left | other word | other letters | spaces | punctuation | unknown word |"
        );
        println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
        for (tier, row) in TIERS.iter().zip(measured) {
            let kinds = row.kinds;
            println!(
                "| {} | {} | {:.2} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
                tier.name,
                cell(&row.shown, Errors::wer),
                row.best.total().cer(),
                kinds.kept,
                kinds.righted,
                kinds.spoiled,
                kinds.left,
                kinds.other,
                kinds.letters,
                kinds.spaces,
                kinds.punctuation,
                kinds.unknown,
            );
        }
        println!();
    }

    /// Prints the errors on words that no lexicon has.
    fn unknown(&self) {
        println!("| scatter | nearest key | decoded |");
        println!("|---|---|---|");
        let seed = if self.is_tuning { 177 } else { 277 };
        let phrases = unknown_phrases(&self.model, self.phrases.len().min(200), seed);
        for scatter in [1.0, 3.0, 5.0] {
            let tier = Tier {
                scatter,
                ..TIERS[0]
            };
            let (mut plain, mut decoded) =
                (ByPhrase::new(phrases.len()), ByPhrase::new(phrases.len()));
            for person_seed in self.seeds.clone() {
                let mut person = Person::new(tier, person_seed + 500);
                let typed: Vec<Phrase> =
                    phrases.iter().map(|phrase| person.types(phrase)).collect();
                let texts = decode(&self.model, &self.keyboard, Prior::default(), &typed);
                for (index, (phrase, text)) in typed.iter().zip(&texts).enumerate() {
                    let naive = nearest(&self.keyboard, &phrase.taps);
                    plain.0[index].add(&phrase.meant, &naive);
                    decoded.0[index].add(&phrase.meant, text);
                }
            }
            println!(
                "| {scatter} mm | {} | {} |",
                cell(&plain, Errors::cer),
                cell(&decoded, Errors::cer)
            );
        }
        println!();
    }

    /// Prints which abbreviations that no lexicon has are read wrong, as the first words of a person and after 30 phrases.
    fn short(&self) {
        let (Some(sentences), Some(before)) = (phrases(!self.is_tuning), phrases(self.is_tuning))
        else {
            return;
        };
        let words = abbreviations(&self.model, &sentences, 300);
        println!(
            "{} abbreviations after `the`; wrong ones in percent.\n",
            words.len()
        );
        println!("| scatter | nearest key | first words | after 30 phrases |");
        println!("|---|---|---|---|");
        for scatter in [1.0, 3.0, 5.0] {
            let tier = Tier {
                scatter,
                ..TIERS[0]
            };
            let mut wrong = [0; 3];
            for (word, seed) in words.iter().zip(self.seeds.start..) {
                let text = format!("the {word}");
                let mut person = Person::new(tier, seed + 4_000);
                let mut typed: Vec<Phrase> = (0..30)
                    .map(|index| person.types(&before[(seed as usize * 30 + index) % before.len()]))
                    .collect();
                typed.push(person.types(&text));
                let last = typed.len() - 1;
                let reads = |taps: &[Phrase]| {
                    let texts = decode(&self.model, &self.keyboard, Prior::default(), taps);
                    texts.last().map(|read| normal(read))
                };
                let near = nearest(&self.keyboard, &typed[last].taps);
                let texts = [Some(near), reads(&typed[last..]), reads(&typed)];
                for (count, read) in wrong.iter_mut().zip(texts) {
                    *count += usize::from(read.as_deref() != Some(text.as_str()));
                }
            }
            let [near, first, later] =
                wrong.map(|count| 100.0 * f64::from(rate(count, words.len())));
            println!("| {scatter} mm | {near:.1} | {first:.1} | {later:.1} |");
        }
        println!();
    }

    /// Prints the errors in the first words of a person with an offset, beside the errors of a model that learns nothing.
    fn learning(&self) {
        println!("| words | learned | not learned |");
        println!("|---|---|---|");
        let people = (self.seeds.end - self.seeds.start) * 5;
        let mut by_words = vec![[Errors::default(); 2]; 12];
        for number in 0..people {
            let mut person = Person::new(TIERS[5], self.seeds.start + 2_000 + number);
            let start = 12 * number as usize;
            let typed: Vec<Phrase> = (0..12)
                .map(|index| person.types(&self.phrases[(start + index) % self.phrases.len()]))
                .collect();
            for (column, learns) in [true, false].into_iter().enumerate() {
                let texts = read(
                    &self.model,
                    &self.keyboard,
                    Prior::default(),
                    &typed,
                    learns,
                );
                let mut count = 0;
                for (phrase, text) in typed.iter().zip(&texts) {
                    if let Some(errors) = by_words.get_mut(count / 5) {
                        errors[column].add(&phrase.meant, &text.shown);
                    }
                    count += phrase.meant.split(' ').count();
                }
            }
        }
        for (index, [learned, frozen]) in by_words.iter().enumerate() {
            println!(
                "| {}–{} | {:.2} | {:.2} |",
                5 * index + 1,
                5 * index + 5,
                learned.cer(),
                frozen.cer()
            );
        }
    }
}

fn rate(unknown: usize, count: usize) -> f32 {
    unknown as f32 / count.max(1) as f32
}
