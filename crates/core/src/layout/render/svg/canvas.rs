//! SVG elements, and the rectangle that they cover.

use std::fmt::{self, Write};

use parry3d::math::Vec2;

use super::text::{HALF_CAPITAL_HEIGHT, width_em};
use crate::layout::render::front::{FrontMark, MarkRole, MarkShape};
use crate::message::escape_markup;

/// The distance of a stroke beyond the outline that it is drawn along, in millimetres.
const STROKE_PADDING: f32 = 0.4;

/// SVG elements in millimetres, x to the right and y down, and the rectangle that they cover.
///
/// A number that is not finite is written as 0 and does not widen the rectangle.
#[derive(Clone, Debug, Default)]
pub struct Canvas {
    elements: String,
    bounds: Option<(Vec2, Vec2)>,
    shapes: usize,
    /// The drawing on a front, y down.
    marks: Vec<FrontMark>,
}

/// A position in millimetres, a clockwise rotation in degrees, and a scale.
#[derive(Clone, Copy, Debug)]
pub struct Placement {
    pub at: Vec2,
    pub degrees: f32,
    pub scale: f32,
}

/// The horizontal relation between a text and its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    Start,
    Middle,
    End,
}

impl Placement {
    /// Returns the placement at a position, neither rotated nor scaled.
    pub fn at(at: Vec2) -> Self {
        Self {
            at,
            degrees: 0.0,
            scale: 1.0,
        }
    }

    fn apply(&self, point: Vec2) -> Vec2 {
        self.at + Vec2::from_angle(self.degrees.to_radians()).rotate(point) * self.scale
    }
}

impl Canvas {
    /// Returns the elements as text.
    pub fn elements(&self) -> &str {
        &self.elements
    }

    /// Returns what was drawn as marks, y up.
    pub fn into_marks(mut self) -> Vec<FrontMark> {
        let up = |point: Vec2| Vec2::new(point.x, -point.y);
        self.map_marks(&up, -1.0, 0.0);
        self.marks
    }

    /// Maps the points of all marks, mirrors their rotations if `sign` is −1, and turns them.
    fn map_marks(&mut self, map: &dyn Fn(Vec2) -> Vec2, sign: f32, turn: f32) {
        for mark in &mut self.marks {
            match &mut mark.shape {
                MarkShape::Disc { center, .. } => *center = map(*center),
                MarkShape::Box {
                    center, rotation, ..
                }
                | MarkShape::Text {
                    center, rotation, ..
                } => {
                    *center = map(*center);
                    *rotation = sign * *rotation + turn;
                }
                MarkShape::Polygon(points) | MarkShape::Line(points, _) => {
                    for point in points {
                        *point = map(*point);
                    }
                }
            }
        }
    }

    fn mark(&mut self, class: &str, shape: MarkShape) {
        // Everything else is not on a front.
        if let Some(role) = role(class) {
            self.marks.push(FrontMark { role, shape });
        }
    }

    /// Returns the number of shapes and texts.
    pub fn shapes(&self) -> usize {
        self.shapes
    }

    /// Returns the corners of the covered rectangle, both at the origin if nothing was drawn.
    pub fn bounds(&self) -> (Vec2, Vec2) {
        self.bounds.unwrap_or_default()
    }

    /// Returns the width and the height of the covered rectangle.
    pub fn size(&self) -> Vec2 {
        let (min, max) = self.bounds();
        max - min
    }

    /// Widens the covered rectangle to contain a rectangle around `center`.
    pub fn cover(&mut self, center: Vec2, half: Vec2) {
        if !center.is_finite() || !half.is_finite() {
            return;
        }
        let (min, max) = (center - half, center + half);
        self.bounds = Some(match self.bounds {
            Some((low, high)) => (low.min(min), high.max(max)),
            None => (min, max),
        });
    }

    /// Draws a rectangle with rounded corners.
    pub fn rect(&mut self, class: &str, center: Vec2, half: Vec2, radius: f32) {
        self.cover(center, half + STROKE_PADDING);
        let shape = MarkShape::Box {
            center,
            half,
            radius: radius.min(half.min_element()),
            rotation: 0.0,
        };
        self.mark(class, shape);
        let corner = center - half;
        self.shape(format_args!(
            r#"<rect class="{class}" x="{}" y="{}" width="{}" height="{}" rx="{}"/>"#,
            Number(corner.x),
            Number(corner.y),
            Number(2.0 * half.x),
            Number(2.0 * half.y),
            Number(radius.min(half.min_element()))
        ));
    }

