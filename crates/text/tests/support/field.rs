//! A text field, and a small model for it.

use std::sync::LazyLock;

use ademan_text::build::Builder;
use ademan_text::correction::Restored;
use ademan_text::{
    Corrector, Decoder, Edit, Keyboard, Mode, Model, Options, Prior, SwipePath, Tap, TouchModel,
};

use super::simulated::{PITCH, keyboard};

/// A text field after a corrector.
pub struct Field<'m> {
    pub corrector: Corrector<'m>,
    pub keyboard: Keyboard,
    pub text: String,
    pub edits: usize,
}

impl Field<'static> {
    /// Makes a field of the small model.
    pub fn new(mode: Mode) -> Self {
        Self::with(mode, Restored::default(), Options::default())
    }

    /// Makes a field of the small model, with words of the person.
    pub fn with(mode: Mode, restored: Restored, options: Options) -> Self {
        Self::of(english(), mode, restored, options)
    }
}

impl<'m> Field<'m> {
    /// Makes a field of a model that is corrected without capitals.
    pub fn auto(bytes: &'m [u8]) -> Self {
        Self::of(bytes, Mode::Auto, Restored::default(), Options::default())
    }

    fn of(bytes: &'m [u8], mode: Mode, restored: Restored, options: Options) -> Self {
        let options = Options {
            capitals: false,
            ..options
        };
        let mut field = Self::on(bytes, keyboard(), options);
        let decoder = field.corrector.decoder().clone().with_swipes();
        field.corrector = Corrector::new(decoder, mode, restored);
        field
    }

    /// Makes a field that is corrected, on another keyboard.
    pub fn on(bytes: &'m [u8], keyboard: Keyboard, options: Options) -> Self {
        let model = Model::from_bytes(bytes).expect("a model");
        let touch = TouchModel::new(Prior::default());
        let decoder = Decoder::new(model, keyboard.clone(), touch, options);
        Self {
            corrector: Corrector::new(decoder, Mode::Auto, Restored::default()),
            keyboard,
            text: String::new(),
            edits: 0,
        }
    }

    pub fn apply(text: &mut String, edits: &[Edit]) -> usize {
        for edit in edits {
            match edit {
                Edit::Backspace => assert!(text.pop().is_some(), "a Backspace at the start"),
                Edit::Type(character) => text.push(*character),
            }
        }
        edits.len()
    }

    /// Returns the center of the key of a character, or a place beside the keyboard.
    pub fn center(&self, character: char) -> [f32; 2] {
        let lower = character.to_lowercase().next().expect("a letter");
        let key = self.keyboard.index(lower);
        key.map_or([20.0 * PITCH, 0.0], |key| self.keyboard.keys()[key].center)
    }

    /// Taps the centers of keys.
    pub fn types(&mut self, text: &str) {
        for character in text.chars() {
            let position = self.center(character);
            self.tap(position, character);
        }
    }

    pub fn tap(&mut self, position: [f32; 2], character: char) {
        let edits = self.corrector.press(Tap {
            position,
            typed: Some(character),
        });
        self.edits = Self::apply(&mut self.text, edits);
    }

    /// Taps the first letter of a word, and swipes along straight lines between all its letters.
    pub fn swipes(&mut self, word: &str) {
        let mut letters = word.chars();
        self.types(&letters.by_ref().take(1).collect::<String>());
        let mut path = SwipePath::default();
        let centers: Vec<[f32; 2]> = word.chars().map(|letter| self.center(letter)).collect();
        for pair in centers.windows(2) {
            for step in 0..=20 {
                let t = step as f32 / 20.0;
                let along = |axis: usize| pair[0][axis] + t * (pair[1][axis] - pair[0][axis]);
                path.push([along(0), along(1)]);
            }
        }
        let edits = self.corrector.swipe(path.points());
        self.edits = Self::apply(&mut self.text, edits);
    }

    pub fn backspace(&mut self) {
        self.edits = Self::apply(&mut self.text, self.corrector.backspace());
    }

    pub fn accept(&mut self, candidate: usize) {
        self.edits = Self::apply(&mut self.text, self.corrector.accept(candidate));
    }

    /// Returns the texts of the candidates.
    pub fn candidates(&mut self) -> Vec<String> {
        let candidates = self.corrector.candidates().iter();
        candidates.map(|candidate| candidate.text.clone()).collect()
    }
}

/// Returns the bytes of a small model of English.
pub fn english() -> &'static [u8] {
    static MODEL: LazyLock<Vec<u8>> = LazyLock::new(build_english);
    &MODEL
}

fn build_english() -> Vec<u8> {
    let mut builder = Builder::new();
    builder.words("the\t200\nof\t90\ncat\t20\nsat\t20\nwisdom\t5\ndon't\t20\nI\t50\nparis\t3\nParis\t3\nquick\t9\nhello\t10\nworld\t10").expect("a list");
    builder.text("the wisdom of the world\nthe wisdom of the world\nthe cat sat\nthe cat sat\nI don't\nI saw Paris");
    builder.build().expect("a model")
}
