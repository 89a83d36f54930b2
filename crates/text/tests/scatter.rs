//! Phrases that the model was not built from, tapped by a simulated person.

mod support;

use ademan_text::{Model, Prior, Tap};
use support::arguments::amount;
use support::baselines::{Flat, Spelling};
use support::latin_ime::LatinIme;
use support::phrases::{abbreviations, phrases, unknown_phrases};
use support::session::{Errors, Phrase, correct, corrector, decode, nearest, type_into};
use support::simulated::{PITCH, Person, TIERS, Tier, keyboard};

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

/// Returns taps in the middle of the keys of a text, moved to the right by a share of a key.
fn taps_on_keys(text: &str, share: f32) -> Phrase {
    let keyboard = keyboard();
    let tap = |character: char| {
        let key = keyboard.index(character).expect("a key");
        let [x, y] = keyboard.keys()[key].center;
        Tap::at(x + share * PITCH, y)
    };
    Phrase {
        meant: text.to_owned(),
        taps: text.chars().map(tap).collect(),
        space: None,
    }
}

#[test]
fn the_weights_of_latin_ime_find_a_word_with_one_error_of_each_kind() {
    // Words that are long and unlike the others give the costs of the others their scale.
    let words: [(&str, f32); 5] = [
        ("zzzzzzzz", -1.0),
        ("the", -9.0),
        ("quick", -9.5),
        ("fox", -10.0),
        ("xxxxxxxxxx", -11.0),
    ];
    let list = words.map(|(word, log_probability)| (word.to_owned(), log_probability));
    let reference = LatinIme::new(list.into(), &keyboard());
    for (typed, share, expected) in [
        ("the quick fox", 0.0, "the quick fox"),
        ("fox", 0.45, "fox"),
        ("the quik fox", 0.0, "the quick fox"),
        ("the quiick fox", 0.0, "the quick fox"),
        ("the qucik fox", 0.0, "the quick fox"),
        ("the quack fox", 0.0, "the quick fox"),
        ("thequick fox", 0.0, "the quick fox"),
    ] {
        let read = reference.read(&taps_on_keys(typed, share));
        assert_eq!(read, expected, "{typed}");
    }
    assert_eq!(LatinIme::new(Vec::new(), &keyboard()).word(&[]), None);
}

#[test]
fn successive_taps_are_read_better_by_a_model_that_knows_their_correlation() {
    let Some(mut phrases) = phrases(false) else {
        return;
    };
    phrases.truncate(40);
    let model = Model::from_bytes(ademan_text::languages::ENGLISH).expect("the model");
    let keyboard = keyboard();
    let independent = Prior {
        same_hand: 0.0,
        other_hand: 0.0,
        pairs: 1e6,
        ..Prior::default()
    };
    let errors = |prior: Prior| {
        let mut errors = Errors::default();
        for seed in 1_000..1_004 {
            let mut person = Person::new(TIERS[3], seed);
            let typed: Vec<Phrase> = phrases.iter().map(|phrase| person.types(phrase)).collect();
            let texts = decode(&model, &keyboard, prior, &typed);
            for (phrase, text) in typed.iter().zip(&texts) {
                errors.add(&phrase.meant, text);
            }
        }
        errors
    };
    let (without, with) = (errors(independent), errors(Prior::default()));
    println!(
        "CER {:.2} % without, {:.2} % with",
        without.cer(),
        with.cer()
    );
    assert!(with.cer() < 0.9 * without.cer(), "{without:?} {with:?}");
}

/// The phrases for which limits were measured.
const SMALL: usize = 60;

#[test]
fn scattered_taps_are_read_with_a_fraction_of_the_errors_of_the_nearest_keys() {
    let tuning = std::env::var_os("ADEMAN_TEXT_TUNING").is_some();
    let Some(mut phrases) = phrases(!tuning) else {
        return;
    };
    phrases.truncate(amount("ADEMAN_TEXT_PHRASES", SMALL));
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
            spelling: spelled,
            flat,
            decoded,
        } = measured;
        println!(
            "{}: CER nearest key {:.2} %, SymSpell {:.2} %, flat lexicon {:.2} %, decoded {:.2} % of {} characters; words {:.1} % and {:.1} %",
            tier.name,
            nearest.cer(),
            spelled.cer(),
            flat.cer(),
            decoded.cer(),
            nearest.characters,
            nearest.wer(),
            decoded.wer(),
        );
        let is_small = phrases.len() == SMALL && people == 1 && !tuning;
        let limit = if is_small { tier.limit } else { nearest.cer() };
        assert!(
            decoded.cer() <= limit,
            "{}: {nearest:?} {decoded:?}",
            tier.name
        );
    }
}

