//! Simulated people who play the devices, and scores of what came out.

mod plan;
mod player;
mod receiver;
mod score;
mod typing_hand;
mod typist;

pub use plan::{PlanError, Tap, taps};
pub use player::{Played, play};
pub use receiver::UsKeymap;
pub use score::{TypingScore, error_rate, words_per_minute};
pub use typing_hand::{KeyStroke, TypingHand};
pub use typist::{Typist, TypistError, TypistSettings};
