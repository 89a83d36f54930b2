//! The text decoder of a run.

use std::path::Path;
use std::sync::Arc;

use ademan::command::TextMode;
use ademan::layout::Layout;
use ademan::pipeline::PressFilter;
use ademan::readings::{Decoding, Lexicon};
use ademan::text::{Language, TextChoice, TextSetup};

use super::outputs;
use crate::failure::Failure;

/// The word for no decoder.
const OFF: &str = "off";

/// A decoder, or none, as it is written in arguments and results.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DecoderArg(Option<(String, TextSetup)>);

impl std::str::FromStr for DecoderArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == OFF {
            return Ok(Self(None));
        }
        let choice: TextChoice = text
            .parse()
            .map_err(|error| format!("{error}, or `{OFF}` for no decoder"))?;
        Ok(Self(Some((text.to_owned(), choice.applied_to(None)))))
    }
}

/// A decoder with its language.
#[derive(Clone)]
pub struct Decoder {
    /// The decoder as it was written.
    pub name: String,
    language: Language,
    mode: TextMode,
    lexicon: Arc<Lexicon>,
}

impl Decoder {
    /// Loads the language of a decoder; `None` for none.
    pub fn load(arg: &DecoderArg) -> Result<Option<Self>, Failure> {
        let Some((name, setup)) = &arg.0 else {
            return Ok(None);
        };
        let read = |path: &Path| outputs::read_bytes(path);
        let language = Language::load(&setup.language, read).map_err(Failure::wrong_use)?;
        let lexicon = Lexicon::new(language.words());
        Ok(Some(Self {
            name: name.clone(),
            language,
            mode: setup.mode.map_or(TextMode::Literal, TextMode::from),
            lexicon: Arc::new(lexicon),
        }))
    }

    /// Calls a function with what the lab needs of the decoder.
    pub fn with<T>(&self, call: impl FnOnce(&Decoding) -> T) -> T {
        let make = |layout: &Layout, has_two_hands: bool| -> Option<Box<dyn PressFilter>> {
            // Scores count the characters of keys.
            self.language
                .filter(layout, self.mode, has_two_hands, false)
        };
        call(&Decoding {
            decoder: &make,
            lexicon: &self.lexicon,
        })
    }
}
