//! The engine: the methods that the daemon calls, and the signals that put text into the focused field.
//!
//! Text and keys reach a program in different ways. Their order is kept:
//!
//! - Text before a key: the daemon shows the engine each key before the program gets it, and the engine has emitted all earlier text by
//!   then.
//! - A key before text: the text waits until the daemon has shown the engine the key and has its answer, at most [`KEY_TIMEOUT`].

use std::collections::VecDeque;
use std::num::NonZeroU32;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, after, never, select_biased};
use zbus::Message;
use zbus::message::Type;
use zbus::zvariant::{DynamicDeserialize, OwnedValue, Value};

use super::bus::{Bus, ENGINE_PATH};
use super::serial;
use crate::output::FieldKind;
use crate::output::ime::client::{Action, Request, Shared};

/// Longest time that text waits for a key, which a window manager may have taken.
const KEY_TIMEOUT: Duration = Duration::from_millis(100);

/// `IBUS_KEY_BackSpace`.
const BACKSPACE: u32 = 0xff08;

/// Longest time from a Backspace to the `Reset` of a field that executes it.
const RESET_TIME: Duration = Duration::from_millis(100);

/// `IBUS_RELEASE_MASK`.
const RELEASE: u32 = 1 << 30;

/// `IBUS_ENGINE_PREEDIT_COMMIT`: a field that loses the focus keeps the word that it shows.
const KEEP_WORD: u32 = 1;

/// Purposes of fields that take no text from an input method (`GtkInputPurpose`, from 1): digits, a number, a telephone number, an
/// address of the web or of mail, a password, a number that is secret, a terminal.
const LITERAL_PURPOSES: [u32; 8] = [2, 3, 4, 5, 6, 8, 9, 10];

/// `GTK_INPUT_HINT_PRIVATE`.
const HINT_PRIVATE: u32 = 1 << 11;

/// The client of the context that the daemon itself focuses while no text field has the focus.
const OWN_CLIENT: &str = "fake";

/// The end of the path of that context, which is the first one.
const OWN_CONTEXT: &str = "/InputContext_1";

/// The reason why an engine has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    /// The loop has dropped its requests.
    Session,
    /// The daemon has ended.
    Daemon,
}

/// The keys of the output of keys that the daemon has shown.
#[derive(Default)]
struct KeysOfOutput {
    /// The number of presses.
    seen: u32,
    /// The code of the last key, until its release: the receiver repeats this key.
    held: Option<u32>,
    /// The time of the last Backspace.
    backspace_at: Option<Instant>,
}

impl KeysOfOutput {
    /// Records a key event, given by its symbol, its code and the modifiers. Returns `true` if it comes from another keyboard. `sent` is
    /// the number of presses that the output has sent so far.
    fn is_of_other_keyboard(&mut self, (symbol, code, state): (u32, u32, u32), sent: u32) -> bool {
        let is_last = self.held == Some(code);
        if state & RELEASE != 0 {
            self.held = self.held.filter(|_| !is_last);
            return false;
        }
        if self.seen == sent {
            return !is_last;
        }
        self.seen = self.seen.wrapping_add(1);
        self.held = Some(code);
        if symbol == BACKSPACE {
            self.backspace_at = Some(Instant::now());
        }
        false
    }
}

pub(super) struct Engine<'a> {
    bus: Bus,
    shared: &'a Shared,
    /// `true` if a field of a program has the focus.
    is_focused: bool,
    is_enabled: bool,
    /// The serial number of the call that asks for the context that has the focus.
    asked_context: Option<NonZeroU32>,
    /// The serial number of a call whose reply follows what the daemon reports of a new field.
    asked_field: Option<NonZeroU32>,
    /// The kind of text that the field takes, as the field reports it.
    kind: FieldKind,
    /// The word that the field shows.
    shown: String,
    keys: KeysOfOutput,
    /// Requests that wait for keys, and since when.
    waiting: VecDeque<Request>,
    waiting_since: Instant,
}

