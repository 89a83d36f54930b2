//! The text decoder in a run: language models by name, and the filter of presses of a layout.

mod burst;
mod filter;
mod keys;

use std::path::Path;

use ademan_text::correction::Restored;
use ademan_text::{Corrector, Decoder, Model, Options, Prior, TouchModel, languages};
use serde::{Deserialize, Serialize};

use self::filter::TextFilter;
use self::keys::TextKeys;
use crate::command::TextMode;
use crate::device::Capabilities;
use crate::layout::Layout;
use crate::message::escape;
use crate::names::UnknownName;
use crate::pipeline::PressFilter;

pub use self::keys::has_text_commands;

/// The languages that come with the program.
static LANGUAGES: [(&str, &[u8]); 2] = [("en", languages::ENGLISH), ("es", languages::SPANISH)];

/// How the name of the file of a language model ends.
const FILE_ENDING: &str = ".adm";

/// The text decoder of a setup.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename = "Text", default, deny_unknown_fields)]
pub struct TextSetup {
    /// What it changes at the start.
    pub mode: TextModeSetup,
    /// The language: `en` or `es`, or the path of a model that ends in `.adm`.
    pub language: String,
}

/// What the text decoder changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename = "TextMode")]
pub enum TextModeSetup {
    /// Nothing; the mode can be changed while the session runs.
    Literal,
    /// The candidate that is chosen, nothing else.
    Suggest,
    /// The candidate that is chosen, and words at their end.
    Auto,
}

impl From<TextModeSetup> for TextMode {
    fn from(mode: TextModeSetup) -> Self {
        match mode {
            TextModeSetup::Literal => Self::Literal,
            TextModeSetup::Suggest => Self::Suggest,
            TextModeSetup::Auto => Self::Auto,
        }
    }
}

impl From<TextMode> for TextModeSetup {
    fn from(mode: TextMode) -> Self {
        match mode {
            TextMode::Literal => Self::Literal,
            TextMode::Suggest => Self::Suggest,
            TextMode::Auto => Self::Auto,
        }
    }
}

impl Default for TextSetup {
    /// English, nothing changed.
    fn default() -> Self {
        Self {
            mode: TextModeSetup::Literal,
            language: LANGUAGES[0].0.to_owned(),
        }
    }
}

impl std::str::FromStr for TextSetup {
    type Err = String;

    /// Parses `MODE` or `MODE:LANGUAGE`.
    fn from_str(text: &str) -> Result<Self, String> {
        let (mode, language) = match text.split_once(':') {
            Some((mode, language)) => (mode, Some(language)),
            None => (text, None),
        };
        let mode: TextMode = mode.parse().map_err(|error: UnknownName| {
            format!("{error}; write `literal`, `suggest` or `auto`, and `:es` for another language")
        })?;
        let default = Self::default();
        Ok(Self {
            mode: mode.into(),
            language: language.map_or(default.language, str::to_owned),
        })
    }
}

/// A language model that decoders of any thread use.
#[derive(Clone)]
pub struct Language(Model<'static>);

impl std::fmt::Debug for Language {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Language")
    }
}

impl Language {
    /// Finds a model that comes with the program, or reads the file of one with `read`. The message of an error says what to do.
    pub fn load(
        name: &str,
        read: impl FnOnce(&Path) -> Result<Vec<u8>, String>,
    ) -> Result<Self, String> {
        let shipped = LANGUAGES.iter().find(|(known, _)| *known == name);
        let bytes = match shipped {
            Some((_, bytes)) => *bytes,
            None if name.ends_with(FILE_ENDING) => {
                let bytes = read(Path::new(name))?;
                // It is checked before it is kept.
                check(name, &bytes)?;
                // Decoders borrow it in every thread, until the program ends: there is one for each file of a setup.
                let kept: &'static [u8] = Box::leak(bytes.into_boxed_slice());
                kept
            }
            None => {
                let names = LANGUAGES.iter().map(|(name, _)| *name);
                let error = UnknownName::new("language", name, names);
                return Err(format!(
                    "{error}; the languages are `en` and `es`, and the path of a model ends in `{FILE_ENDING}`"
                ));
            }
        };
        Ok(Self(check(name, bytes)?))
    }

    /// Returns the text decoder for a layout; `None` if it has too few letters. `has_two_hands` type on it.
    pub fn filter(
        &self,
        layout: &Layout,
        mode: TextMode,
        has_two_hands: bool,
    ) -> Option<Box<dyn PressFilter>> {
        let keys = TextKeys::new(layout, has_two_hands)?;
        let touch = TouchModel::new(Prior::default());
        let decoder = Decoder::new(
            self.0.clone(),
            keys.keyboard().clone(),
            touch,
            Options::default(),
        );
        let corrector = Corrector::new(decoder, mode_of_decoder(mode), Restored::default());
        Some(Box::new(TextFilter::new(corrector, keys, mode)))
    }
}

/// Returns what the text decoder of a layout may emit beside the events of the layout; nothing without one.
pub fn capabilities(layout: &Layout) -> Capabilities {
    let keys = TextKeys::new(layout, false);
    keys.map(|keys| keys.capabilities()).unwrap_or_default()
}

fn check<'m>(name: &str, bytes: &'m [u8]) -> Result<Model<'m>, String> {
    Model::from_bytes(bytes)
        .map_err(|error| format!("cannot use the language model {}: {error}", escape(name)))
}

/// Returns the mode of a corrector.
fn mode_of_decoder(mode: TextMode) -> ademan_text::Mode {
    match mode {
        TextMode::Literal => ademan_text::Mode::Literal,
        TextMode::Suggest => ademan_text::Mode::Suggest,
        TextMode::Auto => ademan_text::Mode::Auto,
    }
}
