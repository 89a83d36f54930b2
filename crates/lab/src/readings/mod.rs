//! Readings of the same taps: what a text decoder makes of them, and what simpler ways make of them in the same run.
//!
//! ```text
//!  fingertips ──▶ plane crossing            strokes ──▶ nearest key of what was meant
//!      └─ contact, devices ──▶ literal ──▶ spelling, flat lexicon
//!                                 └──────▶ decoder ──▶ output gate ──▶ text field
//! ```
//!
//! All texts are compared in lower case, without punctuation at their end and without double spaces, because a decoder adds capitals
//! and spaces of its own.

mod keyboard;
mod lexicon;
mod plane;
mod recorder;

use serde::{Deserialize, Serialize};

pub(crate) use self::keyboard::{KeyPlaces, Touch, nearest_target};
pub use self::lexicon::Lexicon;
pub(crate) use self::plane::PlaneCrossing;
pub(crate) use self::recorder::{Recorder, SharedRecorder};
use crate::layout::Layout;
use crate::pipeline::PressFilter;
use crate::sim::EditCounts;

/// Makes the decoder of a layout that one or two hands type on, as a filter of presses; `None` if the layout has too few letters.
pub type DecoderFactory<'a> = dyn Fn(&Layout, bool) -> Option<Box<dyn PressFilter>> + Sync + 'a;

/// A decoder, and the words of its language for the ways that it is compared with.
pub struct Decoding<'a> {
    /// Makes the decoder.
    pub decoder: &'a DecoderFactory<'a>,
    /// The words.
    pub lexicon: &'a Lexicon,
}

/// The errors of one way to read what a person tapped.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ReadingScore {
    /// The way.
    pub reader: String,
    /// Characters that were presented.
    pub characters: u64,
    /// Insertions, deletions and substitutions.
    pub errors: u64,
}

/// The ways to read taps, in the order of tables.
pub const READERS: [&str; 6] = [
    "plane crossing",
    "nearest key of the strokes",
    "literal",
    "spelling",
    "flat lexicon",
    "decoder",
];

/// The text of the strokes of a phrase, at each stage.
#[derive(Clone, Debug)]
pub(crate) struct PhraseTaps {
    /// The text that was to be typed.
    pub(crate) presented: String,
    /// The text that the plainest detector reads.
    pub(crate) plane: String,
    /// The text of the keys nearest to the strokes.
    pub(crate) nearest: String,
    /// The text that the devices type.
    pub(crate) literal: String,
    /// The taps that the devices type from.
    pub(crate) touches: Vec<Touch>,
    /// The scatter of the person, in millimetres.
    pub(crate) scatter: f32,
    /// The text that the decoder leaves in the text field.
    pub(crate) decoded: String,
}

/// Returns the errors of all readings of phrases; none without phrases.
pub(crate) fn scores(
    phrases: &[PhraseTaps],
    keys: &KeyPlaces,
    lexicon: &Lexicon,
) -> Vec<ReadingScore> {
    let mut scores = Vec::new();
    for phrase in phrases {
        let literal = phrase.literal.to_lowercase();
        add(
            &mut scores,
            &phrase.presented,
            &[
                &phrase.plane,
                &phrase.nearest,
                &phrase.literal,
                &lexicon.spelling(&literal),
                &lexicon.flat(keys, &phrase.touches, phrase.scatter),
                &phrase.decoded,
            ],
        );
    }
    scores
}

/// Adds the errors of the readings of a phrase, in the order of [`READERS`].
fn add(scores: &mut Vec<ReadingScore>, presented: &str, readings: &[&str; READERS.len()]) {
    if scores.is_empty() {
        scores.extend(READERS.map(|reader| ReadingScore {
            reader: reader.to_owned(),
            characters: 0,
            errors: 0,
        }));
    }
    let presented = plain(presented);
    for (score, text) in scores.iter_mut().zip(readings) {
        let edits = EditCounts::new(&presented, &plain(text));
        score.characters += presented.chars().count() as u64;
        score.errors += edits.errors() as u64;
    }
}

/// Returns a text in lower case, without double spaces and punctuation at its end.
pub(crate) fn plain(text: &str) -> String {
    let words: Vec<&str> = text.split_whitespace().collect();
    let joined = words.join(" ").to_lowercase();
    joined.trim_end_matches(['.', '!', '?']).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn capitals_double_spaces_and_a_full_stop_are_no_errors() {
        let mut scores = Vec::new();
        let readings = ["We  met.", "we met", "we mt", "", "We met ", "wee met"];
        add(&mut scores, "we met", &readings);
        let errors: Vec<u64> = scores.iter().map(|score| score.errors).collect();
        assert_eq!(errors, [0, 0, 1, 6, 0, 1]);
        assert!(scores.iter().all(|score| score.characters == 6));
    }
}
