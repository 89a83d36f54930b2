//! The text decoder of a setup.

use serde::{Deserialize, Serialize};

use ademan_core::command::TextMode;
use ademan_core::document::schema;
use ademan_core::names::UnknownName;

pub use ademan_text::filter::{
    Language, Learned, capabilities, finds_letters, has_text_commands, learned,
    learned_field_tables, learned_summary, shows_other_keymap,
};

schema! {
    /// The text decoder of a setup.
    #[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename = "Text", default, deny_unknown_fields)]
    pub struct TextSetup {
        /// The mode at the start.
        pub mode: TextModeSetup,
        /// The language: `en` or `es`, or the path of a model that ends in `.adm`.
        pub language: String,
        /// Types letters that no key types, such as `ó`, if the output can write text.
        pub accents: bool,
        /// The file of what the decoder has learned of the person: read at the start, written by `ademan ctl save-learned`.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub learned: Option<String>,
    }
}

schema! {
    /// The changes of the text decoder.
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
            language: "en".to_owned(),
            accents: true,
            learned: None,
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
        let language = language.map_or(default.language, str::to_owned);
        Language::check_name(&language)?;
        Ok(Self {
            mode: mode.into(),
            language,
            ..default
        })
    }
}
