//! The state of a session, and what the person has to know of it.

use std::time::{Duration, Instant};

use openxr::SessionState;

/// Time without a tracked hand after which a person is told what the source waits for.
const WAIT: Duration = Duration::from_secs(5);

/// The progress of a session towards hands.
pub struct SessionProgress {
    state: SessionState,
    had_focus: bool,
    opened: Instant,
    /// `true` if a hand was tracked, or the person was told that none is.
    is_settled: bool,
}

/// A message about a session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SessionMessage {
    /// Another application has the input.
    LostFocus,
    /// The session has the input again.
    HasFocusAgain,
    /// The runtime has stopped the session, which starts again by itself.
    Stopped,
    /// No hand was tracked since the start, in a session that has the input.
    NoHand,
    /// The session has not started.
    NotStarted,
}

impl SessionMessage {
    /// Returns what happened, and what to do.
    pub fn text(self) -> &'static str {
        match self {
            Self::LostFocus => {
                "the OpenXR runtime gave the focus to another application; if it gives no hands, close that application"
            }
            Self::HasFocusAgain => "the session has the focus of the OpenXR runtime again",
            Self::Stopped => {
                "the OpenXR runtime has stopped the session; put on the headset to continue"
            }
            Self::NoHand => {
                "no hand was tracked for 5 s; put down the controllers, and hold a hand in view of the headset"
            }
            Self::NotStarted => {
                "the OpenXR runtime has not started the session for 5 s; put on the headset"
            }
        }
    }

    /// Returns `true` if the person has to do something.
    pub fn is_warning(self) -> bool {
        self != Self::HasFocusAgain
    }
}

impl SessionProgress {
    /// Creates the progress of a session that was opened `now`.
    pub fn new(now: Instant) -> Self {
        Self {
            state: SessionState::IDLE,
            had_focus: false,
            opened: now,
            is_settled: false,
        }
    }

    /// Handles a change of the state.
    pub fn change(&mut self, state: SessionState) -> Option<SessionMessage> {
        let had_focus = self.state == SessionState::FOCUSED;
        self.state = state;
        match state {
            SessionState::FOCUSED if self.had_focus => Some(SessionMessage::HasFocusAgain),
            SessionState::FOCUSED => {
                self.had_focus = true;
                None
            }
            SessionState::VISIBLE | SessionState::SYNCHRONIZED if had_focus => {
                Some(SessionMessage::LostFocus)
            }
            SessionState::STOPPING => Some(SessionMessage::Stopped),
            _ => None,
        }
    }

    /// Handles an instant at which the hands were located. Returns what it waits for, once.
    pub fn locate(&mut self, now: Instant, has_hand: bool) -> Option<SessionMessage> {
        if self.is_settled {
            return None;
        }
        let is_late = now.saturating_duration_since(self.opened) >= WAIT;
        self.is_settled = has_hand || is_late;
        let is_running = ![SessionState::IDLE, SessionState::READY].contains(&self.state);
        match (has_hand, is_late, is_running) {
            (false, true, true) => Some(SessionMessage::NoHand),
            (false, true, false) => Some(SessionMessage::NotStarted),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lost_focus_is_reported_and_a_first_one_is_not() {
        let mut progress = SessionProgress::new(Instant::now());
        let states = [
            SessionState::READY,
            SessionState::SYNCHRONIZED,
            SessionState::VISIBLE,
            SessionState::FOCUSED,
            SessionState::VISIBLE,
            SessionState::SYNCHRONIZED,
            SessionState::VISIBLE,
            SessionState::FOCUSED,
            SessionState::VISIBLE,
            SessionState::STOPPING,
        ];
        let messages = states.map(|state| progress.change(state));
        let expected = [
            (4, SessionMessage::LostFocus),
            (7, SessionMessage::HasFocusAgain),
            (8, SessionMessage::LostFocus),
            (9, SessionMessage::Stopped),
        ];
        for (index, message) in messages.iter().enumerate() {
            let expected = expected.iter().find(|(at, _)| *at == index);
            assert_eq!(*message, expected.map(|(_, text)| *text), "{index}");
        }
    }

    #[test]
    fn a_person_is_told_once_what_the_source_waits_for() {
        let start = Instant::now();
        for (state, expected) in [
            (SessionState::IDLE, SessionMessage::NotStarted),
            (SessionState::FOCUSED, SessionMessage::NoHand),
        ] {
            let mut progress = SessionProgress::new(start);
            progress.change(state);
            let at = |seconds| start + Duration::from_secs(seconds);
            assert_eq!(progress.locate(at(4), false), None);
            assert_eq!(progress.locate(at(5), false), Some(expected));
            assert_eq!(progress.locate(at(60), false), None);
        }
        let mut progress = SessionProgress::new(start);
        assert_eq!(progress.locate(start, true), None);
        assert_eq!(progress.locate(start + WAIT, false), None);
    }
}
