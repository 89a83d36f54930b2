//! Scripts in, transcripts out: the language of the tests and the rigs that play it.
//!
//! A script is a list of steps. Steps are separated by `;` or a new line, orders of one step, which happen at the same
//! time, by `&`, and the words of an order by blanks. Names with blanks are quoted; `#` begins a comment. Lengths are in
//! millimetres, angles in degrees, times in milliseconds.
//!
//! Two rigs play scripts. [`fingers`] puts fingertips at exact positions and drives contact tracking and devices;
//! `scenarios` lets a simulated hand wear a glove and drives everything from its bytes to the events.
//!
//! Orders of both: `wait MS`, `set JOINT DEG`, with the meaning of `docs/scripts.md`.
//!
//! **Orders of [`fingers`].** Each step is one reading of a hand, 10 ms after the previous one.
//!
//! | order | meaning |
//! |---|---|
//! | `FINGER NAME [X Y] up` | the fingertip is 6 mm above the center of a target, or above the point X, Y of its front |
//! | `FINGER NAME [X Y] down` | it is at the end of the travel |
//! | `FINGER NAME [X Y] MM` | it is so deep |
//! | `FINGER NAME [X Y] tap` | three steps: up, down, up |
//! | `tip FINGER X Y Z` | the fingertip is at a position in the world |
//! | `palm X Y Z` | the hand is rotated about the world's axes |
//! | `knuckle X Y Z` | the index MCP joint is at a position in the world |
//! | `hide FINGER` | the finger is not tracked |
//! | `doubt FINGER`, `trust FINGER` | the finger is tracked, but not to be trusted; trusted again |
//! | `left`, `right` | the following is about this hand |
//! | `reacquire` | tracking jumps to another position |
//! | `gap MS` | the readings of the last MS milliseconds before the step are missing |
//! | `reset` | the contact tracker forgets all contacts |
//! | `release` | everything is released, as by the pipeline |
//! | `release-devices` | the devices release everything, the contacts stay |
//!
//! **Orders of `scenarios`:** the orders of the simulated hand (`docs/scripts.md`) and of `scenarios::directive`, which
//! are about what happens to the run.
//!
//! Events are written as [`transcript`] says.

pub mod board;
pub mod fingers;
pub mod script;
pub mod transcript;

pub use fingers::Rig;
