//! Phrases that the model was not built from, tapped by a simulated person.

mod support;

use ademan_text::build::held_out;
use ademan_text::{Model, Prior};
use support::baselines::{Flat, Spelling};
use support::session::{Errors, Phrase, decode, nearest};
use support::shared;
use support::simulated::{Person, TIERS, Tier, keyboard};

/// The phrases on which costs were tuned are those of the other half.
fn phrases(reported: bool) -> Option<Vec<String>> {
    let text =
        std::fs::read_to_string(shared("data/text/common_voice_en.txt")?).expect("sentences");
    let lines = text.lines().enumerate().filter(|&(line, _)| held_out(line));
    let half = lines.filter(|&(line, _)| (line / 20 % 2 == 1) == reported);
    let plain = |text: &String| {
        let typed = |letter: char| letter.is_ascii_lowercase() || " ',.?-".contains(letter);
        text.chars().all(typed) && (15..60).contains(&text.len())
    };
    Some(
        half.map(|(_, line)| line.to_lowercase())
            .filter(plain)
            .collect(),
    )
}

/// The errors of the four ways to read the same taps.
#[derive(Default)]
struct Measured {
    nearest: Errors,
    spelling: Errors,
    flat: Errors,
    decoded: Errors,
}

fn measure(
    tier: Tier,
    phrases: &[String],
    seeds: std::ops::Range<u64>,
    spelling: Option<&Spelling>,
) -> Measured {
    let model = Model::from_bytes(ademan_text::languages::ENGLISH).expect("the model");
    let keyboard = keyboard();
    let flat = Flat::new(&model, &keyboard, tier.scatter);
    let mut measured = Measured::default();
    for seed in seeds {
        let mut person = Person::new(tier, seed);
        let typed: Vec<Phrase> = phrases.iter().map(|phrase| person.types(phrase)).collect();
        let texts = decode(&model, &keyboard, Prior::default(), &typed);
        for (phrase, text) in typed.iter().zip(&texts) {
            let naive = nearest(&keyboard, &phrase.taps);
            if std::env::var_os("ADEMAN_TEXT_SHOW").is_some() && phrase.meant != text.to_lowercase()
            {
                println!("{}\n   {naive}\n   {text}", phrase.meant);
            }
            measured.nearest.add(&phrase.meant, &naive);
            measured.decoded.add(&phrase.meant, text);
            if let Some(spelling) = spelling {
                measured.spelling.add(&phrase.meant, &spelling.read(&naive));
                measured.flat.add(&phrase.meant, &flat.read(phrase));
            }
        }
    }
    measured
}

/// How many phrases of a person, and how many people: more with `ADEMAN_TEXT_PHRASES` and `ADEMAN_TEXT_PEOPLE`.
fn amount(name: &str, default: usize) -> usize {
    let text = std::env::var(name);
    text.map_or(default, |text| text.parse().expect("a number"))
}

#[test]
fn scattered_taps_are_read_with_a_fraction_of_the_errors_of_the_nearest_keys() {
    let tuning = std::env::var_os("ADEMAN_TEXT_TUNING").is_some();
    let Some(mut phrases) = phrases(!tuning) else {
        return;
    };
    phrases.truncate(amount("ADEMAN_TEXT_PHRASES", 60));
    let people = amount("ADEMAN_TEXT_PEOPLE", 1) as u64;
    let seeds = if tuning {
        1_000..1_000 + people
    } else {
        0..people
    };
    let model = Model::from_bytes(ademan_text::languages::ENGLISH).expect("the model");
    let spelling = (!tuning).then(|| Spelling::new(&model));
    for tier in TIERS {
        let measured = measure(tier, &phrases, seeds.clone(), spelling.as_ref());
        let Measured {
            nearest,
            spelling,
            flat,
            decoded,
        } = measured;
        println!(
            "{}: CER nearest key {:.2} %, SymSpell {:.2} %, flat lexicon {:.2} %, decoded {:.2} % of {} characters; words {:.1} % and {:.1} %",
            tier.name,
            nearest.cer(),
            spelling.cer(),
            flat.cer(),
            decoded.cer(),
            nearest.characters,
            nearest.wer(),
            decoded.wer(),
        );
        assert!(
            decoded.cer() <= nearest.cer(),
            "{}: {nearest:?} {decoded:?}",
            tier.name
        );
    }
}

/// Names, identifiers and passwords that no lexicon has: syllables, letters, letters with digits.
fn unknown(random: &mut fastrand::Rng, model: &Model) -> String {
    let pick = |random: &mut fastrand::Rng, from: &str| {
        char::from(from.as_bytes()[random.usize(..from.len())])
    };
    loop {
        let length = random.usize(5..11);
        let kind = random.u32(0..3);
        let word: String = (0..length)
            .map(|place| match (kind, place % 2) {
                (0, 0) => pick(random, "bcdfghjklmnprstvwz"),
                (0, _) => pick(random, "aeiou"),
                (1, _) => pick(random, "abcdefghijklmnopqrstuvwxyz"),
                _ => pick(random, "abcdefghijklmnopqrstuvwxyz0123456789"),
            })
            .collect();
        if model.find(&word).is_none() {
            return word;
        }
    }
}

#[test]
fn unknown_words_passwords_and_identifiers_are_not_made_worse() {
    let model = Model::from_bytes(ademan_text::languages::ENGLISH).expect("the model");
    let keyboard = keyboard();
    let mut random = fastrand::Rng::with_seed(77);
    let phrases: Vec<String> = (0..amount("ADEMAN_TEXT_PHRASES", 60))
        .map(|_| {
            (0..3)
                .map(|_| unknown(&mut random, &model))
                .collect::<Vec<_>>()
                .join(" ")
        })
        .collect();
    for scatter in [1.0, 3.0, 5.0] {
        let tier = Tier {
            scatter,
            ..TIERS[0]
        };
        let mut person = Person::new(tier, 5);
        let typed: Vec<Phrase> = phrases.iter().map(|phrase| person.types(phrase)).collect();
        let (mut plain, mut decoded) = (Errors::default(), Errors::default());
        let texts = decode(&model, &keyboard, Prior::default(), &typed);
        for (phrase, text) in typed.iter().zip(&texts) {
            let naive = nearest(&keyboard, &phrase.taps);
            if std::env::var_os("ADEMAN_TEXT_SHOW").is_some() && phrase.meant != *text {
                println!("{}\n   {naive}\n   {text}", phrase.meant);
            }
            plain.add(&phrase.meant, &naive);
            decoded.add(&phrase.meant, text);
        }
        println!(
            "unknown words at {scatter} mm: CER nearest key {:.2} %, decoded {:.2} %",
            plain.cer(),
            decoded.cer()
        );
        // At 5 mm the taps themselves are ambiguous, and a known word wins now and then.
        let allowed = if scatter < 5.0 { 0.1 } else { 0.3 };
        assert!(
            decoded.cer() <= plain.cer() + allowed,
            "{plain:?} {decoded:?}"
        );
    }
}
