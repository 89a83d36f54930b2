//! Layouts, gloves, arms and persons from `layouts/**/*.ron`.
//!
//! A file is deserialised into a schema, which uses the units in its field names. The builder turns the schema into a checked
//! model in SI units. Every error names file, line and column.
//!
//! ```text
//!  Document ──▶ schema, keys, controls ──▶ LayoutBuilder ──▶ Layout (model) ──▶ devices
//!  document     as written                 names, geometry   checked            render, hover
//! ```

mod arm;
mod board_overlap;
mod board_shape;
mod builder;
pub(crate) mod controls;
mod devices;
mod draft;
mod edit;
mod fields;
mod fit;
mod gaps;
mod glove;
mod glove_edit;
mod glove_numbers;
mod hover;
mod keys;
mod load;
mod mirror;
mod model;
mod multitap;
mod outline;
mod person;
mod placement;
pub mod quantity;
mod render;
mod schema;
mod sequences;
mod shape;
mod signals;

pub use arm::{arm_field_tables, arm_shapes};
pub use board_overlap::BoardOverlap;
pub use board_shape::BoardShape;
pub use controls::{Handle, KindSpec};
pub use draft::{LayoutDraft, LayoutFault};
pub use edit::{move_boards, scale_boards};
pub use fields::field_tables;
pub use fit::Fit;
pub use glove::{Glove, glove_field_tables};
pub use glove_edit::write_calibration;
pub use hover::Hover;
pub use mirror::mirror_layout;
pub use model::{
    BASE_LAYER, Board, Control, ControlKind, Face, Key, Layout, MAX_LAYERS, MAX_TARGETS, POINTER,
    SpaceTargets,
};
pub(crate) use multitap::is_multitap;
pub use outline::Outline;
pub use person::{HandUse, Motion, Person, Scatter, Tremor, person_field_tables};
pub use render::{
    Cell, CellMark, FrontMark, Grid, Heat, KeySize, MarkRole, MarkShape, ReachArea, TooManyShapes,
    Wearer, heat_style,
};
pub use schema::TextModeSchema;
pub use shape::{Shape, ShapeMove};
