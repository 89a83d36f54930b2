//! Signals that controls send to music and stage programs, through the outputs `osc` and `midi`.

use std::sync::Arc;

use crate::contact::TargetId;

/// The messages that a control sends beside its events.
#[derive(Clone, Debug, PartialEq)]
pub struct Signal {
    /// Address of its OSC messages, such as `/mixer/1`; `None` if it sends none.
    pub address: Option<String>,
    /// The numbers that OSC messages have for the values 0 and 1.
    pub range: (f32, f32),
    /// Channel of its MIDI messages, 0..=15: one less than the number that music programs show.
    pub channel: u8,
    /// The MIDI messages; `None` if it sends none.
    pub midi: Option<MidiKind>,
}

/// The kind of MIDI message of a signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MidiKind {
    /// A note, 0..=127; 60 is middle C.
    Note(u8),
    /// A controller, 0..=119; 7 is the volume of a channel.
    Control(u8),
}

/// The signals of a layout. Cloning is cheap: clones share the list.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Signals(Arc<[(TargetId, Signal)]>);

impl Signals {
    /// Creates the list. If a target occurs several times, only one of its signals is kept.
    pub fn new(signals: impl IntoIterator<Item = (TargetId, Signal)>) -> Self {
        let mut signals: Vec<_> = signals.into_iter().collect();
        signals.sort_by_key(|(target, _)| *target);
        signals.dedup_by_key(|(target, _)| *target);
        Self(signals.into())
    }

    /// Returns the index of the signal of a target.
    pub fn index(&self, target: TargetId) -> Option<usize> {
        self.0.binary_search_by_key(&target, |(own, _)| *own).ok()
    }

    /// Iterates over the signals, in the order of their targets.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &(TargetId, Signal)> {
        self.0.iter()
    }
}
