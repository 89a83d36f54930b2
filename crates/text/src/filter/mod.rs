//! The text decoder as a filter of the presses on a layout, with a language by its name.

mod burst;
mod candidates;
mod keys;
mod learned;
mod literal;
mod step;
mod stroke;
mod text_filter;

use std::path::Path;
use std::sync::Arc;

use ademan_core::command::TextMode;
use ademan_core::device::Capabilities;
use ademan_core::layout::Layout;
use ademan_core::message::escape;
use ademan_core::names::UnknownName;
use ademan_core::pipeline::PressFilter;

use self::keys::TextKeys;
use self::text_filter::TextFilter;
use crate::correction::Restored;
use crate::{Corrector, Decoder, Mode, Model, Options, languages};

pub use self::keys::shows_other_keymap;
pub use self::learned::{
    Learned, LearnedErrors, LearnedKey, LearnedPairs, LearnedSummary, LearnedTaps, learned,
    learned_field_tables, learned_summary,
};

/// The languages that come with the crate.
static LANGUAGES: [(&str, &[u8]); 2] = [("en", languages::ENGLISH), ("es", languages::SPANISH)];

/// The end of the name of the file of a language model.
const FILE_ENDING: &str = ".adm";

/// A language model that decoders of any thread use, and what is known of a person.
#[derive(Clone)]
pub struct Language {
    model: Model<'static>,
    learned: Arc<Learned>,
}

impl std::fmt::Debug for Language {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Language")
    }
}

/// Returns the error for a name that stands for no language.
fn unknown(name: &str) -> String {
    let names = LANGUAGES.iter().map(|(language, _)| *language);
    let error = UnknownName::new("language", name, names);
    format!(
        "{error}; the languages are `en` and `es`, and the path of a model ends in `{FILE_ENDING}`"
    )
}

impl Language {
    /// Finds a model that comes with the crate, or reads the file of one with `read`. The message of an error says what to do.
    pub fn load(
        name: &str,
        read: impl FnOnce(&Path) -> Result<Vec<u8>, String>,
    ) -> Result<Self, String> {
        let shipped = LANGUAGES.iter().find(|(known, _)| *known == name);
        match shipped {
            Some((_, bytes)) => Ok(Self::new(check(name, bytes)?)),
            None if Self::is_file(name) => Self::from_bytes(name, read(Path::new(name))?),
            None => Err(unknown(name)),
        }
    }

    /// Returns `true` if a name is the path of the file of a model.
    pub fn is_file(name: &str) -> bool {
        name.ends_with(FILE_ENDING)
    }

    /// Checks that a name stands for a model that comes with the crate or for a file, which may be absent.
    pub fn check_name(name: &str) -> Result<(), String> {
        let is_shipped = LANGUAGES.iter().any(|(known, _)| *known == name);
        if is_shipped || Self::is_file(name) {
            Ok(())
        } else {
            Err(unknown(name))
        }
    }

    /// Uses the bytes of a model, which are kept until the program ends: decoders of every thread borrow them. `name` is for the error.
    pub fn from_bytes(name: &str, bytes: Vec<u8>) -> Result<Self, String> {
        // It is checked before it is kept.
        check(name, &bytes)?;
        let kept: &'static [u8] = Box::leak(bytes.into_boxed_slice());
        Ok(Self::new(check(name, kept)?))
    }

    fn new(model: Model<'static>) -> Self {
        Self {
            model,
            learned: Arc::default(),
        }
    }

    /// Starts decoders with what was learned of a person.
    #[must_use]
    pub fn with_learned(self, learned: Learned) -> Self {
        Self {
            learned: Arc::new(learned),
            ..self
        }
    }

    /// Returns the words in lower case with the natural logarithms of their probabilities.
    pub fn words(&self) -> Vec<(String, f32)> {
        self.model.word_list()
    }

    /// Returns the text decoder for a layout; `None` if it has too few letters, or [shows another keymap](shows_other_keymap) than
    /// the US one. `has_two_hands` type on it. With `accents` it types
    /// characters that no key types.
    pub fn filter(
        &self,
        layout: &Layout,
        mode: TextMode,
        has_two_hands: bool,
        accents: bool,
    ) -> Option<Box<dyn PressFilter>> {
        let keys = TextKeys::new(layout, has_two_hands)?.with_text(accents);
        let decoder = Decoder::new(
            self.model.clone(),
            keys.keyboard().clone(),
            self.learned.touch(),
            Options::default(),
        );
        let decoder = if layout.boards.iter().any(|board| board.swipe) {
            decoder.with_swipes()
        } else {
            decoder
        };
        let words = Restored::from(self.learned.words.clone());
        let corrector = Corrector::new(decoder, decoder_mode(mode), words);
        Some(Box::new(TextFilter::new(corrector, keys, mode)))
    }
}

/// Returns what the text decoder of a layout may emit beside the events of the layout; nothing without one. `accents` as in
/// [`Language::filter`].
pub fn capabilities(layout: &Layout, accents: bool) -> Capabilities {
    let keys = TextKeys::new(layout, false);
    keys.map(|keys| keys.with_text(accents).capabilities())
        .unwrap_or_default()
}

/// Returns `true` if the text decoder of a layout finds the letters of its multitap keys from one tap each: it has no other keys with
/// letters.
pub fn finds_letters(layout: &Layout) -> bool {
    TextKeys::new(layout, false).is_some_and(|keys| keys.keyboard().has_shared_keys())
}

fn check<'m>(name: &str, bytes: &'m [u8]) -> Result<Model<'m>, String> {
    Model::from_bytes(bytes)
        .map_err(|error| format!("cannot use the language model {}: {error}", escape(name)))
}

/// Returns the mode of a corrector.
fn decoder_mode(mode: TextMode) -> Mode {
    match mode {
        TextMode::Literal => Mode::Literal,
        TextMode::Suggest => Mode::Suggest,
        TextMode::Auto => Mode::Auto,
    }
}
