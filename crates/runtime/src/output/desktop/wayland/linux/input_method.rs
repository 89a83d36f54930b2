//! The input method of a compositor: text and the word that is typed reach the focused field through `zwp_input_method_v2`.
//!
//! It has a connection of its own, which a thread reads, as fields come and go at any time. The thread of the output writes to it, between
//! the keys on the other connection. Keys and text keep their order: before each press and each text, that thread waits until the
//! compositor has answered on the connection of the keys, and a compositor reads its connections in the order in which data arrived.
//!
//! It does not grab the keyboard. Keys of other keyboards reach programs even if this program hangs.

use std::ffi::OsStr;
use std::net::Shutdown;
use std::os::unix::net::UnixStream;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, OnceLock};
use std::thread::{self, JoinHandle};

use wayland_client::globals::{GlobalListContents, registry_queue_init};
use wayland_client::protocol::wl_registry::{self, WlRegistry};
use wayland_client::protocol::wl_seat::WlSeat;
use wayland_client::{Connection, Dispatch, EventQueue, QueueHandle, delegate_noop};
use wayland_protocols_misc::zwp_input_method_v2::client::{
    zwp_input_method_manager_v2::ZwpInputMethodManagerV2,
    zwp_input_method_v2::{self, ZwpInputMethodV2},
};

use super::WaylandInjector;
use super::connection::{no_answer, socket};
use crate::advice;
use crate::output::FieldKind;
use crate::output::desktop::composing::{Composing, Refusal};
use crate::output::desktop::injector::Injector;
use crate::output::sentence::Place;
use crate::output::text_field::FocusedField;

/// Purposes of fields that take exactly what is typed (`zwp_text_input_v3.content_purpose`): digits, a number, a telephone number, an
/// address of the web or of mail, a password, a PIN, a date, a time, both, a terminal.
const LITERAL_PURPOSES: [u32; 11] = [2, 3, 4, 5, 6, 8, 9, 10, 11, 12, 13];

/// The hints `hidden_text` and `sensitive_data`.
const LITERAL_HINTS: u32 = 0x40 | 0x80;

/// The hint `auto_capitalization`.
const CAPITALS_HINT: u32 = 0x4;

/// A connection that is the input method of the seat.
pub struct InputMethod {
    connection: Connection,
    /// A duplicate, to end the thread.
    stream: UnixStream,
    method: ZwpInputMethodV2,
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

/// State that the thread writes and the output reads.
struct Shared {
    field: Arc<FocusedField>,
    /// The number of `done` events so far: the serial number of the next `commit`.
    done: AtomicU32,
}

/// Connects as [`connect`](super::connect) does, with an input method. A refusal is stored in `refusal`.
pub fn connect_composing(
    name: &OsStr,
    needs_pointer: bool,
    field: Arc<FocusedField>,
    refusal: &OnceLock<Refusal>,
) -> Result<Box<dyn Injector>, String> {
    let refuse = |reason: Refusal| {
        let _ = refusal.set(reason);
        "the compositor accepts no input method".to_owned()
    };
    let Some(method) = InputMethod::open(name, field)? else {
        return Err(refuse(Refusal::NotOffered));
    };
    let method = method.start()?.ok_or_else(|| refuse(Refusal::Taken))?;
    let mut injector = WaylandInjector::connect(name, needs_pointer)?;
    injector.input_method = Some(method);
    Ok(Box::new(injector))
}

/// An input method that no thread reads yet.
struct Opened {
    method: InputMethod,
    queue: EventQueue<Reader>,
    reader: Reader,
}

impl InputMethod {
    /// Connects to the compositor of this name. Returns `None` if it has no input methods.
    fn open(name: &OsStr, field: Arc<FocusedField>) -> Result<Option<Opened>, String> {
        let socket = socket(name);
        let no_answer = |error: &dyn std::fmt::Display| no_answer(&socket, error);
        let stream = UnixStream::connect(&socket).map_err(|error| no_answer(&error))?;
        let duplicate = stream.try_clone().map_err(|error| no_answer(&error))?;
        let connection = Connection::from_socket(stream).map_err(|error| no_answer(&error))?;
        let (globals, queue) =
            registry_queue_init::<Reader>(&connection).map_err(|error| no_answer(&error))?;
        let handle = queue.handle();
        let manager: Result<ZwpInputMethodManagerV2, _> = globals.bind(&handle, 1..=1, ());
        let Ok(manager) = manager else {
            return Ok(None);
        };
        let seat: WlSeat = globals
            .bind(&handle, 1..=1, ())
            .map_err(|_| no_answer(&"it has no seat"))?;
        let method = manager.get_input_method(&seat, &handle, ());
        manager.destroy();
        let shared = Arc::new(Shared {
            field,
            done: AtomicU32::new(0),
        });
        Ok(Some(Opened {
            method: Self {
                connection,
                stream: duplicate,
                method,
                shared: Arc::clone(&shared),
                thread: None,
            },
            queue,
            reader: Reader::new(shared),
        }))
    }

