//! The words for a state.

use super::super::TrayState;
use ademan_core::hand::Side;
use ademan_core::pipeline::PipelineState;

/// A state as far as a person has to know it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Condition {
    /// The output waits for a hand that is clear of every key, or for the first reading.
    Waiting,
    /// Touches are typed.
    Armed,
    /// A pause was requested.
    Paused,
    /// A hand or the source is lost.
    Lost,
}

/// Returns the condition of a state.
pub fn condition(state: &TrayState) -> Condition {
    match state.state {
        PipelineState::Stalled => Condition::Lost,
        PipelineState::Paused if state.paused_by.is_some() => Condition::Paused,
        PipelineState::Running if state.lost_hands.contains(&true) => Condition::Lost,
        PipelineState::Running => Condition::Armed,
        PipelineState::Paused | PipelineState::Starting | PipelineState::Stopped => {
            Condition::Waiting
        }
    }
}

/// Returns the heading of a state.
pub fn heading(state: &TrayState) -> &'static str {
    match condition(state) {
        Condition::Waiting => "Ademán waits",
        Condition::Armed => "Ademán is armed",
        Condition::Paused => "Ademán is paused",
        Condition::Lost if state.state == PipelineState::Stalled => "Ademán: no readings",
        Condition::Lost => "Ademán: a hand is lost",
    }
}

/// Returns the sentence below the heading.
pub fn sentence(state: &TrayState) -> String {
    match condition(state) {
        Condition::Waiting if state.state == PipelineState::Starting => {
            "No reading has arrived.".into()
        }
        Condition::Waiting => "Hold the hand clear of all keys for a moment to arm.".into(),
        Condition::Armed => "Touches are sent to the outputs.".into(),
        Condition::Paused => {
            let origin = state.paused_by.map_or("", |origin| origin.description());
            format!("Everything is released. Paused by {origin}.")
        }
        Condition::Lost if state.state == PipelineState::Stalled => {
            "Everything is released. Check the source of the hand.".into()
        }
        Condition::Lost => {
            let lost = Side::ALL
                .iter()
                .filter(|side| state.lost_hands[side.index()]);
            let lost: Vec<_> = lost.map(|side| side.name()).collect();
            let lost = lost.join(" and ");
            format!("What the {lost} hand held is released. It is not tracked.")
        }
    }
}
