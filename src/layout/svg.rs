//! A layout as a picture, in SVG.

use std::fmt::{self, Write};

use parry3d::math::Vec2;

use super::model::{Board, Face, Layout};
use crate::contact::surface::Shape;

/// White space around the boards and between them, in millimetres.
const MARGIN: f32 = 6.0;

/// The largest letters on a key, in millimetres.
const LETTERS: f32 = 6.0;

/// Half the height of a capital as a share of the letters' size: puts a label in the middle of its
/// key also where `dominant-baseline` is not known.
const HALF_CAPITAL: f32 = 0.36;

const STYLE: &str = "\
.ground{fill:#fff}\
.key{fill:#f3f4f6;stroke:#4b5563;stroke-width:.4}\
.label{fill:#111827;text-anchor:middle}\
.layer{fill:#2563eb;text-anchor:end;font-size:3.2px}\
text{font-family:'DejaVu Sans',sans-serif}";

impl Layout {
    /// The boards as seen from their fronts, rows along arcs bent as they are, one board below the
    /// other, at 1 mm to a millimetre. Each key shows its label and, small, its labels in the other layers.
    pub fn to_svg(&self) -> String {
        let mut svg = String::new();
        self.write_svg(&mut svg).expect("a string takes any text");
        svg
    }

    fn write_svg(&self, svg: &mut String) -> fmt::Result {
        let bounds: Vec<(Vec2, Vec2)> = self.boards.iter().map(|it| self.bounds(it)).collect();
        let widest = bounds
            .iter()
            .map(|(low, high)| high.x - low.x)
            .fold(0.0, f32::max);
        let heights: f32 = bounds
            .iter()
            .map(|(low, high)| high.y - low.y + MARGIN)
            .sum();
        let (width, height) = (widest + 2.0 * MARGIN, heights + MARGIN);
        writeln!(
            svg,
            r#"<svg xmlns="http://www.w3.org/2000/svg" width="{width:.1}mm" height="{height:.1}mm" viewBox="0 0 {width:.1} {height:.1}">"#
        )?;
        writeln!(
            svg,
            "<title>{}</title>\n<style>{STYLE}</style>",
            escaped(&self.name)
        )?;
        writeln!(svg, r#"<rect class="ground" width="100%" height="100%"/>"#)?;
        let mut top = MARGIN;
        for (board, (low, high)) in self.boards.iter().zip(bounds) {
            let left = MARGIN + (widest - (high.x - low.x)) / 2.0 - low.x;
            writeln!(
                svg,
                r#"<g transform="translate({left:.2} {:.2})">"#,
                top + high.y
            )?;
            for front in self.faces(board) {
                self.write_front(svg, front)?;
            }
            writeln!(svg, "</g>")?;
            top += high.y - low.y + MARGIN;
        }
        writeln!(svg, "</svg>")
    }

    /// The corners of the rectangle around what is on a board, in millimetres.
    fn bounds(&self, board: &Board) -> (Vec2, Vec2) {
        let outlines = || self.faces(board).map(|front| front.outline);
        let low = outlines()
            .map(|it| it.center - it.aabb_half_extents())
            .reduce(Vec2::min);
        let high = outlines()
            .map(|it| it.center + it.aabb_half_extents())
            .reduce(Vec2::max);
        (
            low.unwrap_or_default() * 1e3,
            high.unwrap_or_default() * 1e3,
        )
    }

    fn write_front(&self, svg: &mut String, front: &Face) -> fmt::Result {
        let middle = front.outline.center * 1e3;
        let half = front.outline.half_extents() * 1e3;
        // A difference, as a negated 0 would be drawn as −0.
        let degrees = 0.0 - front.outline.rotation.to_degrees();
        write!(
            svg,
            r#"<g transform="translate({:.2} {:.2}) rotate({degrees:.2})"><title>{}</title>"#,
            middle.x,
            -middle.y,
            escaped(&front.name)
        )?;
        match front.outline.shape {
            Shape::Disc(_) => write!(svg, r#"<circle class="key" r="{:.2}"/>"#, half.x)?,
            Shape::Box(_) => write!(
                svg,
                r#"<rect class="key" x="{:.2}" y="{:.2}" width="{:.2}" height="{:.2}" rx="{:.2}"/>"#,
                -half.x,
                -half.y,
                2.0 * half.x,
                2.0 * half.y,
                half.min_element().min(2.0)
            )?,
        }
        let letters = (2.6 * half.x / front.label.chars().count() as f32)
            .min(half.y)
            .min(LETTERS);
        write!(
            svg,
            r#"<text class="label" y="{:.2}" font-size="{letters:.2}">{}</text>"#,
            letters * HALF_CAPITAL,
            escaped(&front.label)
        )?;
        let key = self.key_at(front.target);
        let layers: Vec<&str> = (1..self.layers.len())
            .filter_map(|layer| self.label_in_layer(key?, layer))
            .collect();
        if !layers.is_empty() {
            write!(
                svg,
                r#"<text class="layer" x="{:.2}" y="{:.2}">{}</text>"#,
                half.x - 1.2,
                3.8 - half.y,
                escaped(&layers.join(" "))
            )?;
        }
        writeln!(svg, "</g>")
    }
}

/// As text between tags or in quotes; what XML cannot carry becomes U+FFFD.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\u{fffe}' | '\u{ffff}' => escaped.push(char::REPLACEMENT_CHARACTER),
            other => escaped.push(other),
        }
    }
    escaped
}
