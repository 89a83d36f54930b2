//! The text decoder of a page, which reads what is typed, and its candidates.

use std::sync::Arc;

use ademan_core::capture::Reading;
use ademan_core::command::{Command, CommandOrigin, TextMode};
use ademan_core::device::Events;
use ademan_core::layout::Layout;
use ademan_core::pipeline::{LayoutInstance, PressFilter, TextState};
use ademan_core::time::Timestamp;
use ademan_lab::sim::Tremor;
use serde::Serialize;

use crate::hand::{Hand, PERIOD};
use crate::session::PageSession;

/// Returns the text decoder for a layout in a mode; `None` if the layout has too few letters.
///
/// It is a function, so that a module without [`abi_words`](crate::abi_words) does not contain the decoder.
pub type DecoderOf = Box<dyn Fn(&Layout, TextMode) -> Option<Box<dyn PressFilter>>>;

/// The text decoder of a page.
#[derive(Default)]
pub(crate) struct Words {
    decoder: Option<DecoderOf>,
    mode: Option<TextMode>,
    /// The latest reading of hands that moved, if there is a decoder.
    latest: Option<Reading>,
    tremor: Tremor,
    /// The state that the page knows.
    told: Option<TextState>,
}

/// The news about the decoder for the page.
#[derive(Serialize)]
struct CandidateNews<'a> {
    /// `None` for a layout with too few letters.
    mode: Option<&'a str>,
    words: Vec<&'a str>,
}

impl Words {
    /// Returns a layout with its decoder, if there is one.
    pub(crate) fn instance(&self, layout: &Layout) -> LayoutInstance {
        let decoder = self.decoder.as_ref();
        let filter = decoder.and_then(|of| of(layout, self.mode.unwrap_or(TextMode::Literal)));
        LayoutInstance::from_layout(layout).with_filter(filter)
    }

    /// Remembers a reading.
    pub(crate) fn keep(&mut self, reading: &Reading) {
        if self.decoder.is_some() {
            self.latest = Some(reading.clone());
        }
    }
}

impl PageSession {
    /// Uses a text decoder, and releases everything. It changes nothing until a [mode](Self::set_text_mode) is set.
    pub fn use_decoder(&mut self, decoder: DecoderOf) {
        self.words.decoder = Some(decoder);
        self.adopt(Arc::clone(&self.layout));
    }

    /// Changes what the text decoder changes, also for layouts that follow.
    pub fn set_text_mode(&mut self, mode: TextMode) {
        self.words.mode = Some(mode);
        self.execute(Command::Text { mode });
    }

    /// Replaces the word that is being typed by a candidate, counted from 1.
    pub fn choose(&mut self, number: u8) {
        self.execute(Command::Candidate { number });
    }

    fn execute(&mut self, command: Command) {
        let mut events = Events::new();
        // Without a decoder there is nothing to do.
        let _ = self
            .pipeline
            .execute(&command, CommandOrigin::Client, &mut events);
        self.write_events(&events);
    }

    /// Returns the latest reading once more, at a time, while candidates wait below hands that rest: the decoder takes a candidate with
    /// a reading. Its positions tremble, as a hand whose positions are repeated exactly would be lost.
    pub(crate) fn held_reading(&mut self, time: Timestamp) -> Option<Reading> {
        let is_waiting = matches!(self.hand, Hand::Resting)
            && self
                .pipeline
                .text_state()
                .is_some_and(|state| !state.candidates.is_empty());
        let latest = self.words.latest.as_ref().filter(|_| is_waiting)?;
        let mut sample = latest.sample.clone();
        self.words.tremor.add_to(&mut sample, PERIOD.as_secs_f64());
        Some(Reading::new(time, latest.side, sample))
    }

    /// Appends the candidates, if they have changed.
    pub(crate) fn write_candidates(&mut self) {
        let state = self.pipeline.text_state();
        if self.words.decoder.is_none() || self.words.told.as_ref() == state {
            return;
        }
        self.words.told = state.cloned();
        let words = state.iter().flat_map(|state| &state.candidates);
        let news = CandidateNews {
            mode: state.map(|state| state.mode.name()),
            words: words.map(|word| word.as_str()).collect(),
        };
        self.lines.add("candidates", news);
    }
}
