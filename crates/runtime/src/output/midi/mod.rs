//! The output `midi`: what the signals of a layout send, as MIDI messages to a port or to a raw device.
//!
//! A key plays its note with the velocity of the press; its depth, if it reports it, is the pressure of that note. A control with a
//! value moves its controller. Notes end as keys are released: at every stop, loss, stall and change of the layout, and at the end.
//!
//! A receiver may be slow or hang, so a thread of its own writes; the loop only puts messages into a queue. The thread ends all notes
//! when its queue is closed for any reason, and when the loop hangs while a note sounds. For the case that the whole process is
//! killed it sends Active Sensing, after which a receiver that knows it ends the notes itself (MIDI 1.0: 300 ms).

mod notes;
mod port;
mod raw;
mod thread;

use crossbeam_channel::{Sender, TrySendError};

use self::notes::{Message, Notes};
use self::thread::{MidiThread, Writer};
use super::{Backend, OpenRequest, OutputError, Sink};
use ademan_core::device::signals::Signals;
use ademan_core::device::{Capabilities, OutputEvent};

/// The backend `midi`.
pub const BACKEND: Backend = Backend {
    name: "midi",
    argument: Some("DEVICE"),
    is_argument_required: false,
    summary: "the signals of a layout as MIDI, through a virtual port (feature `midi`) or a raw device: midi:/dev/snd/midiC1D0",
    capabilities: Capabilities::default,
    is_log: false,
    is_fixed_when_open: false,
    check: None,
    open,
};

/// Capacity of the queue, in messages.
const QUEUE: usize = 256;

/// Notes begin until the queue is half full. Each of them ends with one message.
const PRESS_LIMIT: usize = QUEUE / 2;

/// Controllers and pressures wait from there on.
const MOTION_LIMIT: usize = QUEUE - QUEUE / 4;

/// Opens the output.
fn open(request: &OpenRequest) -> Result<Box<dyn Sink>, OutputError> {
    let opened = match request.argument {
        Some(path) => raw::open(path.as_ref()),
        None => port::open(),
    };
    let writer = opened.map_err(|reason| OutputError::open(request.name, reason))?;
    let midi = Midi::start(writer).map_err(|error| OutputError::open(request.name, error))?;
    Ok(Box::new(midi))
}

/// Checks what opening the output needs, without opening it: the device in its argument, or else ports in this build. An error states
/// the cause and the remedy.
pub(super) fn check_presence(argument: Option<&str>) -> Result<(), String> {
    match argument {
        Some(path) => raw::check(path.as_ref()),
        None => port::check_build(),
    }
}

/// A sink that sends MIDI messages.
///
/// While the queue is half full, notes do not begin and are [counted](Sink::dropped_presses); while it is three quarters full, the
/// latest position of a controller waits for the next step. The end of a note always finds room.
pub struct Midi {
    messages: Option<Sender<Message>>,
    thread: MidiThread,
    notes: Notes,
    dropped_presses: u64,
    has_stalled: bool,
    coalesced_motions: u64,
}

impl Midi {
    fn start(writer: Writer) -> std::io::Result<Self> {
        let (messages, queue) = crossbeam_channel::bounded(QUEUE);
        Ok(Self {
            thread: MidiThread::start(writer, queue)?,
            messages: Some(messages),
            notes: Notes::default(),
            dropped_presses: 0,
            has_stalled: false,
            coalesced_motions: 0,
        })
    }

    /// Adds the messages that are due to the queue: numbers that wait up to `motion_limit` messages.
    fn send_due(&mut self, motion_limit: usize) -> Result<(), OutputError> {
        let Some(messages) = &self.messages else {
            return Err(error("it is closed"));
        };
        while let Some(message) = self.notes.next_release() {
            put(messages, message)?;
        }
        while messages.len() < motion_limit {
            let Some(message) = self.notes.next_motion() else {
                return Ok(());
            };
            put(messages, message)?;
        }
        self.coalesced_motions += u64::from(self.notes.has_motion());
        Ok(())
    }

    fn begin(&mut self, index: usize, message: Message) -> Result<(), OutputError> {
        let Some(messages) = &self.messages else {
            return Err(error("it is closed"));
        };
        self.has_stalled |= messages.len() >= PRESS_LIMIT;
        if self.has_stalled {
            self.dropped_presses += 1;
            return Ok(());
        }
        put(messages, message)?;
        self.notes.begin(index);
        Ok(())
    }
}

impl Sink for Midi {
    fn send(&mut self, events: &[OutputEvent]) -> Result<(), OutputError> {
        self.thread.report_life();
        let mut result = Ok(());
        for event in events {
            // In the order of the events: a key may be released and pressed in one step.
            if let Some((index, message)) = self.notes.update(event.kind) {
                result = result
                    .and(self.send_due(MOTION_LIMIT))
                    .and(self.begin(index, message));
            }
        }
        result.and(self.send_due(MOTION_LIMIT))
    }

    fn capabilities(&self) -> Capabilities {
        Capabilities::default()
    }

    fn set_signals(&mut self, signals: &Signals) {
        self.notes.end_all();
        // No note sounds that would need the rest of the queue for its end, and what waits is lost.
        let _ = self.send_due(QUEUE);
        self.notes.set_signals(signals);
    }

    fn void_presses(&mut self) {
        self.has_stalled = false;
    }

    fn has_stalled(&self) -> bool {
        self.has_stalled
    }

    fn close(&mut self) -> Result<(), OutputError> {
        self.notes.end_all();
        let sent = match self.messages {
            Some(_) => self.send_due(QUEUE),
            None => Ok(()),
        };
        self.messages = None;
        sent.and(self.thread.join().map_err(|reason| error(&reason)))
    }

    fn dropped_presses(&self) -> u64 {
        self.dropped_presses
    }

    fn coalesced_motions(&self) -> u64 {
        self.coalesced_motions
    }
}

impl Drop for Midi {
    fn drop(&mut self) {
        let _ = self.close();
    }
}

fn put(messages: &Sender<Message>, message: Message) -> Result<(), OutputError> {
    match messages.try_send(message) {
        Ok(()) => Ok(()),
        Err(TrySendError::Full(_)) => Err(error("its queue is full")),
        Err(TrySendError::Disconnected(_)) => {
            Err(error("the device does not accept messages any more"))
        }
    }
}

fn error(reason: &str) -> OutputError {
    OutputError::send(BACKEND.name, reason)
}

#[cfg(test)]
mod tests;
