//! Drawings in SVG.
//!
//! ```text
//!  Layout, Wearer ──▶ board, layers, chords, space, lists ──▶ page ──▶ SVG
//!                     sections on a Canvas, in millimetres
//! ```

mod board;
mod canvas;
mod chords;
mod controls;
mod heat;
mod page;
mod scale_bar;
mod space;
mod style;
mod text;

use parry3d::math::Vec2;

use self::canvas::Number;
use self::page::Section;
use super::wearer::Wearer;
use super::words::{self, List};
use crate::layout::draft::LayoutFault;
use crate::layout::model::{ControlKind, Face, Layout};
use crate::layout::render::front::FrontMark;
use crate::message::escape_markup;

pub use self::canvas::{Canvas, Placement};
pub use self::controls::{draw_fitted, draw_label, draw_outline, label_half, on_page, text_room};
pub use self::heat::{Heat, heat_style};
pub(super) use self::style::{colored, sheet};

/// Blank space around the drawing, in millimetres.
const MARGIN: f32 = 8.0;

/// The minimum width of texts, in millimetres.
const MIN_WIDTH: f32 = 170.0;

/// The maximum number of shapes of a drawing, some 20 MB.
const MAX_SHAPES: usize = 200_000;

/// The scale of a board in a layer beside the base layer.
const LAYER_SCALE: f32 = 0.6;

/// A layout is too large to be drawn.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the drawing of this layout has {shapes} shapes, more than {MAX_SHAPES}; draw a layout with fewer keys or layers"
)]
pub struct TooManyShapes {
    /// Number of shapes and texts.
    shapes: usize,
}

impl Layout {
    /// Returns a drawing at 1 mm per millimetre: the boards from the front, one below the other, layers and chords on small
    /// boards, boards, pointer and targets from above and from the side, and lists of what controls and gestures do.
    pub fn to_svg(&self, wearer: &Wearer) -> Result<String, TooManyShapes> {
        self.check_size()?;
        let sections = sections(self, wearer);
        let width = text_width(self);
        let page = page::compose(&self.name, &self.description, &sections, width);
        match page.shapes() {
            shapes if shapes > MAX_SHAPES => Err(TooManyShapes { shapes }),
            _ => Ok(document(&self.name, &page, &sheet())),
        }
    }

    /// Returns the error of a layout whose layers alone have too many shapes.
    fn check_size(&self) -> Result<(), TooManyShapes> {
        let faces: usize = self.scene.len() * self.layers.len() * 2;
        let chord_keys = self.keys.iter().map(|key| key.face.target);
        let chord_keys = chord_keys.filter(|target| self.is_chord_key(*target));
        let drawn = self
            .chords
            .iter()
            .flat_map(|chord| chord.actions.iter().flatten());
        let shapes = match drawn.count() {
            0 => faces,
            chords => faces + chords * chord_keys.count().min(12),
        };
        if shapes > MAX_SHAPES {
            Err(TooManyShapes { shapes })
        } else {
            Ok(())
        }
    }
}

/// Returns the marks on a front of a control; `index` is the index of the front.
pub(super) fn front_marks(
    layout: &Layout,
    kind: &ControlKind,
    index: usize,
    is_on: bool,
    face: &Face,
) -> Vec<FrontMark> {
    let mut front = Canvas::default();
    controls::draw_front(layout, kind, index, is_on, face, &mut front);
    front.into_marks()
}

/// Returns the width of texts on a page: the text width of the widest board.
fn text_width(layout: &Layout) -> f32 {
    let boards = layout.boards.iter().map(|board| {
        let (min, max) = layout.extent(board);
        (max.x - min.x) * 1e3
    });
    boards.fold(MIN_WIDTH, f32::max)
}

/// A part of a page in another format.
pub(super) enum Part {
    /// An SVG element, of the boards in one layer or independent of layers.
    Drawing {
        heading: Option<&'static str>,
        layer: Option<usize>,
        svg: String,
    },
    /// Names and descriptions.
    List {
        heading: &'static str,
        rows: Vec<(String, String)>,
    },
}

