//! Drawings of a layout: text for a terminal, SVG, and HTML.

mod cell_marks;
mod front;
mod html;
mod svg;
mod terminal;
mod wearer;
mod words;

pub use cell_marks::CellMark;
pub use front::{FrontMark, MarkRole, MarkShape};
pub use svg::{Heat, TooManyShapes, heat_style};
pub use terminal::{Cell, Grid, KeySize};
pub use wearer::{ReachArea, Wearer};

/// The drawing interface of controls: shapes on a canvas, from which SVG and the marks of all other displays are made, and words.
pub(super) mod drawing {
    pub use super::svg::{
        Canvas, Placement, draw_fitted, draw_label, draw_outline, label_half, on_page, text_room,
    };
    pub use super::words::Words;
}