impl<'a> Engine<'a> {
    pub(super) fn new(bus: Bus, shared: &'a Shared) -> Self {
        Self {
            bus,
            shared,
            is_focused: false,
            is_enabled: false,
            asked_context: None,
            asked_field: None,
            kind: FieldKind::Text,
            shown: String::new(),
            keys: KeysOfOutput {
                seen: shared.presses(),
                ..KeysOfOutput::default()
            },
            waiting: VecDeque::new(),
            waiting_since: Instant::now(),
        }
    }

    /// Serves the daemon and the loop until one of them ends.
    pub(super) fn run(mut self, requests: &Receiver<Request>) -> End {
        let messages = self.bus.messages.clone();
        loop {
            let timeout = if self.waiting.is_empty() {
                never()
            } else {
                after((self.waiting_since + KEY_TIMEOUT).saturating_duration_since(Instant::now()))
            };
            // A key of the daemon never overtakes text that was requested before it, even if this thread comes late.
            let done = select_biased! {
                recv(requests) -> request => match request {
                    Ok(request) => self.take(request),
                    Err(_) => {
                        self.finish();
                        return End::Session;
                    }
                },
                recv(messages) -> message => match message {
                    Ok(message) => self.answer(&message),
                    Err(_) => return self.lose_daemon(),
                },
                recv(timeout) -> _ => {
                    self.keys.seen = self.shared.presses();
                    self.execute_waiting()
                }
            };
            if done.is_err() {
                return self.lose_daemon();
            }
        }
    }

    /// Counts the text that waits as dropped: no field takes it.
    fn lose_daemon(&self) -> End {
        for request in &self.waiting {
            self.shared.drop_text(&request.action);
        }
        End::Daemon
    }

    /// Executes the requests that wait, and restores the previous engine of the desktop.
    fn finish(mut self) {
        self.keys.seen = self.shared.presses();
        let _ = self.execute_waiting();
        self.bus.close();
    }

    fn take(&mut self, request: Request) -> zbus::Result<()> {
        if self.waiting.is_empty() {
            self.waiting_since = Instant::now();
        }
        self.waiting.push_back(request);
        self.execute_waiting()
    }

    /// Executes the requests whose keys the daemon has shown.
    fn execute_waiting(&mut self) -> zbus::Result<()> {
        while let Some(request) = self.waiting.pop_front() {
            // Counters wrap.
            if (request.after_presses.wrapping_sub(self.keys.seen) as i32) > 0 {
                self.waiting.push_front(request);
                return Ok(());
            }
            self.waiting_since = Instant::now();
            self.execute(&request)?;
        }
        Ok(())
    }

    fn execute(&mut self, request: &Request) -> zbus::Result<()> {
        if !self.shared.accepts(request) {
            return Ok(());
        }
        let executed = match &request.action {
            Action::Show(word) => self.show(word),
            Action::Commit(text) => self.commit(text),
            Action::List(candidates) => {
                let table = Value::from(serial::lookup_table(candidates));
                let is_visible = !candidates.is_empty();
                self.bus.emit("UpdateLookupTable", &(table, is_visible))
            }
        };
        executed.inspect_err(|_| self.shared.drop_text(&request.action))
    }

    fn show(&mut self, word: &str) -> zbus::Result<()> {
        word.clone_into(&mut self.shown);
        let cursor = word.chars().count() as u32;
        let text = Value::from(serial::text(word, true));
        let is_visible = !word.is_empty();
        self.bus
            .emit("UpdatePreeditText", &(text, cursor, is_visible, KEEP_WORD))
    }

    fn commit(&mut self, text: &str) -> zbus::Result<()> {
        if !self.shown.is_empty() {
            self.show("")?;
        }
        self.bus
            .emit("CommitText", &(Value::from(serial::text(text, false)),))
    }

