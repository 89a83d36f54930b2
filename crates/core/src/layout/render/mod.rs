//! Drawings of a layout: text for a terminal, SVG, and HTML.

mod html;
mod svg;
mod terminal;
mod wearer;
mod words;

pub use svg::{Heat, TooManyShapes, heat_style};
pub use terminal::{Cell, Grid, KeySize};
pub use wearer::{ReachArea, Wearer};
