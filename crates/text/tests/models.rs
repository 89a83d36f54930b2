//! Models are built alike from the same lines, and files that are none are refused.

use ademan_text::build::{BuildError, Builder, LineError};
use ademan_text::model::lexicon::Case;
use ademan_text::{Model, ModelError};

const LIST: &str = "cat\t5\ncar\t3\nAnna\t1\nNASA\t1\ndon't\t2\nat\nNiño\t1";
const TEXT: &str = "The cat saw Anna.\nThe cat saw the car, and NASA.\nThe cat sat.";

/// A model of another program: `car` is likely after `the`, and after `saw the` certain.
const ARPA: &str = "\\data\\\nngram 1=6\nngram 2=3\nngram 3=1\n
\\1-grams:\n-1.0\tcat\t-0.3\n-1.0\tcar\n-0.5\tThe\t-0.2\n-0.7 saw -0.1\n-99 <s> -0.4\n-1 truck\n
\\2-grams:\n-0.1\tThe car\t-0.2\n-0.3\tsaw The -0.1\n-0.2 <s> car\n
\\3-grams:\n-0.01\tsaw The car\n\n\\end\\\n";

fn built() -> Vec<u8> {
    built_with("")
}

fn built_with(arpa: &str) -> Vec<u8> {
    let mut builder = Builder::new();
    builder.words(LIST).expect("a list");
    builder.text(TEXT);
    if !arpa.is_empty() {
        builder.arpa(arpa).expect("a model in the ARPA format");
    }
    builder.build().expect("a model")
}

/// Returns the log-probability of the last of some words; an empty word is the start of a sentence.
fn last(model: &Model, words: &[&str]) -> f32 {
    let mut row = ademan_text::model::bigrams::NO_ROW;
    let mut last = f32::NAN;
    for word in words {
        if word.is_empty() {
            row = model.row(ademan_text::model::lexicon::ROOT);
            continue;
        }
        let found = model.find(word).expect("a word");
        last = model.bigrams.after(row, found.node, found.log_probability);
        row = model.next_row(row, found.node);
    }
    last
}

#[test]
fn another_model_has_its_share_after_the_words_that_it_knows() {
    let [plain, mixed] = [built(), built_with(ARPA)];
    let [plain, mixed] = [&plain, &mixed].map(|bytes| Model::from_bytes(bytes).expect("a model"));
    // After `the`: a half of 0.79 and a half of what the sentences say, which is 0.1 to 0.15.
    let counted = last(&plain, &["the", "car"]).exp();
    let expected = 0.5 * counted + 0.5 * 10_f32.powf(-0.1);
    let found = last(&mixed, &["the", "car"]).exp();
    assert!((found / expected - 1.0).abs() < 0.1, "{found} {expected}");
    // After `saw the`, which the sentences have once with `car`.
    assert!(last(&mixed, &["saw", "the", "car"]) > last(&mixed, &["the", "car"]) + 0.1);
    assert!(last(&mixed, &["", "car"]) > last(&plain, &["", "car"]));
    // It adds no words, and does not change what follows words that it lacks.
    assert_eq!(mixed.find("truck"), None);
    assert_eq!(
        last(&mixed, &["anna", "cat"]),
        mixed.find("cat").expect("a word").log_probability
    );
    // Without text, what it says counts for nearly all.
    let mut builder = Builder::new();
    builder.words("the\ncar\ncat").expect("a list");
    builder.arpa(ARPA).expect("a model in the ARPA format");
    let bytes = builder.build().expect("a model");
    let alone = Model::from_bytes(&bytes).expect("a model");
    assert!(last(&alone, &["the", "car"]).exp() > 0.6);
    assert!(last(&alone, &["the"]) > last(&alone, &["cat"]) + 0.5);
}

