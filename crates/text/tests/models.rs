//! Models are built alike from the same lines, and files that are none are refused.

use ademan_text::build::{BuildError, Builder};
use ademan_text::model::lexicon::Case;
use ademan_text::{Model, ModelError};

const LIST: &str = "cat\t5\ncar\t3\nAnna\t1\nNASA\t1\ndon't\t2\nat\nNiño\t1";
const TEXT: &str = "The cat saw Anna.\nThe cat saw the car, and NASA.\nThe cat sat.";

fn built() -> Vec<u8> {
    let mut builder = Builder::new();
    builder.words(LIST);
    builder.text(TEXT);
    builder.build().expect("a model")
}

#[test]
fn the_order_of_lines_does_not_matter() {
    let reversed = |text: &str| text.lines().rev().collect::<Vec<_>>().join("\n");
    let mut builder = Builder::new();
    builder.text(&reversed(TEXT));
    builder.words(&reversed(LIST));
    assert!(builder.build() == Ok(built()));
}

#[test]
fn words_pairs_and_spelling_are_found_again() {
    let bytes = built();
    let model = Model::from_bytes(&bytes).expect("a model");
    assert_eq!(model.find("Cat").map(|found| found.case), Some(Case::Lower));
    assert_eq!(
        model.find("anna").map(|found| found.case),
        Some(Case::Title)
    );
    assert_eq!(
        model.find("nasa").map(|found| found.case),
        Some(Case::Upper)
    );
    assert_eq!(
        model.find("niño").map(|found| found.case),
        Some(Case::Title)
    );
    assert!(model.find("don't").is_some());
    for absent in ["ca", "cats", "", "x"] {
        assert_eq!(model.find(absent), None, "{absent}");
    }
    // `the` was seen six times with what the sentences say, `cat` three times behind it.
    let [the, cat, car] = ["the", "cat", "car"].map(|word| model.find(word).expect("a word"));
    let after = |word: ademan_text::model::Found| {
        model
            .bigrams
            .after(model.row(the.node), word.node, word.log_probability)
    };
    assert!(after(cat) > cat.log_probability + 0.5);
    assert!(after(car) < car.log_probability);
    let symbol = |letter| model.alphabet.symbol(letter).expect("a letter");
    let (first, state) = model
        .spelling
        .letter(ademan_text::model::spelling::START, symbol('c'));
    let (likely, _) = model.spelling.letter(state, symbol('a'));
    let (unlikely, _) = model.spelling.letter(state, symbol('t'));
    assert!(first < 0.0 && likely > unlikely);
}

#[test]
fn probabilities_sum_to_one() {
    let bytes = built();
    let model = Model::from_bytes(&bytes).expect("a model");
    let mut state = ademan_text::model::spelling::START;
    for letter in "cat".chars() {
        let all = 0..=model.alphabet.len() as u8;
        let sum: f32 = all
            .map(|symbol| model.spelling.letter(state, symbol).0.exp())
            .sum();
        assert!((0.85..1.15).contains(&sum), "{sum} before {letter}");
        state = model
            .spelling
            .letter(state, model.alphabet.symbol(letter).expect("a letter"))
            .1;
    }
    let words = [
        "cat", "car", "anna", "nasa", "don't", "at", "niño", "the", "saw",
    ];
    let sum: f32 = words
        .iter()
        .filter_map(|word| model.find(word))
        .map(|found| found.log_probability.exp())
        .sum();
    assert!((0.85..1.1).contains(&sum), "{sum}");
}

#[test]
fn each_damaged_byte_is_refused() {
    let bytes = built();
    for index in 0..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[index] ^= 0x10;
        let error = Model::from_bytes(&damaged).expect_err("a damaged model");
        match index {
            0..8 => assert_eq!(error, ModelError::Foreign),
            8..12 => assert!(matches!(error, ModelError::Version(_))),
            12..16 => assert!(matches!(error, ModelError::Length { .. })),
            16..24 => assert_eq!(error, ModelError::Checksum),
            24..56 => assert!(matches!(error, ModelError::Length { .. })),
            _ => assert_eq!(error, ModelError::Checksum),
        }
    }
}

#[test]
fn short_long_and_foreign_files_are_refused_with_a_remedy() {
    let bytes = built();
    for length in 0..bytes.len() {
        assert!(
            Model::from_bytes(&bytes[..length]).is_err(),
            "{length} bytes"
        );
    }
    let mut long = bytes.clone();
    long.push(0);
    let error = Model::from_bytes(&long).expect_err("a long file");
    assert_eq!(
        error.to_string(),
        format!(
            "it has {} bytes instead of {}; copy or build it again",
            bytes.len() + 1,
            bytes.len()
        ),
    );
    let foreign = Model::from_bytes(b"\x7fELF").expect_err("a foreign file");
    assert!(
        foreign.to_string().contains("ademan text build"),
        "{foreign}"
    );
}

#[test]
fn contradictions_behind_a_right_checksum_do_no_harm() {
    // A faulty or malicious builder could write such files.
    let bytes = built();
    let mut random = fastrand::Rng::with_seed(3);
    let (mut refused, mut accepted) = (0, 0);
    for _ in 0..3_000 {
        let mut changed = bytes.clone();
        for _ in 0..random.usize(1..4) {
            let index = random.usize(56..changed.len());
            changed[index] = random.u8(..);
        }
        let sum = checksum(&changed[24..]);
        changed[16..24].copy_from_slice(&sum.to_le_bytes());
        match Model::from_bytes(&changed) {
            Err(error) => {
                assert!(matches!(error, ModelError::Damaged(_)), "{error}");
                refused += 1;
            }
            Ok(model) => {
                accepted += 1;
                let mut state = ademan_text::model::spelling::START;
                for word in ["cat", "don't", "anna"] {
                    let found = model.find(word);
                    let row = model.row(found.map_or(0, |found| found.node));
                    let _ = std::hint::black_box(model.bigrams.after(row, 3, -1.0));
                    for symbol in 0..model.alphabet.len() as u8 {
                        state = model.spelling.letter(state, symbol).1;
                    }
                }
            }
        }
    }
    assert!(refused > 100 && accepted > 100, "{refused} {accepted}");
}

/// The checksum of the format, written again.
fn checksum(bytes: &[u8]) -> u64 {
    const MULTIPLIER: u64 = 0x9e37_79b9_7f4a_7c15;
    let mut sum = bytes.len() as u64;
    let mut chunks = bytes.chunks_exact(8);
    for chunk in &mut chunks {
        let word = u64::from_le_bytes(chunk.try_into().expect("eight bytes"));
        sum = (sum ^ word).wrapping_mul(MULTIPLIER).rotate_left(29);
    }
    let mut last = [0; 8];
    last[..chunks.remainder().len()].copy_from_slice(chunks.remainder());
    (sum ^ u64::from_le_bytes(last)).wrapping_mul(MULTIPLIER)
}

#[test]
fn without_words_there_is_no_model() {
    assert_eq!(Builder::new().build(), Err(BuildError::Empty));
    let mut builder = Builder::new();
    builder.words("1\n2\n");
    assert_eq!(builder.build(), Err(BuildError::Empty));
    let letters: String = (0x4e00_u32..0x4e00 + 70)
        .filter_map(char::from_u32)
        .collect();
    let list: Vec<String> = letters.chars().map(String::from).collect();
    builder.words(&list.join("\n"));
    assert_eq!(builder.build(), Err(BuildError::Letters(70)));
}
