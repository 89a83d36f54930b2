//! The conditions of a run.

use std::num::NonZeroUsize;
use std::thread;

use ademan_core::command::TextMode;
use ademan_core::layout::Layout;
use ademan_core::pipeline::PressFilter;
use ademan_lab::people::{Participant, People, Tier, population};
use ademan_lab::phrases::PhraseSet;
use ademan_lab::readings::{Decoding, Lexicon};
use ademan_lab::sim::fluent::SourceKind;
use ademan_runtime::text::{Language, TextModeSchema, TextSetup};

/// The text decoder of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LabDecoder {
    /// None: keys type what they say.
    #[default]
    Off,
    /// English words are corrected at their end.
    English,
    /// Spanish words are corrected at their end.
    Spanish,
}

impl LabDecoder {
    /// All, in the order of a list.
    pub const ALL: [Self; 3] = [Self::Off, Self::English, Self::Spanish];

    /// Returns the name in the arguments of `ademan lab`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Off => "off",
            Self::English => "auto",
            Self::Spanish => "auto:es",
        }
    }

    const fn language(self) -> Option<&'static str> {
        match self {
            Self::Off => None,
            Self::English => Some("en"),
            Self::Spanish => Some("es"),
        }
    }

    /// Returns the decoder as a setup has it.
    pub(super) fn setup(self) -> Option<TextSetup> {
        self.language().map(|language| TextSetup {
            mode: Some(TextModeSchema::Auto),
            language: language.to_owned(),
            // As in the score.
            accents: false,
            learned: None,
        })
    }

    /// Calls a function with what the lab needs of the decoder.
    pub(super) fn with<T>(self, call: impl FnOnce(Option<&Decoding>) -> T) -> Result<T, String> {
        let Some(name) = self.language() else {
            return Ok(call(None));
        };
        let language = Language::load(name, |_| Err("it is not a file".to_owned()))?;
        let lexicon = Lexicon::new(language.words());
        let make = |layout: &Layout, has_two_hands: bool| -> Option<Box<dyn PressFilter>> {
            language.filter(layout, TextMode::Auto, has_two_hands, false)
        };
        let decoding = Decoding {
            decoder: &make,
            lexicon: &lexicon,
        };
        Ok(call(Some(&decoding)))
    }
}

/// The people, the texts that they type, and the measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct LabSettings {
    /// Number of people of the general population, 1 to 1000.
    pub people: u32,
    /// Phrases of each person, 1 to 100.
    pub phrases: usize,
    /// The phrases.
    pub corpus: PhraseSet,
    /// The quality of touches; `None` for the errors of the people.
    pub tier: Option<Tier>,
    /// The sensor that measures the hands.
    pub source: SourceKind,
    /// The text decoder.
    pub decoder: LabDecoder,
    /// The seed of the people and their errors.
    pub seed: u64,
}

impl Default for LabSettings {
    /// Few enough for a result within seconds.
    fn default() -> Self {
        Self {
            people: 12,
            phrases: 5,
            corpus: PhraseSet::En,
            tier: None,
            source: SourceKind::Ideal,
            decoder: LabDecoder::Off,
            seed: 0,
        }
    }
}

impl LabSettings {
    /// Returns the people.
    pub(super) fn participants(&self) -> Vec<Participant> {
        population(&People::Drawn(self.people), self.tier, self.seed)
    }
}

/// Returns the number of threads of a run: one processor is left to the session and the window.
pub(super) fn jobs() -> NonZeroUsize {
    let processors = thread::available_parallelism().map_or(1, NonZeroUsize::get);
    NonZeroUsize::new(processors.saturating_sub(1)).unwrap_or(NonZeroUsize::MIN)
}