    /// Answers a call of the daemon. Fails only if the daemon cannot be reached.
    fn answer(&mut self, message: &Message) -> zbus::Result<()> {
        let header = message.header();
        match message.message_type() {
            Type::MethodCall => {}
            Type::MethodReturn if header.reply_serial() == self.asked_context => {
                self.asked_context = None;
                let context: Option<OwnedValue> = arguments(message);
                self.set_focus(context.is_some_and(|context| !is_own_context(&context)));
                return Ok(());
            }
            Type::MethodReturn | Type::Error if header.reply_serial() == self.asked_field => {
                self.asked_field = None;
                self.enter_field();
                return Ok(());
            }
            _ => return Ok(()),
        }
        let member = header.member().map_or("", |member| member.as_str());
        match member {
            "CreateEngine" => {
                let path = zbus::zvariant::ObjectPath::from_static_str_unchecked(ENGINE_PATH);
                return self.bus.reply(message, &path);
            }
            "ProcessKeyEvent" => return self.process_key(message),
            "Get" => {
                let Some((_, name)) = arguments::<(String, String)>(message) else {
                    return self.bus.refuse_arguments(message);
                };
                // With this property, the daemon reports which program has the focus.
                let has_it = name == "FocusId";
                return self.bus.reply(message, &(Value::from(has_it),));
            }
            "GetAll" => {
                let all = std::collections::HashMap::from([("FocusId", Value::from(true))]);
                return self.bus.reply(message, &(all,));
            }
            "Set" => {
                let Some((_, name, value)) = arguments::<(String, String, OwnedValue)>(message)
                else {
                    return self.bus.refuse_arguments(message);
                };
                if name == "ContentType" {
                    self.set_purpose(value);
                }
            }
            "FocusInId" => {
                let Some((_, client)) = arguments::<(String, String)>(message) else {
                    return self.bus.refuse_arguments(message);
                };
                self.asked_context = None;
                self.ask_field()?;
                self.set_focus(client != OWN_CLIENT);
            }
            // Before the daemon knows that the engine wants to know who has the focus.
            "FocusIn" => {
                self.set_focus(false);
                self.asked_context = Some(self.bus.ask_context()?);
            }
            "FocusOut" | "FocusOutId" => self.set_focus(false),
            "Enable" => {
                self.ask_field()?;
                self.set_enabled(true);
            }
            "Disable" => self.set_enabled(false),
            // The program has moved its cursor, or emptied its field.
            "Reset" if !is_of_backspace(self.keys.backspace_at, &self.shown) => self.enter_field(),
            "CandidateClicked" => {
                let Some((index, ..)) = arguments::<(u32, u32, u32)>(message) else {
                    return self.bus.refuse_arguments(message);
                };
                self.shared.choose(candidate_number(index));
            }
            "Reset"
            | "SetCapabilities"
            | "SetCursorLocation"
            | "SetSurroundingText"
            | "PageUp"
            | "PageDown"
            | "CursorUp"
            | "CursorDown"
            | "PropertyActivate"
            | "PropertyShow"
            | "PropertyHide"
            | "PanelExtensionReceived"
            | "PanelExtensionRegisterKeys"
            | "Destroy" => {}
            _ => return self.bus.refuse_method(message),
        }
        self.bus.reply(message, &())
    }

    /// Passes every key to the program, after the text that precedes it.
    fn process_key(&mut self, message: &Message) -> zbus::Result<()> {
        let Some(key) = arguments::<(u32, u32, u32)>(message) else {
            return self.bus.refuse_arguments(message);
        };
        if self.keys.is_of_other_keyboard(key, self.shared.presses()) {
            // It may have moved the cursor: later corrections must not reach back to the text before it.
            let word = std::mem::take(&mut self.shown);
            if !word.is_empty() {
                self.commit(&word)?;
            }
            self.enter_field();
        }
        self.bus.reply(message, &false)?;
        self.execute_waiting()
    }

    /// Sends a call of which only the time of the reply matters: the daemon reports the purpose of a field after the field has
    /// the focus, and until then a field for a password looks like any other.
    fn ask_field(&mut self) -> zbus::Result<()> {
        self.asked_field = Some(self.bus.ask_context()?);
        Ok(())
    }

    fn set_purpose(&mut self, value: OwnedValue) {
        let Ok((purpose, hints)) = <(u32, u32)>::try_from(value) else {
            return;
        };
        let is_literal = LITERAL_PURPOSES.contains(&purpose) || hints & HINT_PRIVATE != 0;
        let kind = if is_literal {
            FieldKind::Literal
        } else {
            FieldKind::Text
        };
        if kind != self.kind {
            self.kind = kind;
            self.enter_field();
        }
    }

