//! `layouts/*.ron` as people write them → checked, in SI units; every error names file, line and column.

mod arm;
mod check;
mod controls;
mod draw;
mod error;
pub mod file;
mod glove;
pub mod keyboard;
pub mod number;
mod outline;
mod over;
mod placement;
mod rewrite;
mod svg;
mod syntax;
mod text;
mod written;

pub use controls::space::Scenery;
pub use controls::{Control, Kind};
pub use draw::{Cell, Grid};
pub use error::LayoutError;
pub use file::{Document, parse};
pub use glove::Glove;
pub use keyboard::{Board, Front, Key, Layout};
pub use outline::Outline;
pub use over::OverBoard;
pub use placement::Bend;
pub use rewrite::{moved, scaled};
pub use text::{Label, Pairs, Word};
