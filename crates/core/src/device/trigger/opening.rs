//! A hand that opens. A flat hand at rest is open, too, so an open hand counts only after a closed one.

use std::time::Duration;

use super::HandShape;
use crate::estimate::FingerBends;
use crate::time::Timestamp;

/// The longest time from a closed hand to an open one.
const OPENING_TIME: Duration = Duration::from_secs(1);

/// The confidence at which a hand is closed: a hand around a cup is not so bent, and becomes flat when it puts the cup down.
const CLOSES: f32 = 0.8;

/// The confidence at which a closed hand has opened: a hand that comes to rest is not so straight.
const OPENS: f32 = 0.8;

/// The confidence to which a hand stays open.
const STAYS: f32 = 0.5;

/// The state of one hand.
#[derive(Clone, Copy, Debug, Default)]
pub(super) enum Opening {
    /// Neither closed nor opened.
    #[default]
    None,
    /// Closed at this time, and not open since.
    Closed(Timestamp),
    /// Open since it was closed.
    Open,
}

impl Opening {
    /// Processes the next step of the hand.
    pub(super) fn update(&mut self, bends: &FingerBends, time: Timestamp) {
        let open = HandShape::OpenHand.confidence(bends);
        let closed = HandShape::closed_confidence(bends);
        let (Some(open), Some(closed)) = (open, closed) else {
            *self = Self::None;
            return;
        };
        *self = match *self {
            _ if closed >= CLOSES => Self::Closed(time),
            Self::Closed(since) if time.since(since) > OPENING_TIME => Self::None,
            Self::Closed(_) if open >= OPENS => Self::Open,
            Self::Open if open < STAYS => Self::None,
            other => other,
        };
    }

    /// Returns `true` if the hand is open since it was closed.
    pub(super) fn is_open(self) -> bool {
        matches!(self, Self::Open)
    }
}
