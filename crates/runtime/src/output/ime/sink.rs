//! The sink of the output `ime`.

use std::sync::Arc;

use super::client::Candidates;
use super::composition::{Composition, Part, Way};
use super::key_output;
use super::outputs::Outputs;
use crate::output::sentence::Place;
use crate::output::text_field::{FocusedField, Text};
use crate::output::{
    FieldKind, LogFailureReceiver, OpenRequest, OutputError, Sink, TextField, check,
};
use ademan_core::command::TextMode;
use ademan_core::contact::TargetNames;
use ademan_core::device::signals::Signals;
use ademan_core::device::{Capabilities, EventKind, Events, OutputEvent};
use ademan_core::pipeline::TextState;

/// Opens the output.
pub fn open(request: &OpenRequest) -> Result<Box<dyn Sink>, OutputError> {
    let backend =
        key_output(request.argument).map_err(|reason| OutputError::open(request.name, reason))?;
    let mut required = request.required.clone();
    // Text needs no output of keys.
    required.text &= (backend.capabilities)().text;
    check(backend.name, &required)?;
    let field = Arc::new(FocusedField::default());
    let keys = OpenRequest {
        name: backend.name,
        argument: None,
        required: &required,
        watchdog: request.watchdog,
    };
    let outputs = Outputs::open(request.name, backend, &keys, &field)?;
    Ok(Box::new(Ime::new(outputs, field)))
}

/// A sink that sends text to the input method of the desktop, and everything else to another sink.
///
/// It never blocks. Text that the input method has not taken at a stop is void, and [counted](Sink::dropped_presses).
struct Ime {
    composition: Composition,
    outlet: Outlet,
    composes_words: bool,
    /// Words that start a sentence get a capital where fields ask for it.
    adds_capitals: bool,
    /// The candidates that the desktop lists.
    listed: Candidates,
    is_closed: bool,
}

impl Ime {
    fn new(outputs: Outputs, focused: Arc<FocusedField>) -> Self {
        Self {
            composition: Composition::default(),
            outlet: Outlet {
                outputs,
                focused,
                events: Events::new(),
                field: 0,
                is_idle: true,
                dropped_characters: 0,
                result: Ok(()),
            },
            composes_words: false,
            adds_capitals: false,
            listed: Candidates::new(),
            is_closed: false,
        }
    }
}

/// The ways out of a step.
struct Outlet {
    outputs: Outputs,
    /// The field that has the focus.
    focused: Arc<FocusedField>,
    /// The events for the output of keys.
    events: Events,
    /// The generation of the field.
    field: u32,
    /// `true` if nothing that a stop makes void was requested since the last stop.
    is_idle: bool,
    /// Number of characters of words that were lost with their field.
    dropped_characters: u64,
    /// The first error of this step.
    result: Result<(), OutputError>,
}

impl Outlet {
    fn emit(&mut self, part: Part) {
        match part {
            Part::Show(word) => self.write(word, false),
            Part::Commit(text) => self.write(text, true),
            Part::Key(event) => {
                self.is_idle &= !can_be_void(event.kind);
                self.outputs.count(event.kind);
                let _ = self.events.try_push(event);
            }
        }
    }

    fn write(&mut self, text: Text, is_committed: bool) {
        self.is_idle = false;
        let written = self
            .outputs
            .write(text, is_committed, self.field, &mut self.events);
        if self.result.is_ok() {
            self.result = written;
        }
    }

    /// Sends what remains of a step, and returns its result.
    fn finish(&mut self) -> Result<(), OutputError> {
        let sent = self.outputs.keys_mut().send(&self.events);
        self.events.clear();
        std::mem::replace(&mut self.result, Ok(())).and(sent)
    }
}

impl Ime {
    /// Forgets the word if its field is left.
    fn follow_field(&mut self) -> Way {
        let field = self.outlet.focused.get();
        if field.generation != self.outlet.field {
            self.outlet.field = field.generation;
            if self.outlet.outputs.loses_word() {
                let characters = self.composition.word().chars().count();
                self.outlet.dropped_characters += characters as u64;
            }
            self.composition.forget_word();
        }
        match field.kind {
            FieldKind::Unknown | FieldKind::Literal => Way::Keys,
            FieldKind::Text if self.composes_words => Way::Words,
            FieldKind::Text => Way::Text,
        }
    }