    fn set_focus(&mut self, is_focused: bool) {
        self.is_focused = is_focused;
        // A field without a purpose reports nothing.
        if !is_focused {
            self.kind = FieldKind::Text;
        }
        self.enter_field();
    }

    fn set_enabled(&mut self, is_enabled: bool) {
        self.is_enabled = is_enabled;
        self.enter_field();
    }

    /// Notifies the loop of another field or text. A word that is shown now belongs to the field.
    fn enter_field(&mut self) {
        self.shown.clear();
        let is_known = self.is_focused && self.is_enabled && self.asked_field.is_none();
        self.shared.field.enter(if is_known {
            self.kind
        } else {
            // A field for a password may hide from the daemon.
            FieldKind::Literal
        });
    }
}

/// Returns the arguments of a call or a reply; `None` if they have other types.
fn arguments<T: for<'a> DynamicDeserialize<'a>>(message: &Message) -> Option<T> {
    let body = message.body();
    body.deserialize().ok()
}

/// Returns `true` if a `Reset` belongs to a Backspace of this program: fields of GTK send one when they execute it. The text that waits
/// for the Backspaces of a correction is for the same field. A field that shows a word takes it with a `Reset`.
fn is_of_backspace(backspace_at: Option<Instant>, shown: &str) -> bool {
    shown.is_empty() && backspace_at.is_some_and(|at| at.elapsed() < RESET_TIME)
}

/// Returns the number of a candidate, counted from 1, or 0 if no list is that long.
fn candidate_number(index: u32) -> u8 {
    let number = index.checked_add(1);
    number
        .and_then(|number| u8::try_from(number).ok())
        .unwrap_or(0)
}

/// Returns `true` if this is the path of the context of the daemon itself.
fn is_own_context(path: &Value) -> bool {
    match path {
        Value::Value(inner) => is_own_context(inner),
        Value::ObjectPath(path) => path.ends_with(OWN_CONTEXT),
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_call_with_arguments_of_other_types_has_no_arguments() {
        let call = Message::method_call(ENGINE_PATH, "CandidateClicked").unwrap();
        let message = call.build(&("text", 1_u32)).unwrap();
        assert_eq!(arguments::<(u32, u32, u32)>(&message), None);
        let right = arguments::<(String, u32)>(&message);
        assert_eq!(right, Some(("text".to_owned(), 1)));
    }

    #[test]
    fn keys_that_the_output_has_not_pressed_are_of_another_keyboard() {
        const A: (u32, u32, u32) = (0x61, 30, 0);
        const B: (u32, u32, u32) = (0x62, 48, 0);
        let release = |(symbol, code, _)| (symbol, code, RELEASE);
        let mut keys = KeysOfOutput::default();
        assert!(!keys.is_of_other_keyboard(A, 1));
        assert!(keys.is_of_other_keyboard(B, 1));
        assert!(!keys.is_of_other_keyboard(release(B), 1));
        assert!(!keys.is_of_other_keyboard(A, 1), "it is repeated");
        assert!(!keys.is_of_other_keyboard(release(A), 1));
        assert!(keys.is_of_other_keyboard(A, 1));
        assert!(keys.backspace_at.is_none());
        assert!(!keys.is_of_other_keyboard((BACKSPACE, 14, 0), 2));
        assert!(keys.backspace_at.is_some());
    }

    #[test]
    fn a_reset_soon_after_a_backspace_keeps_the_field_unless_it_shows_a_word() {
        let now = Instant::now();
        // In the future, so that the test may come late.
        let soon = now.checked_add(Duration::from_secs(600));
        let late = now.checked_sub(2 * RESET_TIME);
        assert!(is_of_backspace(soon, ""));
        assert!(!is_of_backspace(soon, "th"));
        assert!(!is_of_backspace(late, ""));
        assert!(!is_of_backspace(None, ""));
    }

    #[test]
    fn an_index_beyond_every_list_chooses_no_candidate() {
        let numbers = [0, 254, 255, u32::MAX].map(candidate_number);
        assert_eq!(numbers, [1, 255, 0, 0]);
    }
}
