//! The text decoder of a setup.

use std::path::Path;

use super::LoadedSetup;
use crate::output;
use crate::text::{self, Language, TextSetup};
use ademan_core::command::TextMode;
use ademan_core::device::{Capabilities, Capability};
use ademan_core::layout::Layout;
use ademan_core::message::{escape, escape_path};
use ademan_core::pipeline::LayoutInstance;

impl LoadedSetup {
    /// Adds a text decoder that changes nothing if the setup has none and a layout has keys for it.
    pub(super) fn add_text_setup(&mut self) {
        if self.setup.text.is_none() && self.layouts().any(text::has_text_commands) {
            self.setup.text = Some(TextSetup::default());
        }
    }

    /// Loads the language of the text decoder with `read`. If that fails, there is no text decoder, and
    /// [`text_error`](Self::text_error) is the reason.
    pub(super) fn load_language(&mut self, read: impl FnOnce(&Path) -> Result<Vec<u8>, String>) {
        let mut corrections = Capabilities::from_iter([Capability::Text]);
        for layout in self.layouts() {
            corrections.extend(text::capabilities(layout, true).iter());
        }
        // Characters between keys arrive in order only where one output takes both.
        let writes_text = output::keeps_order(&self.setup.output, &corrections);
        let Some(setup) = &mut self.setup.text else {
            return;
        };
        // A recording says what the output of its session could do: a replay writes to another one.
        setup.accents &= writes_text;
        match Language::load(&setup.language, read) {
            Ok(language) => self.language = Some(language.with_learned(self.learned.clone())),
            Err(error) => self.text_error = Some(error),
        }
        let asks = setup.mode != TextSetup::default().mode;
        let has_letters = |layout: &Layout| !text::capabilities(layout, false).keys.is_empty();
        if asks && self.language.is_some() && !self.layouts().any(has_letters) {
            let other = self
                .layouts()
                .find(|layout| text::shows_other_keymap(layout));
            self.text_error = Some(other.map_or_else(
                || "no layout has letters".to_owned(),
                |layout| {
                    format!(
                        "`{}` is for a receiver with another keymap than US, as its labels show, and the decoder types for that one \
                         only; use a layout such as `qwerty-words`: the decoder writes the accents",
                        escape(&layout.name)
                    )
                },
            ));
        }
        if let Some(note) = self.text_note() {
            tracing::warn!("{note}");
        }
    }

    /// Returns the message about a text decoder that is missing, if the setup asks for one.
    pub fn text_note(&self) -> Option<String> {
        let error = self.text_error.as_ref()?;
        Some(format!("words are not corrected: {error}"))
    }

    /// Returns `true` if a text decoder finds the letters of multitap keys of the layout from the words.
    pub(super) fn finds_letters(&self) -> bool {
        let setup = self.setup.text.as_ref();
        let decodes = setup.is_some_and(|setup| TextMode::from(setup.mode) != TextMode::Literal);
        decodes && self.language.is_some() && text::finds_letters(&self.layout)
    }

    /// Returns the run-time instance of a layout, with a text decoder if the setup has one.
    pub(super) fn instance(&self, layout: &Layout, mode: Option<TextMode>) -> LayoutInstance {
        let setup = self.setup.text.as_ref().zip(self.language.as_ref());
        let filter = setup.and_then(|(setup, language)| {
            let mode = mode.unwrap_or(setup.mode.into());
            language.filter(layout, mode, self.other_hand.is_some(), setup.accents)
        });
        LayoutInstance::from_layout(layout).with_filter(filter)
    }
}

/// Reads the file of a language model.
pub(super) fn read_model(path: &Path) -> Result<Vec<u8>, String> {
    std::fs::read(path).map_err(|error| {
        format!(
            "cannot read the language model {}: {error}; `ademan text build` makes one",
            escape_path(path)
        )
    })
}

/// Refuses the file of a language model that a recording names.
pub(super) fn refuse_model(path: &Path) -> Result<Vec<u8>, String> {
    Err(format!(
        "the recording names the language model {}, and no file is opened because a recording names it",
        escape_path(path)
    ))
}