    /// Draws a circle.
    pub fn circle(&mut self, class: &str, center: Vec2, radius: f32) {
        self.cover(center, Vec2::splat(radius + STROKE_PADDING));
        let shape = MarkShape::Disc {
            center,
            radius,
            is_hollow: stroke_width(class).is_some(),
        };
        self.mark(class, shape);
        self.shape(format_args!(
            r#"<circle class="{class}" cx="{}" cy="{}" r="{}"/>"#,
            Number(center.x),
            Number(center.y),
            Number(radius)
        ));
    }

    /// Draws a line between two points.
    pub fn line(&mut self, class: &str, [from, to]: [Vec2; 2]) {
        for end in [from, to] {
            self.cover(end, Vec2::splat(STROKE_PADDING));
        }
        let width = stroke_width(class).unwrap_or(STROKE_PADDING);
        self.mark(class, MarkShape::Line(vec![from, to], width));
        self.shape(format_args!(
            r#"<line class="{class}" x1="{}" y1="{}" x2="{}" y2="{}"/>"#,
            Number(from.x),
            Number(from.y),
            Number(to.x),
            Number(to.y)
        ));
    }

    /// Draws connected lines that end at the last point.
    pub fn polyline(&mut self, class: &str, points: &[Vec2]) {
        self.points("polyline", class, points);
    }

    /// Draws a polygon.
    pub fn polygon(&mut self, class: &str, points: &[Vec2]) {
        self.points("polygon", class, points);
    }

    fn points(&mut self, element: &str, class: &str, points: &[Vec2]) {
        for point in points {
            self.cover(*point, Vec2::splat(STROKE_PADDING));
        }
        let shape = match stroke_width(class) {
            Some(width) => MarkShape::Line(points.to_vec(), width),
            None => MarkShape::Polygon(points.to_vec()),
        };
        self.mark(class, shape);
        let points: Vec<String> = points.iter().map(point).collect();
        self.shape(format_args!(
            r#"<{element} class="{class}" points="{}"/>"#,
            points.join(" ")
        ));
    }

