//! The answer to the question that matters most: are other programs typed into?

use super::model::StudioModel;
use super::texts::{text, text_with};
use ademan_core::pipeline::PipelineState;
use ademan_runtime::output;

/// The effect of the session on other programs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Typing {
    /// No output reaches another program.
    Nowhere,
    /// The outputs reach other programs, and no events are sent at present.
    Suppressed,
    /// Events reach other programs through these outputs.
    Into(String),
    /// The session has ended.
    Ended,
}

impl Typing {
    /// Returns the present effect.
    pub fn new(model: &StudioModel) -> Self {
        let state = &model.view.state;
        if model.has_ended {
            Self::Ended
        } else {
            Self::with_output(&state.output, state.state)
        }
    }

    /// Returns the effect of a session with these outputs in this state.
    pub fn with_output(names: &str, state: PipelineState) -> Self {
        if !output::has_effect(names) {
            return Self::Nowhere;
        }
        match state {
            PipelineState::Running => Self::Into(names.to_owned()),
            PipelineState::Stopped => Self::Ended,
            _ => Self::Suppressed,
        }
    }

    /// Returns the words for the status line.
    pub fn words(&self) -> String {
        match self {
            Self::Nowhere => text("typing-nowhere").to_owned(),
            Self::Suppressed => text("typing-suppressed").to_owned(),
            Self::Into(names) => text_with("typing-into", &[("output", names.as_str().into())]),
            Self::Ended => text("message-ended").to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_running_session_with_an_output_types_into_other_programs() {
        let into = Typing::Into("desktop".to_owned());
        for (names, state, expected) in [
            ("none", PipelineState::Running, Typing::Nowhere),
            ("transcript", PipelineState::Running, Typing::Nowhere),
            ("desktop", PipelineState::Running, into),
            ("desktop", PipelineState::Paused, Typing::Suppressed),
            ("desktop", PipelineState::Stalled, Typing::Suppressed),
            ("desktop", PipelineState::Stopped, Typing::Ended),
        ] {
            assert_eq!(Typing::with_output(names, state), expected, "{names}");
        }
    }

    #[test]
    fn no_output_is_said_plainly() {
        let words = Typing::Nowhere.words();
        assert_eq!(words, "Nothing is typed into other programs");
    }
}