#[test]
fn lines_that_are_not_in_the_arpa_format_are_named() {
    let refused = |from: &str, to: &str| {
        let text = ARPA.replacen(from, to, 1);
        assert_ne!(text, ARPA, "{from}");
        Builder::new().arpa(&text).expect_err("a damaged model")
    };
    let number = "it does not start with a logarithm of at most 0";
    let unknown = "it has a word that is not among the 1-grams";
    let weight = "the weight at its end is not a number, or it has too many words";
    let cases = [
        (refused("-1.0\tcat", "x\tcat"), 7, number),
        (refused("-1.0\tcat", "0.3\tcat"), 7, number),
        (refused("-1.0\tcat", "nan\tcat"), 7, number),
        (refused("The car\t-0.2", "The bus\t-0.2"), 15, unknown),
        (refused("The car\t-0.2", "The car\tmuch"), 15, weight),
        (refused("saw The -0.1", "saw"), 16, "it has too few words"),
        (refused("\\1-grams:", "\\0-grams:"), 15, unknown),
    ];
    for (error, line, fault) in cases {
        assert_eq!(error, LineError { line, fault });
    }
    for text in ["", "the quick fox\n", "Trie Language Model"] {
        let error = Builder::new().arpa(text).expect_err("a foreign text");
        assert!(
            error
                .fault
                .contains("not a language model in the ARPA format"),
            "{error}"
        );
    }
}

#[test]
fn damaged_models_in_the_arpa_format_do_no_harm() {
    let mut random = fastrand::Rng::with_seed(5);
    let (mut refused, mut accepted) = (0, 0);
    for _ in 0..500 {
        let mut bytes = ARPA.as_bytes().to_vec();
        for _ in 0..random.usize(1..6) {
            let index = random.usize(..bytes.len());
            bytes[index] = b" \t\n\\-0189.etharw"[random.usize(..16)];
        }
        let text = String::from_utf8(bytes).expect("ASCII");
        let mut builder = Builder::new();
        builder.words(LIST).expect("a list");
        if builder.arpa(&text).is_ok() {
            accepted += 1;
            let model = builder.build().expect("a model");
            assert!(Model::from_bytes(&model).is_ok(), "{text}");
        } else {
            refused += 1;
        }
    }
    assert!(refused > 50 && accepted > 50, "{refused} {accepted}");
}

#[test]
fn weights_that_are_no_numbers_are_refused_with_their_line() {
    for weight in ["abc", "1,000", "nan", "inf", "-50"] {
        let mut builder = Builder::new();
        let list = format!("fix 2\nfox {weight}\n");
        let error = builder.words(&list).expect_err("a wrong weight");
        assert_eq!(error.line, 2, "{weight}: {error}");
        assert_eq!(builder.build(), Err(BuildError::Empty), "{weight}");
    }
}

#[test]
fn words_of_no_weight_are_equally_likely() {
    let mut builder = Builder::new();
    builder.words("cat 0\nqed 0\n").expect("a list");
    let bytes = builder.build().expect("a model");
    let model = Model::from_bytes(&bytes).expect("a model");
    for word in ["cat", "qed"] {
        let found = model.find(word).expect("a word");
        assert!(
            (found.log_probability - 0.5_f32.ln()).abs() < 0.06,
            "{word}"
        );
    }
    // Beside others they are words all the same, and their letters no certain ones.
    builder.words("cot 5\n").expect("a list");
    let mixed_bytes = builder.build().expect("a model");
    let mixed = Model::from_bytes(&mixed_bytes).expect("a model");
    assert!(mixed.find("qed").is_some());
    let symbol = |letter: char| mixed.alphabet.symbol(letter).expect("a letter");
    let start = ademan_text::model::spelling::START;
    let (_, second) = mixed.spelling.letter(start, symbol('q'));
    let (likely, _) = mixed.spelling.letter(second, symbol('e'));
    assert!(likely < -0.5, "{likely}");
}

#[test]
fn the_order_of_lines_does_not_matter() {
    let reversed = |text: &str| text.lines().rev().collect::<Vec<_>>().join("\n");
    let mut builder = Builder::new();
    builder.text(&reversed(TEXT));
    builder.words(&reversed(LIST)).expect("a list");
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
    // `the` was seen six times with what the sentences say, `cat` three times after it.
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
fn contradictions_after_a_right_checksum_do_no_harm() {
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
    builder.words("1\n2\n").expect("a list");
    assert_eq!(builder.build(), Err(BuildError::Empty));
    let letters: String = (0x4e00_u32..0x4e00 + 70)
        .filter_map(char::from_u32)
        .collect();
    let list: Vec<String> = letters.chars().map(String::from).collect();
    builder.words(&list.join("\n")).expect("a list");
    assert_eq!(builder.build(), Err(BuildError::Letters(70)));
}
