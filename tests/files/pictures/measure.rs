//! The areas that elements of an SVG document cover.

use parry3d::math::{Mat2, Vec2};
use roxmltree::Node;

/// A rectangle in millimetres.
#[derive(Clone, Copy, Debug)]
pub struct Rect {
    pub min: Vec2,
    pub max: Vec2,
}

/// An element and the rectangle around it, in the frame of the element that was asked for.
pub struct Measured {
    pub what: String,
    pub area: Rect,
}

#[derive(Clone, Copy)]
struct Transform {
    linear: Mat2,
    offset: Vec2,
}

impl Rect {
    /// Allows for rounding to a hundredth of a millimetre.
    pub fn contains(&self, other: &Self) -> bool {
        let tolerance = Vec2::splat(0.05);
        (self.min - tolerance).cmple(other.min).all() && other.max.cmple(self.max + tolerance).all()
    }
}

/// Returns the shapes and texts below a node. A letter is taken to be 0.5 of the font size wide, and 0.8 high.
pub fn measure(node: Node) -> Vec<Measured> {
    let mut measured = Vec::new();
    let identity = Transform {
        linear: Mat2::IDENTITY,
        offset: Vec2::ZERO,
    };
    visit(node, identity, &mut measured);
    measured
}

fn visit(node: Node, parent: Transform, measured: &mut Vec<Measured>) {
    let transform = match node.attribute("transform") {
        Some(text) => parent.then(text),
        None => parent,
    };
    if let Some(corners) = corners(node) {
        let corners = corners
            .into_iter()
            .map(|corner| transform.linear * corner + transform.offset);
        let (min, max) = corners.fold((Vec2::MAX, Vec2::MIN), |(min, max), corner| {
            (min.min(corner), max.max(corner))
        });
        measured.push(Measured {
            what: format!(
                "{} {}",
                node.tag_name().name(),
                node.text().unwrap_or_default()
            ),
            area: Rect { min, max },
        });
    }
    for child in node.children() {
        visit(child, transform, measured);
    }
}

impl Transform {
    /// Applies `translate(x y) rotate(degrees) scale(factor)`.
    fn then(self, text: &str) -> Self {
        let mut result = self;
        for part in text.split(')').filter(|part| !part.is_empty()) {
            let (name, numbers) = part.trim().split_once('(').unwrap();
            let numbers: Vec<f32> = numbers.split(' ').map(|it| it.parse().unwrap()).collect();
            match name {
                "translate" => result.offset += result.linear * Vec2::new(numbers[0], numbers[1]),
                "rotate" => result.linear *= Mat2::from_angle(numbers[0].to_radians()),
                "scale" => result.linear *= Mat2::from_diagonal(Vec2::splat(numbers[0])),
                other => panic!("transform {other}"),
            }
        }
        result
    }
}

/// Returns points around an element in its own frame; `None` for one that draws nothing of known size.
fn corners(node: Node) -> Option<Vec<Vec2>> {
    let number = |name: &str| node.attribute(name)?.parse::<f32>().ok();
    let around =
        |min: Vec2, max: Vec2| vec![min, max, Vec2::new(min.x, max.y), Vec2::new(max.x, min.y)];
    Some(match node.tag_name().name() {
        "rect" => {
            let min = Vec2::new(number("x")?, number("y")?);
            around(min, min + Vec2::new(number("width")?, number("height")?))
        }
        "circle" => {
            let center = Vec2::new(number("cx")?, number("cy")?);
            let radius = Vec2::splat(number("r")?);
            around(center - radius, center + radius)
        }
        "line" => vec![
            Vec2::new(number("x1")?, number("y1")?),
            Vec2::new(number("x2")?, number("y2")?),
        ],
        "polyline" | "polygon" => points(node.attribute("points")?, ' '),
        "path" => points(node.attribute("d")?, 'L'),
        "text" => {
            let size = number("font-size")?;
            let width = size * 0.5 * node.text()?.chars().count() as f32;
            let left = match node.attribute("text-anchor") {
                None => 0.0,
                Some("middle") => -width / 2.0,
                Some(_) => -width,
            };
            let baseline = Vec2::new(number("x")? + left, number("y")?);
            around(baseline - Vec2::Y * 0.8 * size, baseline + Vec2::X * width)
        }
        _ => return None,
    })
}

fn points(text: &str, separator: char) -> Vec<Vec2> {
    let text = text.replace(['M', 'Z'], &separator.to_string());
    let points = text.split(separator).filter(|point| !point.is_empty());
    points
        .map(|point| {
            let (x, y) = point.split_once(',').unwrap();
            Vec2::new(x.parse().unwrap(), y.parse().unwrap())
        })
        .collect()
}
