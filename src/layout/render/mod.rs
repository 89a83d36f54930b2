//! Drawings of a layout: text for a terminal, and SVG.

mod svg;
mod terminal;
mod words;

pub use terminal::{Cell, Grid};