#[test]
fn unknown_words_passwords_and_identifiers_are_not_made_worse() {
    let model = Model::from_bytes(ademan_text::languages::ENGLISH).expect("the model");
    let keyboard = keyboard();
    let phrases = unknown_phrases(&model, amount("ADEMAN_TEXT_PHRASES", 600), 77);
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

/// The most abbreviations in percent that are read as other words: the upper end of the 95 % interval of what was measured.
const ABBREVIATIONS: usize = 25;

#[test]
fn abbreviations_stay_if_the_first_taps_of_a_person_are_precise() {
    let Some(sentences) = phrases(true) else {
        return;
    };
    let model = Model::from_bytes(ademan_text::languages::ENGLISH).expect("the model");
    let keyboard = keyboard();
    let words = abbreviations(&model, &sentences, 200);
    let precise = Tier {
        scatter: 1.0,
        ..TIERS[0]
    };
    let mut wrong = 0;
    for (word, seed) in words.iter().zip(0..) {
        let text = format!("i use the {word}");
        let typed = [Person::new(precise, seed).types(&text)];
        let read = decode(&model, &keyboard, Prior::default(), &typed);
        wrong += usize::from(read[0].to_lowercase() != text);
    }
    println!("abbreviations: {wrong} of {} wrong", words.len());
    assert!(100 * wrong <= ABBREVIATIONS * words.len(), "{wrong}");
}

#[test]
fn what_stays_in_a_text_field_is_about_what_is_read_from_whole_phrases() {
    let Some(mut phrases) = phrases(false) else {
        return;
    };
    phrases.truncate(30);
    let model = Model::from_bytes(ademan_text::languages::ENGLISH).expect("the model");
    let keyboard = keyboard();
    for tier in [TIERS[1], TIERS[3], TIERS[5]] {
        let mut person = Person::new(tier, 1_007);
        let typed: Vec<Phrase> = phrases.iter().map(|phrase| person.types(phrase)).collect();
        let prior = Prior::default();
        let texts = decode(&model, &keyboard, prior, &typed);
        let fields = correct(&model, &keyboard, prior, &typed);
        let (mut read, mut field) = (Errors::default(), Errors::default());
        for ((phrase, text), shown) in typed.iter().zip(&texts).zip(&fields) {
            read.add(&phrase.meant, text);
            field.add(&phrase.meant, shown);
        }
        println!(
            "{}: read {:.2} %, in the text field {:.2} %",
            tier.name,
            read.cer(),
            field.cer()
        );
        assert!(field.cer() <= 1.3 * read.cer() + 1.0, "{read:?} {field:?}");
    }
}

#[test]
fn a_hand_that_drifts_off_the_space_bar_is_corrected_word_by_word() {
    let Some(mut phrases) = phrases(false) else {
        return;
    };
    phrases.truncate(20);
    let model = Model::from_bytes(ademan_text::languages::ENGLISH).expect("the model");
    let keyboard = keyboard();
    let mut person = Person::new(TIERS[0], 1_011);
    let mut typed: Vec<Phrase> = phrases.iter().map(|phrase| person.types(phrase)).collect();
    let taps = typed
        .iter_mut()
        .flat_map(|phrase| phrase.taps.iter_mut().chain(&mut phrase.space));
    // One and a half rows up, where the taps of spaces hit letters.
    for (count, tap) in taps.enumerate() {
        tap.position[1] -= (0.2 * count as f32).min(28.0);
    }
    let fields = correct(&model, &keyboard, Prior::default(), &typed);
    let mut errors = Errors::default();
    for (phrase, text) in typed.iter().zip(&fields) {
        errors.add(&phrase.meant, text);
    }
    println!("in the text field {:.2} %", errors.cer());
    assert!(errors.cer() <= 1.0, "{errors:?}");
}

#[test]
fn a_person_who_pauses_after_each_phrase_is_learned_all_the_same() {
    let Some(mut phrases) = phrases(false) else {
        return;
    };
    phrases.truncate(40);
    let model = Model::from_bytes(ademan_text::languages::ENGLISH).expect("the model");
    // A hand that drifts.
    let mut person = Person::new(TIERS[5], 7_000);
    let mut corrector = corrector(&model, &keyboard(), Prior::default());
    let mut errors = Errors::default();
    for phrase in phrases.iter().map(|phrase| person.types(phrase)) {
        let text = type_into(&mut corrector, std::slice::from_ref(&phrase));
        errors.add(&phrase.meant, &text[0]);
        corrector.reset();
    }
    println!("in the text field {:.2} %", errors.cer());
    assert!(errors.cer() <= 1.0, "{errors:?}");
}
