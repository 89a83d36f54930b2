//! Simulated people who play the devices, and scores of what came out.

mod movement;
mod one_hand;
mod oracle;
mod order;
mod plan;
mod planner;
mod player;
mod receiver;
mod refusal;
mod score;
mod script;
mod typing_hand;
mod typist;

pub use one_hand::GloveCounts;
pub use oracle::{Cause, Oracle, Rules, Seen, Step, Violation};
pub use order::{Order, Spot};
pub use plan::{PlanError, taps};
pub use player::{Lines, Played, play};
pub use receiver::UsKeymap;
pub use refusal::{Reason, Refusal};
pub use score::{TypingScore, error_rate, words_per_minute};
pub use script::Script;
pub use typing_hand::{KeyStroke, REACH_ERROR, TypingHand};
pub use typist::{Typist, TypistError, TypistSettings};
