//! The sink of the output `ime`.

use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Duration;

use crossbeam_channel::{Receiver, Sender, bounded};

use super::client::{Action, Candidates, QUEUE, Request, Shared};
use super::composition::{Composition, Part, Way};
use super::{BACKEND, ibus, key_output};
use crate::output::{
    FieldKind, LogFailureReceiver, OpenRequest, OutputError, Sink, TextField, check,
};
use ademan_core::command::TextMode;
use ademan_core::contact::TargetNames;
use ademan_core::device::signals::Signals;
use ademan_core::device::{Capabilities, EventKind, Events, KeyKind, OutputEvent};
use ademan_core::pipeline::TextState;

/// Longest time that [`Ime::close`](Sink::close) waits for the input method.
const CLOSE_TIMEOUT: Duration = Duration::from_millis(500);

/// Opens the output.
pub fn open(request: &OpenRequest) -> Result<Box<dyn Sink>, OutputError> {
    let to_error = |reason: String| OutputError::open(request.name, reason);
    let backend = key_output(request.argument).map_err(to_error)?;
    let mut required = request.required.clone();
    // Text needs no output of keys.
    required.text &= (backend.capabilities)().text;
    check(backend.name, &required)?;
    let (requests, queue) = bounded(QUEUE);
    let (end, ended) = bounded(0);
    let shared = Arc::new(Shared::default());
    let thread = ibus::start(queue, Arc::clone(&shared), end).map_err(to_error)?;
    let keys = (backend.open)(&OpenRequest {
        name: backend.name,
        argument: None,
        required: &required,
        watchdog: request.watchdog,
    })?;
    Ok(Box::new(Ime {
        keys,
        composition: Composition::default(),
        outlet: Outlet {
            requests: Some(requests),
            shared,
            events: Events::new(),
            field: 0,
            presses: 0,
            is_idle: true,
            dropped_presses: 0,
        },
        composes_words: false,
        listed: Candidates::new(),
        thread: Some(thread),
        ended,
    }))
}

/// A sink that sends text to the input method of the desktop, and everything else to another sink.
///
/// It never blocks. Text that the input method has not taken at a stop is void, and [counted](Sink::dropped_presses).
struct Ime {
    keys: Box<dyn Sink>,
    composition: Composition,
    outlet: Outlet,
    composes_words: bool,
    /// The candidates that the desktop lists.
    listed: Candidates,
    thread: Option<JoinHandle<()>>,
    ended: Receiver<()>,
}

/// The ways out of a step.
struct Outlet {
    requests: Option<Sender<Request>>,
    shared: Arc<Shared>,
    /// The events for the output of keys.
    events: Events,
    /// The generation of the field.
    field: u32,
    /// The key presses for the output of keys so far.
    presses: u32,
    /// Nothing was requested since the last stop.
    is_idle: bool,
    dropped_presses: u64,
}

impl Outlet {
    fn emit(&mut self, part: Part) {
        match part {
            Part::Show(word) => self.request(Action::Show(word)),
            Part::Commit(text) => self.request(Action::Commit(text)),
            Part::Key(event) => {
                if is_key_press(event.kind) {
                    self.presses = self.shared.count_press();
                }
                let _ = self.events.try_push(event);
            }
        }
    }

    fn request(&mut self, action: Action) {
        let is_text = matches!(action, Action::Commit(_));
        let request = Request {
            action,
            field: self.field,
            after_presses: self.presses,
            stops: self.shared.stops(),
        };
        self.is_idle = false;
        let is_sent = match &self.requests {
            Some(requests) => requests.try_send(request).is_ok(),
            None => false,
        };
        self.dropped_presses += u64::from(is_text && !is_sent);
    }
}

impl Ime {
    /// Forgets the word if its field is left.
    fn follow_field(&mut self) -> Way {
        let field = self.outlet.shared.field();
        if field.generation != self.outlet.field {
            self.outlet.field = field.generation;
            self.composition.forget_word();
        }
        match field.kind {
            FieldKind::Unknown | FieldKind::Literal => Way::Keys,
            FieldKind::Text if self.composes_words => Way::Words,
            FieldKind::Text => Way::Text,
        }
    }
}

impl Sink for Ime {
    fn send(&mut self, events: &[OutputEvent]) -> Result<(), OutputError> {
        let way = self.follow_field();
        self.outlet.events.clear();
        let mut emit = |part| self.outlet.emit(part);
        for event in events {
            self.composition.handle(*event, way, &mut emit);
        }
        self.composition.show(&mut emit);
        self.keys.send(&self.outlet.events)
    }

    fn capabilities(&self) -> Capabilities {
        (BACKEND.capabilities)()
    }

    fn on_log_failure(&mut self, receiver: LogFailureReceiver) {
        self.keys.on_log_failure(receiver);
    }

    fn set_target_names(&mut self, names: &TargetNames) {
        self.keys.set_target_names(names);
    }

    fn set_signals(&mut self, signals: &Signals) {
        self.keys.set_signals(signals);
    }

    fn void_presses(&mut self) {
        self.keys.void_presses();
        if self.outlet.is_idle {
            return;
        }
        self.outlet.shared.stop();
        self.follow_field();
        // The person sees the word; without an input method its letters would be there, too.
        self.composition.commit(&mut |part| self.outlet.emit(part));
        self.outlet.is_idle = true;
    }

    fn has_stalled(&self) -> bool {
        self.keys.has_stalled()
    }

    fn close(&mut self) -> Result<(), OutputError> {
        let closed = self.keys.close();
        self.follow_field();
        self.composition.commit(&mut |part| self.outlet.emit(part));
        drop(self.outlet.requests.take());
        // A daemon that hangs keeps its thread.
        if self
            .ended
            .recv_timeout(CLOSE_TIMEOUT)
            .is_err_and(|error| error.is_disconnected())
            && let Some(thread) = self.thread.take()
        {
            let _ = thread.join();
        }
        closed
    }

    fn dropped_presses(&self) -> u64 {
        self.outlet.dropped_presses + self.keys.dropped_presses()
    }

    fn coalesced_motions(&self) -> u64 {
        self.keys.coalesced_motions()
    }

    fn text_field(&self) -> TextField {
        self.outlet.shared.field()
    }

    fn show_text(&mut self, state: Option<&TextState>) {
        self.composes_words = state.is_some_and(|state| state.mode != TextMode::Literal);
        let none = Candidates::new();
        let has_word = !self.composition.word().is_empty();
        let candidates = state
            .filter(|_| has_word)
            .map_or(&none, |state| &state.candidates);
        if *candidates != self.listed {
            self.listed.clone_from(candidates);
            self.outlet.request(Action::List(candidates.clone()));
        }
    }

    fn take_choice(&mut self) -> Option<u8> {
        self.outlet.shared.take_choice()
    }
}

impl Drop for Ime {
    fn drop(&mut self) {
        if self.thread.is_some() {
            let _ = self.close();
        }
    }
}

/// Returns whether an input method sees this event.
fn is_key_press(event: EventKind) -> bool {
    match event {
        EventKind::KeyDown(key) => key.kind() == KeyKind::Keyboard,
        EventKind::Character(_) => true,
        _ => false,
    }
}
