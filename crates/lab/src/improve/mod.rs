//! Layouts that are changed until simulated people do better on them.
//!
//! ```text
//!  layout text ──Moves──▶ changed text ──Limits──▶ score of the people of the search ──Objective──▶ kept or dropped
//!                                                                                      best one ──▶ held-out people and phrases
//! ```
//!
//! All texts are scored with the same people, phrases and random numbers, so that a difference is one of the layouts. People and
//! phrases of the search never judge the result: a search finds what suits them by chance, too.

mod limits;
mod moves;
mod objective;
mod search;

pub use limits::Limits;
pub use moves::{MoveKind, Moves, NoMoves, State};
pub use objective::{Objective, ObjectiveError, Reference};
pub use search::{Found, ImproveError, Progress, Refused, Task, improve};