    /// Writes text to the focused field. Returns `false` if the field is another one by now.
    pub fn compose(&self, composing: &Composing) -> Result<bool, String> {
        // Before the field, which changes first: the number of a later field never comes with the text for this one. With the number of an
        // earlier state, the compositor knows that the text was meant for that one.
        let serial = self.shared.done.load(Ordering::Acquire);
        if composing.field != self.shared.field.get().generation {
            return Ok(false);
        }
        let text = composing.text.to_string();
        if composing.is_committed {
            // It ends the word that is shown.
            self.method.commit_string(text);
        } else {
            let end = text.len() as i32;
            self.method.set_preedit_string(text, end, end);
        }
        self.method.commit(serial);
        let flushed = self.connection.flush();
        flushed.map_err(|error| {
            format!("the connection to the compositor for text failed: {error}")
        })?;
        Ok(true)
    }
}

impl Opened {
    /// Starts the thread. Returns `None` if another program is the input method.
    fn start(mut self) -> Result<Option<InputMethod>, String> {
        self.queue
            .roundtrip(&mut self.reader)
            .map_err(|error| format!("the compositor accepts no input method: {error}"))?;
        if self.reader.is_withdrawn {
            return Ok(None);
        }
        // Until a program says that a field of it has the focus.
        self.reader.report();
        let (mut queue, mut reader) = (self.queue, self.reader);
        let read = move || {
            while queue.blocking_dispatch(&mut reader).is_ok() {}
            // It may be a password.
            reader.shared.field.enter(FieldKind::Literal);
        };
        let thread = thread::Builder::new()
            .name("input method in".into())
            .spawn(read)
            .map_err(|error| advice::no_thread(&error).to_string())?;
        self.method.thread = Some(thread);
        Ok(Some(self.method))
    }
}

impl Drop for InputMethod {
    fn drop(&mut self) {
        // Closing the connection ends the input method, too.
        let _ = self.stream.shutdown(Shutdown::Both);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// The state of the focused field, as the compositor reports it.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
struct FieldState {
    /// `true` if the field takes text.
    is_active: bool,
    /// `true` if the field takes exactly what is typed.
    is_literal: bool,
    /// Sentences start with a capital.
    wants_capitals: bool,
}

/// The receiver of events.
struct Reader {
    shared: Arc<Shared>,
    current: FieldState,
    /// The state from the next `done` on.
    pending: FieldState,
    /// The place of the cursor in the text that has arrived since the last `done`.
    pending_place: Place,
    /// `true` if another field has become active since the last `done`.
    is_entered: bool,
    /// `true` if the compositor has another input method, or no longer has any.
    is_withdrawn: bool,
}

impl Reader {
    fn new(shared: Arc<Shared>) -> Self {
        Self {
            shared,
            current: FieldState::default(),
            pending: FieldState::default(),
            pending_place: Place::default(),
            is_entered: false,
            is_withdrawn: false,
        }
    }

    /// Applies the pending state.
    fn apply(&mut self) {
        let is_entered = std::mem::take(&mut self.is_entered);
        let place = std::mem::take(&mut self.pending_place);
        self.shared.field.place.set(if self.pending.wants_capitals {
            place
        } else {
            Place::Unknown
        });
        if is_entered || self.current != self.pending {
            self.current = self.pending;
            self.report();
        }
        // Last, see `InputMethod::compose`.
        self.shared.done.fetch_add(1, Ordering::AcqRel);
    }

    /// Tells the loop that the field and its text are others.
    fn report(&self) {
        // A program that says nothing may ask for a password.
        let is_text = self.current.is_active && !self.current.is_literal;
        self.shared.field.enter(if is_text {
            FieldKind::Text
        } else {
            FieldKind::Literal
        });
    }
}

impl Dispatch<ZwpInputMethodV2, ()> for Reader {
    fn event(
        reader: &mut Self,
        _: &ZwpInputMethodV2,
        event: zwp_input_method_v2::Event,
        _: &(),
        _: &Connection,
        _: &QueueHandle<Self>,
    ) {
        use zwp_input_method_v2::Event;
        match event {
            Event::Activate => {
                reader.is_entered = true;
                reader.pending = FieldState {
                    is_active: true,
                    ..FieldState::default()
                };
            }
            Event::Deactivate => reader.pending = FieldState::default(),
            Event::ContentType { hint, purpose } => {
                let (hint, purpose): (u32, u32) = (hint.into(), purpose.into());
                reader.pending.is_literal =
                    LITERAL_PURPOSES.contains(&purpose) || hint & LITERAL_HINTS != 0;
                reader.pending.wants_capitals = hint & CAPITALS_HINT != 0;
            }
            Event::Done => reader.apply(),
            Event::Unavailable => {
                if reader.shared.field.get().kind != FieldKind::Unknown {
                    tracing::warn!(
                        "the compositor has ended its input method: what is typed goes through the keys, uncorrected"
                    );
                }
                reader.is_withdrawn = true;
                reader.pending = FieldState::default();
                reader.current = reader.pending;
                reader.shared.field.enter(FieldKind::Literal);
            }
            Event::SurroundingText {
                text,
                cursor,
                anchor,
            } => {
                // A selection is replaced by what is typed.
                let before = text.get(..cursor.min(anchor) as usize);
                reader.pending_place = before.map_or(Place::Unknown, Place::at_end_of);
            }
            // The cause of the last change of the text.
            _ => {}
        }
    }
}

impl Dispatch<WlRegistry, GlobalListContents> for Reader {
    fn event(
        _: &mut Self,
        _: &WlRegistry,
        _: wl_registry::Event,
        _: &GlobalListContents,
        _: &Connection,
        _: &QueueHandle<Self>,
    ) {
    }
}

delegate_noop!(Reader: ignore WlSeat);
delegate_noop!(Reader: ZwpInputMethodManagerV2);
