//! Edits of the text of a layout, as replacements of parts of it.
//!
//! The RON text is the truth. An [`Edit`] becomes replacements of parts of the text, so that comments, order and the spelling of
//! numbers stay in everything that is not edited. A [`Part`] names what is edited; [`targets`] pairs the parts with the targets of
//! the layout.

mod add;
mod along_arc;
mod arrange;
mod axes;
mod bind;
mod clipboard;
mod clipboard_parts;
mod delete;
mod draft;
mod duplicate;
mod edit;
mod error;
mod fields;
mod geometry;
mod in_space;
mod names;
mod part;
mod patch;
mod rename;
mod rows;
mod scale;

pub use self::add::{NewPart, beside};
pub use self::arrange::{AlignEdge, BoardAxis, PlaceTo};
pub use self::bind::{Binding, Slot};
pub use self::clipboard::copied;
pub use self::clipboard_parts::has_parts_in_space;
pub use self::draft::Edited;
pub use self::edit::{Edit, delete_parts, duplicate_parts, edit, move_parts};
pub use self::error::EditError;
pub use self::fields::{FieldSpec, FieldType, can_turn, fields_of};
pub use self::geometry::{Place, places};
pub use self::names::name_of;
pub use self::part::{ControlKind, Part, part_at, part_of, parts_of, targets};
pub use self::patch::Patch;
