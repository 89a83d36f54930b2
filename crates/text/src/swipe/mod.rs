//! Words from the path of a finger that stays on the keyboard and moves over their letters.
//!
//! A word explains a path by its letters, in order, at points of the path, and by straight lines between them (the location
//! channel of Kristensson and Zhai 2004, with dynamic programming in place of points at equal distances):
//!
//! ```text
//! Σ |point of letter − key|² / 2σ² + Σ (|other points − line between the keys|² / 2σ² + turn (1 − cos angle)) spacing / length − λ ln P
//! ```
//!
//! The angle is between the path and the line, so that a way back is no way there; P is the probability of the word after the
//! words before.
//!
//! The search goes down the trie of words depth first. Each letter costs one row of a table, a number for each sample of the path, and a
//! branch ends when the best number of its row, with the likeliest word below it, is worse than the words found. Doubled letters and
//! apostrophes have no point of their own.

mod path;
mod search;

pub use path::SwipePath;
pub(crate) use path::distance;
pub(crate) use search::Swipes;
