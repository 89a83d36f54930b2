//! Reads noisy typing on keyboards in space.
//!
//! Data flows in one direction:
//!
//! ```text
//!  lists, text ──▶ Builder ──bytes──▶ Model ─┐
//!                  build               model │
//!  Tap ────────────────────────────────────▶ Decoder ──Candidate──▶ Corrector ──Edit──▶ text field
//!  keyboard           TouchModel ──────────▶ decoder               correction
//!  SwipePath           touch                   ▲
//!  swipe ──────────────────────────────────────┘
//! ```
//!
//! - [`logarithm`] stores a probability in a byte, with the same result on every machine.
//! - [`model`] is the language: letters, words, pairs of words and spelling in one block of bytes.
//! - [`build`] creates its bytes.
//! - [`keyboard`] holds keys and taps, in millimetres.
//! - [`touch`] models where the taps for each key land, and learns this for a person.
//! - [`decoder`] finds the text that taps most probably mean.
//! - [`swipe`] holds paths of fingers over letters, and finds the words that explain them.
//! - [`correction`] turns the text into edits of a text field.
//! - [`languages`] are the models that come with the crate.
//! - [`filter`] puts all of it between the devices of a layout and the output of a pipeline of `ademan_core`.
//!
//! # Model
//!
//! The decoder looks for the text that maximizes
//!
//! ```text
//! Σ ln p(tap | key) + λ Σ ln P(word | two words before) + Σ ln P(error)
//! ```
//!
//! - A tap of key k is normal: `N(center + offset of the person + offset of k + drift of the hand + ρ · scatter of the last tap,
//!   (1 − ρ²) Σₖ + drift variance)`, or, with e^-9, anywhere on the keyboard (Goodman et al. 2002; Bi and Zhai 2013 for the dual normal distribution that makes touches
//!   scatter around an offset).
//! - Offsets and covariances have a normal-inverse-Wishart prior and forget exponentially; the drift of a hand is a random walk, tracked by
//!   a Kalman filter with each hypothesis. ρ, one correlation for two taps of one hand and one for taps of different hands, starts from
//!   real taps and is learned. The scale of the prior's covariance shrinks with the distances of the last taps from the
//!   likeliest keys, before anything is committed.
//! - `P(word | two words before)` interpolates threes, pairs and words with absolute discounting (Ney, Essen and Kneser 1994); the
//!   probability of a word alone comes half from its count, half from the number of words before it (Kneser and Ney 1995). A
//!   second model can be mixed into all of them, as in English.
//! - A word that the lexicon lacks costs e^-6.5 and its letters, each by up to four letters before it, interpolated after Witten and Bell
//!   (1991). So an unknown word stays as it was typed unless a known one is much likelier.
//! - Errors are omitted, added and exchanged letters and spaces, each with a cost of its own: [`Options`]. How often this person misses a
//!   tap, exchanges two or makes one that means nothing is learned from committed text, as is how many of the last words were unknown.
//!   A tap that means nothing lands near the previous tap (80 %, normal, 0.9 keys), or anywhere.
//! - A mark after a word has a probability that depends on the length of the sentence before it.
//!
//! The search is Viterbi's over the trie of words with a beam, as in VelociTap (Vertanen et al. 2015). Inside a word, a hypothesis
//! is judged by the likeliest word that it can become.
//!
//! # Time and memory
//!
//! A tap takes 12 µs (median) at 3 mm of scatter and 84 µs at 10 mm with missed and spurious taps; with candidates, that is 0.06
//! to 0.35 of a search for the nearest word of the same length in the flat list, in the same run (`benches/taps.rs`). A model is
//! checked and prepared in 6 to 9 ms, and takes 2.6 MB (English) beside its bytes, once for all its copies. A tap allocates nothing. A
//! decoder has about 3 MB for hypotheses and their characters.

pub mod logarithm;
pub mod model;
pub mod build;
pub mod keyboard;
pub mod touch;
pub mod swipe;
pub mod decoder;
pub mod correction;
pub mod languages;
pub mod filter;

pub use correction::{Corrector, Edit, Mode};
pub use decoder::{Candidate, Decoder, Options};
pub use keyboard::{Key, Keyboard, Tap};
pub use model::{Model, ModelError};
pub use swipe::SwipePath;
pub use touch::{Prior, TouchModel};
