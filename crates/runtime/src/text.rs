//! The text decoder of a setup.

use serde::{Deserialize, Serialize};

use ademan_core::command::TextMode;
use ademan_core::document::schema;
use ademan_core::names::UnknownName;

pub use ademan_core::layout::TextModeSchema;
pub use ademan_text::filter::{
    Language, Learned, capabilities, finds_letters, learned, learned_field_tables, learned_summary,
    shows_other_keymap,
};

schema! {
    /// The text decoder of a setup.
    #[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename = "Text", default, deny_unknown_fields)]
    pub struct TextSetup {
        /// The mode at the start. Default: the mode of the layout, or `Literal`.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub mode: Option<TextModeSchema>,
        /// The language: `en` or `es`, or the path of a model that ends in `.adm`.
        pub language: String,
        /// Types letters that no key types, such as `ó`, if the output can write text.
        pub accents: bool,
        /// The file of what the decoder has learned about the person: read at the start, written by `ademan ctl save-learned`.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub learned: Option<String>,
    }
}

impl Default for TextSetup {
    /// English, in the modes of the layouts.
    fn default() -> Self {
        Self {
            mode: None,
            language: "en".to_owned(),
            accents: true,
            learned: None,
        }
    }
}

/// A mode of the text decoder in an argument, with the language if it names one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextChoice {
    mode: TextModeSchema,
    language: Option<String>,
}

impl TextChoice {
    /// Returns a setup with this mode, and with this language if the argument names one. The rest is as in `before`.
    pub fn applied_to(&self, before: Option<TextSetup>) -> TextSetup {
        let before = before.unwrap_or_default();
        TextSetup {
            mode: Some(self.mode),
            language: self.language.clone().unwrap_or(before.language),
            ..before
        }
    }
}

impl std::str::FromStr for TextChoice {
    type Err = String;

    /// Parses `MODE` or `MODE:LANGUAGE`.
    fn from_str(text: &str) -> Result<Self, String> {
        let (mode, language) = match text.split_once(':') {
            Some((mode, language)) => (mode, Some(language)),
            None => (text, None),
        };
        let mode: TextMode = mode.parse().map_err(|_: UnknownName| {
            // The remedy lists the modes.
            let error = UnknownName::new("text mode", mode, TextMode::NAMES.iter().copied());
            format!("{error}; write `literal`, `suggest` or `auto`, and `:es` for another language")
        })?;
        language.map_or(Ok(()), Language::check_name)?;
        Ok(Self {
            mode: mode.into(),
            language: language.map(str::to_owned),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mode_without_a_language_keeps_the_language_and_the_rest_of_a_setup() {
        let before = TextSetup {
            language: "es".into(),
            accents: false,
            learned: Some("me.ron".into()),
            ..TextSetup::default()
        };
        let applied = |argument: &str| {
            let choice: TextChoice = argument.parse().unwrap();
            choice.applied_to(Some(before.clone()))
        };
        let expected = TextSetup {
            mode: Some(TextModeSchema::Auto),
            ..before.clone()
        };
        assert_eq!(applied("auto"), expected);
        assert_eq!(applied("suggest:en").language, "en");
        let alone: TextChoice = "auto".parse().unwrap();
        assert_eq!(alone.applied_to(None).language, "en");
    }

    #[test]
    fn an_unknown_mode_is_refused_with_the_modes_once() {
        let error = "never".parse::<TextChoice>().unwrap_err();
        let expected = "unknown text mode `never`; write `literal`, `suggest` or `auto`, and `:es` for another language";
        assert_eq!(error, expected);
    }
}
