//! Phrases that the models were not built from, and texts of words that no lexicon has.

use ademan_text::Model;
use ademan_text::build::held_out;

use super::shared;

/// Returns sentences that were left out of the English model: the half on which costs were tuned, or the other, which is reported.
/// `None` without the sentences.
pub fn phrases(reported: bool) -> Option<Vec<String>> {
    let text =
        std::fs::read_to_string(shared("data/text/common_voice_en.txt")?).expect("sentences");
    let lines = text.lines().enumerate().filter(|&(line, _)| held_out(line));
    let half = lines.filter(|&(line, _)| (line / 20 % 2 == 1) == reported);
    let plain = |line: &String| {
        let typed = |letter: char| letter.is_ascii_lowercase() || " ',.?-".contains(letter);
        line.chars().all(typed) && (15..60).contains(&line.len())
    };
    Some(
        half.map(|(_, line)| line.to_lowercase())
            .filter(plain)
            .collect(),
    )
}

/// Returns the words of a text without punctuation.
pub fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|letter: char| !letter.is_alphanumeric() && letter != '\'')
        .map(|word| word.trim_matches('\''))
        .filter(|word| !word.is_empty())
}

/// Returns a name, an identifier or a password that the model lacks: syllables, letters, or letters with digits.
pub fn unknown(random: &mut fastrand::Rng, model: &Model) -> String {
    let pick = |generator: &mut fastrand::Rng, from: &str| {
        char::from(from.as_bytes()[generator.usize(..from.len())])
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

/// Returns phrases of three unknown words each.
pub fn unknown_phrases(model: &Model, count: usize, seed: u64) -> Vec<String> {
    let mut random = fastrand::Rng::with_seed(seed);
    let mut phrase = || -> Vec<String> { (0..3).map(|_| unknown(&mut random, model)).collect() };
    (0..count).map(|_| phrase().join(" ")).collect()
}

/// Returns abbreviations that the model lacks: the first letters of three or four words in a row of sentences.
pub fn abbreviations(model: &Model, sentences: &[String], count: usize) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for (index, sentence) in sentences.iter().enumerate() {
        let letters = words(sentence).filter_map(|word| word.chars().next());
        let word: String = letters.take(3 + index % 2).collect();
        let is_short = word.len() >= 3 && word.chars().all(char::is_alphabetic);
        if is_short && model.find(&word).is_none() && !found.contains(&word) {
            found.push(word);
        }
    }
    found.truncate(count);
    found
}
