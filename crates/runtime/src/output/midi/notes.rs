//! MIDI 1.0 messages for the signals of a layout.

use ademan_core::contact::TargetId;
use ademan_core::device::EventKind;
use ademan_core::device::signals::{MidiKind, Signals};

/// A message of a channel: a status byte and two numbers.
pub(super) type Message = [u8; 3];

/// Status bytes, to which the channel is added.
const NOTE_OFF: u8 = 0x80;
const NOTE_ON: u8 = 0x90;
const KEY_PRESSURE: u8 = 0xa0;
pub(super) const CONTROL: u8 = 0xb0;

/// The controller that ends all notes of a channel.
pub(super) const ALL_NOTES_OFF: u8 = 123;

/// The largest number in a message.
const MAX: f32 = 127.0;

/// The velocity of the release of a key that does not measure it, and of a press without a speed.
const DEFAULT_VELOCITY: u8 = 64;

/// The notes that sound, and the numbers that wait to be sent.
#[derive(Debug, Default)]
pub(super) struct Notes {
    signals: Signals,
    /// The states, in the order of the signals.
    states: Vec<State>,
}

/// The messages that one signal has sent and still has to send.
#[derive(Clone, Copy, Debug, Default)]
struct State {
    is_on: bool,
    /// `true` if the note has ended and that was not sent.
    is_release_due: bool,
    /// `true` if the controller follows the depth of a key that is not at rest.
    is_deep: bool,
    /// The number sent last: the position of a controller, or the pressure of a note.
    sent: Option<u8>,
    /// The number that waits.
    due: Option<u8>,
}

impl Notes {
    /// Sets the signals; nothing sounds then.
    pub fn set_signals(&mut self, signals: &Signals) {
        self.states = vec![State::default(); signals.iter().len()];
        self.signals = signals.clone();
    }

    /// Handles an event. Returns the index of a signal whose note begins, and the message.
    pub fn update(&mut self, event: EventKind) -> Option<(usize, Message)> {
        match event {
            EventKind::Velocity(target, 0.0) | EventKind::Unselect(target) => {
                self.end(self.signals.index(target)?);
                None
            }
            EventKind::Velocity(target, velocity) => self.note_on(target, number(velocity).max(1)),
            EventKind::Select(target) => self.note_on(target, DEFAULT_VELOCITY),
            EventKind::Depth(target, value) | EventKind::Value(target, value) => {
                let index = self.signals.index(target)?;
                let is_control = matches!(self.midi(index)?.0, MidiKind::Control(_));
                let state = &mut self.states[index];
                let number = number(value);
                let is_heard = state.is_on || is_control;
                state.due = (is_heard && state.sent != Some(number)).then_some(number);
                state.is_deep = is_control && matches!(event, EventKind::Depth(..)) && number > 0;
                None
            }
            _ => None,
        }
    }

    /// Records that the message that begins the note of a signal was sent.
    pub fn begin(&mut self, index: usize) {
        self.states[index] = State {
            is_on: true,
            ..State::default()
        };
    }

    /// Ends all notes, and returns the controllers that follow the depth of a key to 0.
    pub fn end_all(&mut self) {
        for index in 0..self.states.len() {
            self.end(index);
            let state = &mut self.states[index];
            if std::mem::take(&mut state.is_deep) {
                state.due = Some(0);
            }
        }
    }

    /// Returns the next message that ends a note.
    pub fn next_release(&mut self) -> Option<Message> {
        let index = self.states.iter().position(|state| state.is_release_due)?;
        self.states[index] = State::default();
        let (MidiKind::Note(note), channel) = self.midi(index)? else {
            return None;
        };
        Some([NOTE_OFF | channel, note, DEFAULT_VELOCITY])
    }

    /// Returns the next message with a number that waits.
    pub fn next_motion(&mut self) -> Option<Message> {
        let index = self.states.iter().position(|state| state.due.is_some())?;
        let state = &mut self.states[index];
        state.sent = state.due.take();
        let number = state.sent?;
        let (kind, channel) = self.midi(index)?;
        Some(match kind {
            MidiKind::Note(note) => [KEY_PRESSURE | channel, note, number],
            MidiKind::Control(control) => [CONTROL | channel, control, number],
        })
    }

    /// Returns `true` if a number waits.
    pub fn has_motion(&self) -> bool {
        self.states.iter().any(|state| state.due.is_some())
    }

    fn midi(&self, index: usize) -> Option<(MidiKind, u8)> {
        let (_, signal) = self.signals.iter().nth(index)?;
        Some((signal.midi?, signal.channel))
    }

    fn note_on(&self, target: TargetId, velocity: u8) -> Option<(usize, Message)> {
        let index = self.signals.index(target)?;
        match self.midi(index)? {
            (MidiKind::Note(note), channel) => Some((index, [NOTE_ON | channel, note, velocity])),
            (MidiKind::Control(_), _) => None,
        }
    }

    /// Ends the note of a signal, unless another key holds the same note.
    fn end(&mut self, index: usize) {
        if !self.states[index].is_on {
            return;
        }
        self.states[index] = State::default();
        let midi = self.midi(index);
        let is_held = (0..self.states.len())
            .any(|other| self.states[other].is_on && self.midi(other) == midi);
        self.states[index].is_release_due = !is_held;
    }
}

/// Returns a value of 0..=1 as a MIDI number. The turns of an endless knob are cut off.
fn number(value: f32) -> u8 {
    (value * MAX).round().clamp(0.0, MAX) as u8
}