/// Returns the parts of a page in another format: each board in full size for each layer, the other drawings, and the lists.
pub(super) fn parts(layout: &Layout, wearer: &Wearer) -> Result<Vec<Part>, TooManyShapes> {
    layout.check_size()?;
    let width = text_width(layout);
    let mut parts = Vec::new();
    let drawing = |heading, layer, drawing: &Canvas| Part::Drawing {
        heading,
        layer,
        svg: element(drawing),
    };
    for index in 0..layout.boards.len() {
        let board = board::draw(layout, index, wearer);
        parts.push(drawing(None, Some(0), &board));
        for layer in 1..layout.layers.len() {
            let layer_board = board::draw_layer(layout, index, layer);
            parts.push(drawing(None, Some(layer), &layer_board));
        }
    }
    let (chords, listed) = chords_and_list(layout, width);
    for (layer, drawn) in &chords {
        parts.push(match layer {
            0 => drawing(Some("Chords"), None, drawn),
            layer => drawing(None, Some(*layer), drawn),
        });
    }
    let lists = listed.into_iter().chain(words::lists(layout));
    let lists = faults(wearer).into_iter().chain(lists);
    parts.extend(lists.map(|list| Part::List {
        heading: list.heading,
        rows: list.rows,
    }));
    let space = space::draw(layout, wearer, width);
    parts.extend(space.map(|space| drawing(Some("In space"), None, &space)));
    Ok(parts)
}

fn sections(layout: &Layout, wearer: &Wearer) -> Vec<Section> {
    let width = text_width(layout);
    let mut sections = Vec::new();
    let mut add = |heading, content| sections.push(Section { heading, content });
    for index in 0..layout.boards.len() {
        add(None, board::draw(layout, index, wearer));
    }
    if !layout.boards.is_empty() {
        for layer in 1..layout.layers.len() {
            add(None, board::draw_layer_row(layout, layer, LAYER_SCALE));
        }
    }
    let (chords, listed) = chords_and_list(layout, width);
    for (layer, drawn) in chords {
        add((layer == 0).then_some("Chords"), drawn);
    }
    let lists = listed.into_iter().chain(words::lists(layout));
    for list in faults(wearer).into_iter().chain(lists) {
        add(Some(list.heading), page::draw_list(&list.rows, width));
    }
    if let Some(space) = space::draw(layout, wearer, width) {
        add(Some("In space"), space);
    }
    sections
}

/// Returns the faults of a layout that cannot be used, by line.
fn faults(wearer: &Wearer) -> Option<List> {
    let row = |fault: &LayoutFault| {
        let line = fault.fault.line();
        let line = line.map_or(String::new(), |line| format!("line {line}"));
        (line, fault.fault.message().to_owned())
    };
    let rows: Vec<_> = wearer.faults.iter().map(row).collect();
    (!rows.is_empty()).then_some(List {
        heading: "Problems: the layout cannot be used",
        rows,
    })
}

/// Returns the chords of each layer that has some on small boards, or as a list if they have too many keys to tell apart.
fn chords_and_list(layout: &Layout, width: f32) -> (Vec<(usize, Canvas)>, Option<List>) {
    let layers = 0..layout.layers.len();
    let drawn = layers
        .clone()
        .filter_map(|layer| Some((layer, chords::draw(layout, layer, width)?)));
    let drawn: Vec<_> = drawn.collect();
    let rows = layers.flat_map(|layer| {
        let words = words::chords(layout, layer).into_iter();
        words.map(move |words| match layer {
            0 => (words.keys, words.action),
            _ => (
                format!("{}: {}", layout.layers[layer], words.keys),
                words.action,
            ),
        })
    });
    let list = List {
        heading: "Chords",
        rows: rows.collect(),
    };
    let list = (drawn.is_empty() && !list.rows.is_empty()).then_some(list);
    (drawn, list)
}

/// Returns a drawing as an SVG element without a style sheet.
fn element(drawing: &Canvas) -> String {
    let (min, max) = drawing.bounds();
    let (min, size) = (min - 0.5, max - min + 1.0);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}mm\" height=\"{1}mm\" viewBox=\"{2} {3} {0} {1}\">\n{4}</svg>\n",
        Number(size.x),
        Number(size.y),
        Number(min.x),
        Number(min.y),
        drawing.elements()
    )
}

/// Returns a whole SVG document around a drawing, with a style sheet.
fn document(name: &str, drawing: &Canvas, style: &str) -> String {
    let (min, max) = drawing.bounds();
    let size = max - min + 2.0 * MARGIN;
    let (width, height) = (Number(size.x), Number(size.y));
    let mut page = Canvas::default();
    page.group(Placement::at(Vec2::splat(MARGIN) - min), None, drawing);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}mm\" height=\"{height}mm\" viewBox=\"0 0 {width} {height}\">\n\
         <title>{}</title>\n<style>\n{style}</style>\n\
         <rect class=\"ground\" width=\"100%\" height=\"100%\"/>\n{}</svg>\n",
        escape_markup(name),
        page.elements()
    )
}
