//! Drawings in SVG.

use std::fmt::{self, Write};

use parry3d::math::Vec2;

use crate::contact::surface::Shape;
use crate::layout::model::{Board, Face, Layout};

/// Blank space around and between the boards, in millimetres.
const MARGIN_MM: f32 = 6.0;

/// The maximum font size of a label, in millimetres.
const MAX_FONT_SIZE_MM: f32 = 6.0;

/// Half the height of a capital letter as a fraction of the font size. Centers a label without `dominant-baseline`, which
/// some viewers do not support.
const HALF_CAPITAL_HEIGHT: f32 = 0.36;

const STYLE: &str = "\
.ground{fill:#fff}\
.key{fill:#f3f4f6;stroke:#4b5563;stroke-width:.4}\
.label{fill:#111827;text-anchor:middle}\
.layer{fill:#2563eb;text-anchor:end;font-size:3.2px}\
text{font-family:'DejaVu Sans',sans-serif}";

impl Layout {
    /// Returns a drawing of the boards as seen from the front, one below the other, at 1 mm per millimetre.
    ///
    /// Rows along arcs are bent. Each key shows its label and, in small type, its labels in the other layers.
    pub fn to_svg(&self) -> String {
        let mut svg = String::new();
        self.write_svg(&mut svg)
            .expect("writing to a string does not fail");
        svg
    }

    fn write_svg(&self, svg: &mut String) -> fmt::Result {
        let bounds: Vec<(Vec2, Vec2)> = self.boards.iter().map(|it| self.bounds_mm(it)).collect();
        let max_width = bounds
            .iter()
            .map(|(min, max)| max.x - min.x)
            .fold(0.0, f32::max);
        let heights: f32 = bounds
            .iter()
            .map(|(min, max)| max.y - min.y + MARGIN_MM)
            .sum();
        let (width, height) = (max_width + 2.0 * MARGIN_MM, heights + MARGIN_MM);
        writeln!(
            svg,
            r#"<svg xmlns="http://www.w3.org/2000/svg" width="{width:.1}mm" height="{height:.1}mm" viewBox="0 0 {width:.1} {height:.1}">"#
        )?;
        writeln!(
            svg,
            "<title>{}</title>\n<style>{STYLE}</style>",
            escape(&self.name)
        )?;
        writeln!(svg, r#"<rect class="ground" width="100%" height="100%"/>"#)?;
        let mut top = MARGIN_MM;
        for (board, (min, max)) in self.boards.iter().zip(bounds) {
            let left = MARGIN_MM + (max_width - (max.x - min.x)) / 2.0 - min.x;
            writeln!(
                svg,
                r#"<g transform="translate({left:.2} {:.2})">"#,
                top + max.y
            )?;
            for face in self.faces(board) {
                self.write_face(svg, face)?;
            }
            writeln!(svg, "</g>")?;
            top += max.y - min.y + MARGIN_MM;
        }
        writeln!(svg, "</svg>")
    }

    /// Returns the corners of the rectangle around the faces of a board, in millimetres.
    fn bounds_mm(&self, board: &Board) -> (Vec2, Vec2) {
        let outlines = || self.faces(board).map(|face| face.outline);
        let min = outlines()
            .map(|outline| outline.center - outline.aabb_half_extents())
            .reduce(Vec2::min);
        let max = outlines()
            .map(|outline| outline.center + outline.aabb_half_extents())
            .reduce(Vec2::max);
        (min.unwrap_or_default() * 1e3, max.unwrap_or_default() * 1e3)
    }

    fn write_face(&self, svg: &mut String, face: &Face) -> fmt::Result {
        let center = face.outline.center * 1e3;
        let half = face.outline.half_extents() * 1e3;
        // A subtraction, because a negated 0 is written as -0.
        let degrees = 0.0 - face.outline.rotation.to_degrees();
        write!(
            svg,
            r#"<g transform="translate({:.2} {:.2}) rotate({degrees:.2})"><title>{}</title>"#,
            center.x,
            -center.y,
            escape(&face.name)
        )?;
        match face.outline.shape {
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
        let font_size = (2.6 * half.x / face.label.chars().count() as f32)
            .min(half.y)
            .min(MAX_FONT_SIZE_MM);
        write!(
            svg,
            r#"<text class="label" y="{:.2}" font-size="{font_size:.2}">{}</text>"#,
            font_size * HALF_CAPITAL_HEIGHT,
            escape(&face.label)
        )?;
        self.write_layers(svg, face, half)?;
        writeln!(svg, "</g>")
    }

    fn write_layers(&self, svg: &mut String, face: &Face, half: Vec2) -> fmt::Result {
        let Some(key) = self.key_at(face.target) else {
            return Ok(());
        };
        let labels: Vec<&str> = (1..self.layers.len())
            .filter_map(|layer| self.label_in_layer(key, layer))
            .collect();
        if labels.is_empty() {
            return Ok(());
        }
        write!(
            svg,
            r#"<text class="layer" x="{:.2}" y="{:.2}">{}</text>"#,
            half.x - 1.2,
            3.8 - half.y,
            escape(&labels.join(" "))
        )
    }
}

/// Escapes a text for use between tags or in quotes. Characters that XML does not allow become U+FFFD.
fn escape(text: &str) -> String {
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
