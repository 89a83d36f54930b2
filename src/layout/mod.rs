//! `layouts/*.ron` as people write them → checked, in SI units; every error names file, line and column.

mod arm;
mod builder;
mod controls;
mod draw;
mod glove;
pub mod model;
pub mod ranged;
mod outline;
mod hover;
mod placement;
mod edit;
mod svg;
mod text;
mod schema;

pub use crate::document::{self, Document, DocumentError, parse_ron};
pub use controls::space::SpaceTargets;
pub use controls::{Control, ControlKind};
pub use draw::{Cell, Grid};
pub use edit::{move_boards, scale_boards};
pub use glove::Glove;
pub use hover::Hover;
pub use model::{Board, Face, Key, Layout};
pub use outline::Outline;
pub use placement::BoardShape;
pub use text::{Label, Pairs, Spanned};
