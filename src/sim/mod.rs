//! Simulated people who play the devices, and scores of what came out.

mod movement;
mod simulated_hand;
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

pub use action::{HandAction, TargetPoint};
pub use action_error::{ActionError, ActionErrorKind};
pub use player::{PacketWriters, PlaybackStats, play};
pub use score::{TypingScore, error_rate, words_per_minute};
pub use script::Script;
pub use simulated_hand::GloveCounts;
pub use text_field::UsTextField;
pub use text_plan::{PlanError, taps_for_text};
pub use typing_hand::{REACH_TOLERANCE, TapPath, TypingHand};
pub use typist::{SimulatedTypist, TypistError, TypistSettings};
