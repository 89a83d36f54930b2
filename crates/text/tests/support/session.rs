//! Texts, and how far they are from what was meant.

use ademan_text::{Decoder, Keyboard, Model, Options, Prior, Tap, TouchModel};

/// A phrase and its taps.
#[derive(Clone)]
pub struct Phrase {
    pub meant: String,
    pub taps: Vec<Tap>,
}

/// Errors of characters and words.
#[derive(Clone, Copy, Default, Debug)]
pub struct Errors {
    pub characters: usize,
    pub wrong_characters: usize,
    pub words: usize,
    pub wrong_words: usize,
}

impl Errors {
    pub fn add(&mut self, meant: &str, read: &str) {
        let (meant, read) = (normal(meant), normal(read));
        self.characters += meant.chars().count();
        self.wrong_characters += distance(
            &meant.chars().collect::<Vec<_>>(),
            &read.chars().collect::<Vec<_>>(),
        );
        let words = |text: &str| text.split(' ').map(str::to_owned).collect::<Vec<_>>();
        self.words += words(&meant).len();
        self.wrong_words += distance(&words(&meant), &words(&read));
    }

    pub fn merge(&mut self, other: &Self) {
        self.characters += other.characters;
        self.wrong_characters += other.wrong_characters;
        self.words += other.words;
        self.wrong_words += other.wrong_words;
    }

    /// Returns the wrong characters in percent.
    pub fn cer(&self) -> f64 {
        100.0 * self.wrong_characters as f64 / self.characters.max(1) as f64
    }

    /// Returns the wrong words in percent.
    pub fn wer(&self) -> f64 {
        100.0 * self.wrong_words as f64 / self.words.max(1) as f64
    }
}

/// Returns the text without capitals, double spaces and punctuation at its end.
fn normal(text: &str) -> String {
    let words: Vec<&str> = text.split(' ').filter(|word| !word.is_empty()).collect();
    let text = words.join(" ").to_lowercase();
    text.trim_end_matches(['.', '!', '?']).to_owned()
}

/// Returns the edit distance.
pub fn distance<T: PartialEq>(a: &[T], b: &[T]) -> usize {
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, left) in a.iter().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, right) in b.iter().enumerate() {
            let change = diagonal + usize::from(left != right);
            diagonal = row[j + 1];
            row[j + 1] = change.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

/// Returns the text of the nearest keys.
pub fn nearest(keyboard: &Keyboard, taps: &[Tap]) -> String {
    let key = |tap: &Tap| keyboard.nearest(tap.position).expect("a keyboard has keys");
    taps.iter()
        .map(|tap| keyboard.keys()[key(tap)].character)
        .collect()
}

/// Options for trials, as JSON in the variable `ADEMAN_TEXT_OPTIONS`.
pub fn options() -> Options {
    let text = std::env::var("ADEMAN_TEXT_OPTIONS");
    text.map_or_else(
        |_| Options::default(),
        |text| serde_json::from_str(&text).expect("options"),
    )
}

/// Returns a prior with the values of the variable `ADEMAN_TEXT_PRIOR`, JSON for trials, in place of its own.
fn tried(prior: Prior) -> Prior {
    let Ok(text) = std::env::var("ADEMAN_TEXT_PRIOR") else {
        return prior;
    };
    let mut values = serde_json::to_value(prior).expect("values");
    let tried: serde_json::Value = serde_json::from_str(&text).expect("values");
    for (name, value) in tried.as_object().expect("values") {
        values[name] = value.clone();
    }
    serde_json::from_value(values).expect("a prior")
}

/// Returns the texts that a decoder reads from the phrases of one person, who is learned from phrase to phrase.
pub fn decode(model: &Model, keyboard: &Keyboard, prior: Prior, phrases: &[Phrase]) -> Vec<String> {
    let mut decoder = Decoder::new(
        model.clone(),
        keyboard.clone(),
        TouchModel::new(tried(prior)),
        options(),
    );
    let mut texts = Vec::new();
    for phrase in phrases {
        for &tap in &phrase.taps {
            decoder.tap(tap);
        }
        texts.push(decoder.reading().to_owned());
        decoder.commit();
        decoder.start_sentence();
    }
    texts
}
