//! Texts, and how far they are from what was meant.

use ademan_text::correction::Restored;
use ademan_text::{
    Corrector, Decoder, Edit, Keyboard, Mode, Model, Options, Prior, Tap, TouchModel,
};

/// A phrase and its taps.
#[derive(Clone)]
pub struct Phrase {
    pub meant: String,
    pub taps: Vec<Tap>,
    /// The space after it.
    pub space: Option<Tap>,
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
pub fn normal(text: &str) -> String {
    let words: Vec<&str> = text.split(' ').filter(|word| !word.is_empty()).collect();
    let joined = words.join(" ").to_lowercase();
    joined.trim_end_matches(['.', '!', '?']).to_owned()
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

/// The reading of a phrase by a decoder.
pub struct Read {
    /// The text that is shown: the most probable one if it is likelier by the margin.
    pub shown: String,
    /// The most probable text.
    pub best: String,
}

/// Returns what a decoder reads from the phrases of one person, who is learned from phrase to phrase, or not at all.
pub fn read(
    model: &Model,
    keyboard: &Keyboard,
    prior: Prior,
    phrases: &[Phrase],
    learns: bool,
) -> Vec<Read> {
    let fresh = || {
        Decoder::new(
            model.clone(),
            keyboard.clone(),
            TouchModel::new(tried(prior)),
            options(),
        )
    };
    let mut decoder = fresh();
    let mut texts = Vec::new();
    for phrase in phrases {
        for &tap in &phrase.taps {
            decoder.tap(tap);
        }
        texts.push(Read {
            shown: decoder.reading().to_owned(),
            best: decoder.best().to_owned(),
        });
        if learns {
            decoder.commit();
            decoder.start_sentence();
        } else {
            decoder = fresh();
        }
    }
    texts
}

/// Returns the texts that a decoder shows for the phrases of one person, who is learned from phrase to phrase.
pub fn decode(model: &Model, keyboard: &Keyboard, prior: Prior, phrases: &[Phrase]) -> Vec<String> {
    let read = read(model, keyboard, prior, phrases, true);
    read.into_iter().map(|read| read.shown).collect()
}

/// Returns the texts that stay in a text field after a corrector, when the phrases are typed one after another, each followed by a
/// space that is hit.
pub fn correct(
    model: &Model,
    keyboard: &Keyboard,
    prior: Prior,
    phrases: &[Phrase],
) -> Vec<String> {
    type_into(&mut corrector(model, keyboard, prior), phrases)
}

/// Creates a corrector in the mode `auto`, of a person who is not known.
pub fn corrector<'m>(model: &Model<'m>, keyboard: &Keyboard, prior: Prior) -> Corrector<'m> {
    let touch = TouchModel::new(tried(prior));
    let decoder = Decoder::new(model.clone(), keyboard.clone(), touch, options());
    Corrector::new(decoder, Mode::Auto, Restored::default())
}

/// Types phrases one after another, and returns the texts that stay in the text field, as [`correct`] does.
pub fn type_into(corrector: &mut Corrector, phrases: &[Phrase]) -> Vec<String> {
    let keyboard = corrector.decoder().keyboard();
    let space = keyboard
        .index(' ')
        .map(|space| keyboard.keys()[space].center);
    let mut field: Vec<char> = Vec::new();
    let mut texts = Vec::new();
    for phrase in phrases {
        let mut start = field.len();
        let [x, y] = space.expect("a space bar");
        for tap in phrase.taps.iter().chain(&[Tap {
            typed: Some(' '),
            ..phrase.space.unwrap_or(Tap::at(x, y))
        }]) {
            for edit in corrector.press(*tap) {
                match edit {
                    Edit::Backspace => assert!(field.pop().is_some(), "a Backspace at the start"),
                    Edit::Type(character) => field.push(*character),
                }
            }
            // A correction that reaches into the phrase before leaves it about as long.
            start = start.min(field.len());
        }
        texts.push(field[start..].iter().collect());
    }
    texts
}
