//! The models that come with this crate. `languages/README.md` states their sources and how to build them.
//!
//! Taps on a keyboard with keys of 19 mm, the fifth of them on the wrong key:
//!
//! ```
//! use ademan_text::{Decoder, Key, Keyboard, Model, Options, Prior, Tap, TouchModel, languages};
//!
//! let rows = [("qwertyuiop", 0.0), ("asdfghjkl", 4.75), ("zxcvbnm", 14.25)];
//! let mut keys = Vec::new();
//! for ((letters, start), row) in rows.into_iter().zip(0_u8..) {
//!     for (character, column) in letters.chars().zip(0_u8..) {
//!         // Millimetres, to the right and towards the wearer.
//!         let center = [start + f32::from(column) * 19.0, f32::from(row) * 19.0];
//!         keys.push(Key { character, center, size: [19.0; 2], hand: 0 });
//!     }
//! }
//! keys.push(Key { character: ' ', center: [85.0, 57.0], size: [112.0, 19.0], hand: 0 });
//! let keyboard = Keyboard::new(keys);
//!
//! let model = Model::from_bytes(languages::ENGLISH)?;
//! let touch = TouchModel::new(Prior::default());
//! let mut decoder = Decoder::new(model, keyboard.clone(), touch, Options::default());
//! for character in "keybpard".chars() {
//!     let index = keyboard.index(character).expect("a key of the keyboard");
//!     let [x, y] = keyboard.keys()[index].center;
//!     decoder.tap(Tap::at(x + 2.0, y - 1.0));
//! }
//! assert_eq!(decoder.typed(), "keybpard");
//! // A sentence starts with a capital.
//! assert_eq!(decoder.best(), "Keyboard");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

/// English: 130 000 words.
pub const ENGLISH: &[u8] = include_bytes!("../languages/en.adm");

/// Spanish: 204 000 words, from little text.
pub const SPANISH: &[u8] = include_bytes!("../languages/es.adm");
