//! Simulated people who play the devices, and scores of what came out.

mod movement;
mod simulated_hand;
mod oracle;
mod action;
mod text_plan;
mod planner;
mod player;
mod text_field;
mod action_error;
mod score;
mod script;
mod typing_hand;
mod typist;

pub use simulated_hand::GloveCounts;
pub use oracle::{Cause, Oracle, OutputRules, ObservedStep, Observation, Violation};
pub use action::{HandAction, TargetPoint};
pub use text_plan::{PlanError, taps_for_text};
pub use player::{PacketWriters, PlaybackStats, play};
pub use text_field::UsTextField;
pub use action_error::{ActionErrorKind, ActionError};
pub use score::{TypingScore, error_rate, words_per_minute};
pub use script::Script;
pub use typing_hand::{TapPath, REACH_TOLERANCE, TypingHand};
pub use typist::{SimulatedTypist, TypistError, TypistSettings};
