//! Small models and keyboards for tests.

use super::Decoder;
use crate::build::Builder;
use crate::keyboard::{Key, Keyboard, Millimetres, Tap};
use crate::touch::Hands;
use crate::{Model, Options, Prior, TouchModel};

/// Builds a model of words, one on each line.
pub fn model(words: &str) -> Model<'static> {
    let mut builder = Builder::new();
    builder.words(words).expect("a list");
    let bytes = builder.build().expect("a model");
    Model::from_bytes(bytes.leak()).expect("a model")
}

/// Creates a decoder for words, one on each line.
pub fn decoder(words: &str, keys: &[Key], touch: TouchModel) -> Decoder<'static> {
    let keyboard = Keyboard::new(keys.iter().copied());
    Decoder::new(model(words), keyboard, touch, Options::default())
}

/// Returns a square key of the left hand, 17 mm wide.
pub fn key(character: char, center: Millimetres) -> Key {
    Key {
        character,
        center,
        size: [17.0; 2],
        hand: 0,
    }
}

/// Returns keys in a row, 19 mm apart.
pub fn row(characters: &str) -> Vec<Key> {
    let keys = characters.chars().zip(0_u8..);
    keys.map(|(character, index)| key(character, [f32::from(index) * 19.0, 0.0]))
        .collect()
}

/// Returns the touch model of a person whose hands have drifted to the right.
pub fn drifted(drift: f32) -> TouchModel {
    TouchModel {
        hands: Hands {
            drift: [[drift, 0.0]; 2],
            ..Hands::default()
        },
        ..TouchModel::new(Prior::default())
    }
}

/// Types a character with a tap to the right of the center of its key.
pub fn tap(decoder: &mut Decoder, character: char, right: f32) {
    let keyboard = decoder.keyboard();
    let index = keyboard.index(character).expect("a key");
    let [x, y] = keyboard.keys()[index].center;
    decoder.tap(Tap {
        position: [x + right, y],
        typed: Some(character),
    });
}
