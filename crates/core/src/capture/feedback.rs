//! Messages to a glove: force feedback and haptic pulses.

use serde::{Deserialize, Serialize};

use super::Sample;
use crate::document::schema;
use crate::hand::Finger;

schema! {
    /// The kinds of feedback that a glove has.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
    pub enum Haptics {
        /// None.
        #[default]
        Off,
        /// Force feedback: a finger that presses is held from curling further.
        Force,
        /// Haptic pulses: a finger that touches or presses feels a vibration.
        Pulse,
        /// Both.
        Both,
    }
}

impl Haptics {
    /// All kinds.
    pub const ALL: [Self; 4] = [Self::Off, Self::Force, Self::Pulse, Self::Both];

    /// Returns the name used in messages and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Off => "off",
            Self::Force => "force",
            Self::Pulse => "pulse",
            Self::Both => "both",
        }
    }

    /// Returns `true` if fingers are held.
    pub const fn has_force(self) -> bool {
        matches!(self, Self::Force | Self::Both)
    }

    /// Returns `true` if touches are felt as pulses.
    pub const fn has_pulses(self) -> bool {
        matches!(self, Self::Pulse | Self::Both)
    }
}

/// A haptic pulse.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pulse {
    /// The end of any pulse.
    #[default]
    Off,
    /// A finger has touched a key.
    Touch,
    /// A finger has pressed a key.
    Press,
}

/// A message to a glove.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Feedback {
    /// Force of each finger, in the order of [`Finger::ALL`]: 0 if it is free, and 1 if it is held straight. In between it
    /// can curl up to the complement of the force. `None` if the message is about something else.
    pub forces: Option<[f32; Finger::COUNT]>,
    /// The pulse to start. `None` if the message is about something else.
    pub pulse: Option<Pulse>,
}

/// The feedback of a protocol.
#[derive(Debug)]
pub struct FeedbackFormat {
    /// Returns the curl of a finger, 0 (straight) to 1 (closed); `None` if the sample does not have it.
    pub curl: fn(&Sample, Finger) -> Option<f32>,
    /// Appends a message in the form of the wire.
    pub encode: fn(&Feedback, &mut Vec<u8>),
}