    /// Commits the word as it is.
    fn commit_word(&mut self) {
        self.follow_field();
        let outlet = &mut self.outlet;
        self.composition.commit(&mut |part| outlet.emit(part));
    }
}

impl Sink for Ime {
    fn send(&mut self, events: &[OutputEvent]) -> Result<(), OutputError> {
        let way = self.follow_field();
        self.composition.set_place(if self.adds_capitals {
            self.outlet.focused.place.get()
        } else {
            Place::Unknown
        });
        let mut emit = |part| self.outlet.emit(part);
        for event in events {
            self.composition.handle(*event, way, &mut emit);
        }
        self.composition.show(&mut emit);
        self.outlet.finish()
    }

    fn capabilities(&self) -> Capabilities {
        Capabilities {
            text: true,
            ..self.outlet.outputs.keys().capabilities()
        }
    }

    fn on_log_failure(&mut self, receiver: LogFailureReceiver) {
        self.outlet.outputs.keys_mut().on_log_failure(receiver);
    }

    fn set_target_names(&mut self, names: &TargetNames) {
        self.outlet.outputs.keys_mut().set_target_names(names);
    }

    fn set_signals(&mut self, signals: &Signals) {
        self.outlet.outputs.keys_mut().set_signals(signals);
    }

    fn void_presses(&mut self) {
        let has_requests = !std::mem::replace(&mut self.outlet.is_idle, true);
        self.outlet.outputs.void(has_requests);
        if has_requests {
            // The person sees the word; without an input method its letters would be there, too.
            self.commit_word();
            self.outlet.is_idle = true;
        }
    }

    fn has_stalled(&self) -> bool {
        self.outlet.outputs.keys().has_stalled()
    }

    fn close(&mut self) -> Result<(), OutputError> {
        self.is_closed = true;
        self.commit_word();
        let result = self.outlet.result.clone();
        self.outlet.outputs.close().and(result)
    }

    fn dropped_presses(&self) -> u64 {
        self.outlet.dropped_characters + self.outlet.outputs.dropped_presses()
    }

    fn coalesced_motions(&self) -> u64 {
        self.outlet.outputs.keys().coalesced_motions()
    }

    fn text_field(&self) -> TextField {
        self.outlet.focused.get()
    }

    fn show_text(&mut self, state: Option<&TextState>) {
        self.composes_words = state.is_some_and(|state| state.mode != TextMode::Literal);
        self.adds_capitals = state.is_some_and(|state| state.mode == TextMode::Auto);
        let none = Candidates::new();
        let has_word = !self.composition.word().is_empty();
        let candidates = state
            .filter(|_| has_word)
            .map_or(&none, |state| &state.candidates);
        if *candidates != self.listed {
            self.listed.clone_from(candidates);
            self.outlet.outputs.list(candidates, self.outlet.field);
        }
    }

    fn take_choice(&mut self) -> Option<u8> {
        self.outlet.outputs.take_choice()
    }
}

impl Drop for Ime {
    fn drop(&mut self) {
        if !self.is_closed {
            let _ = self.close();
        }
    }
}

/// Returns `true` if a stop makes an event void that the output of keys has not sent.
fn can_be_void(event: EventKind) -> bool {
    matches!(
        event,
        EventKind::KeyDown(_)
            | EventKind::Character(_)
            | EventKind::MoveBy(..)
            | EventKind::MoveTo(..)
            | EventKind::Scroll(..)
    )
}

#[cfg(test)]
mod tests {
    #[cfg(feature = "wayland")]
    mod compositor {
        use super::super::*;
        use crate::output::desktop::tests::TestDisplay;
        use crate::output::tests::{down, up};

        #[test]
        fn a_pause_commits_the_word_although_the_display_responds_several_turns_later() {
            let display = TestDisplay::default();
            let (desktop, gate) = display.open();
            let field = Arc::new(FocusedField::default());
            field.enter(FieldKind::Text);
            let mut ime = Ime::new(Outputs::Compositor(Box::new(desktop)), field);
            ime.composes_words = true;
            ime.send(&[down(1, "H"), up(1, "H"), down(2, "I")]).unwrap();
            // As in each turn of a loop that is paused.
            for _ in 0..3 {
                ime.void_presses();
                ime.send(&[]).unwrap();
                ime.show_text(None);
            }
            drop(gate);
            ime.close().unwrap();
            assert_eq!(display.lines(), ["commit hi"]);
            assert_eq!(ime.dropped_presses(), 0);
        }
    }
}