    /// Draws closed outlines, of which every second one inside another is a hole.
    pub fn outlines<'a>(&mut self, class: &str, outlines: impl IntoIterator<Item = &'a [Vec2]>) {
        let mut path = String::new();
        for outline in outlines {
            for corner in outline {
                self.cover(*corner, Vec2::splat(STROKE_PADDING));
            }
            let corners: Vec<String> = outline.iter().map(point).collect();
            path += &format!("M{}Z", corners.join("L"));
        }
        self.shape(format_args!(
            r#"<path class="{class}" fill-rule="evenodd" d="{path}"/>"#
        ));
    }

    /// Draws an arc of a circle between two angles in radians, clockwise from the right.
    pub fn arc(&mut self, class: &str, center: Vec2, radius: f32, [from, to]: [f32; 2]) {
        /// The largest angle between two points, in radians: the error is below a thousandth of the radius.
        const STEP: f32 = 0.08;
        let count = ((to - from).abs() / STEP).ceil().clamp(1.0, 100.0) as usize;
        let at = |index: usize| from + (to - from) * index as f32 / count as f32;
        let points: Vec<Vec2> = (0..=count)
            .map(|index| center + Vec2::from_angle(at(index)) * radius)
            .collect();
        self.polyline(class, &points);
    }

    /// Writes a line of text, vertically centered at a position.
    pub fn text(&mut self, class: &str, at: Vec2, align: Align, size: f32, text: &str) {
        let width = size * width_em(text);
        let (anchor, center) = match align {
            Align::Start => ("", at.x + width / 2.0),
            Align::Middle => (r#" text-anchor="middle""#, at.x),
            Align::End => (r#" text-anchor="end""#, at.x - width / 2.0),
        };
        self.cover(Vec2::new(center, at.y), Vec2::new(width, size * 1.2) / 2.0);
        let shape = MarkShape::Text {
            center: Vec2::new(center, at.y),
            size,
            rotation: 0.0,
            text: text.to_owned(),
        };
        self.mark(class, shape);
        self.shape(format_args!(
            r#"<text class="{class}" x="{}" y="{}" font-size="{}"{anchor}>{}</text>"#,
            Number(at.x),
            Number(at.y + size * HALF_CAPITAL_HEIGHT),
            Number(size),
            escape_markup(text)
        ));
    }

    /// Adds a drawing at a placement, with a name that programs show as a tooltip and read aloud.
    pub fn group(&mut self, placement: Placement, name: Option<&str>, drawing: &Self) {
        let (min, max) = drawing.bounds();
        for corner in [min, max, Vec2::new(min.x, max.y), Vec2::new(max.x, min.y)] {
            if drawing.bounds.is_some() {
                self.cover(placement.apply(corner), Vec2::ZERO);
            }
        }
        let Placement { at, degrees, scale } = placement;
        let mut transform = format!("translate({} {})", Number(at.x), Number(at.y));
        if degrees != 0.0 {
            transform += &format!(" rotate({})", Number(degrees));
        }
        if scale != 1.0 {
            transform += &format!(" scale({})", Number(scale));
        }
        self.push(format_args!("<g transform=\"{transform}\">"));
        if let Some(name) = name {
            self.push(format_args!("<title>{}</title>", escape_markup(name)));
        }
        let mut inner = Self {
            marks: drawing.marks.clone(),
            ..Self::default()
        };
        inner.map_marks(
            &|point| placement.apply(point),
            1.0,
            placement.degrees.to_radians(),
        );
        self.marks.append(&mut inner.marks);
        self.elements += &drawing.elements;
        self.elements += "</g>\n";
        self.shapes += drawing.shapes;
    }

    fn shape(&mut self, element: fmt::Arguments) {
        self.shapes += 1;
        self.push(element);
        self.elements.push('\n');
    }

    fn push(&mut self, element: fmt::Arguments) {
        self.elements
            .write_fmt(element)
            .expect("writing to a string does not fail");
    }
}

/// Returns the role of a class of the style sheet on a front; `None` for what is not on one.
fn role(class: &str) -> Option<MarkRole> {
    Some(match class {
        "well" | "skirt" => MarkRole::Well,
        "groove" | "slot" => MarkRole::Groove,
        "metal" | "spoke" => MarkRole::Handle,
        "cap" => MarkRole::Cap,
        "on-metal" => MarkRole::OnHandle,
        "mark" | "lit" => MarkRole::Value,
        "tick" | "range" | "icon" => MarkRole::Scale,
        "label" => MarkRole::Label,
        "muted" => MarkRole::Note,
        _ => return None,
    })
}

/// Returns the width of the strokes of a class that is not filled, in millimetres, as in the style sheet.
fn stroke_width(class: &str) -> Option<f32> {
    Some(match class {
        "spoke" => 1.6,
        "mark" => 1.2,
        "on-metal" => 0.7,
        "range" | "icon" => 0.5,
        "tick" => 0.3,
        _ => return None,
    })
}

fn point(point: &Vec2) -> String {
    format!("{},{}", Number(point.x), Number(point.y))
}

/// A number with at most two digits after the point. One that is not finite is 0.
pub struct Number(pub f32);

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let number = if self.0.is_finite() { self.0 } else { 0.0 };
        let text = format!("{number:.2}");
        let text = text.trim_end_matches('0').trim_end_matches('.');
        f.write_str(if text == "-0" { "0" } else { text })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_finite() {
        let numbers = [1.0, -0.001, 12.345, 0.5, f32::NAN, f32::INFINITY, -100.0];
        let texts = numbers.map(|number| Number(number).to_string());
        assert_eq!(texts, ["1", "0", "12.35", "0.5", "0", "0", "-100"]);
    }

    #[test]
    fn a_group_covers_what_it_contains() {
        let mut inner = Canvas::default();
        inner.rect("a", Vec2::new(10.0, 0.0), Vec2::new(9.6, 4.6), 1.0);
        let mut outer = Canvas::default();
        let placement = Placement {
            at: Vec2::new(100.0, 50.0),
            degrees: 90.0,
            scale: 2.0,
        };
        outer.group(placement, Some("<&>"), &inner);
        let (min, max) = outer.bounds();
        assert!((min - Vec2::new(90.0, 50.0)).length() < 1e-3, "{min}");
        assert!((max - Vec2::new(110.0, 90.0)).length() < 1e-3, "{max}");
        assert!(outer.elements().contains("<title>&lt;&amp;&gt;</title>"));
    }

    #[test]
    fn what_is_not_finite_covers_nothing() {
        let mut canvas = Canvas::default();
        canvas.circle("a", Vec2::NAN, 1.0);
        canvas.line("a", [Vec2::ZERO, Vec2::splat(f32::INFINITY)]);
        assert!(canvas.size().max_element() < 1.0);
        assert!(!canvas.elements().contains("NaN") && !canvas.elements().contains("inf"));
    }
}
