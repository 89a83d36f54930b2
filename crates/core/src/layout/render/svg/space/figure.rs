//! Figures in space and their projections.

use parry3d::math::{Vec2, Vec3};

use crate::layout::render::svg::canvas::{Align, Canvas};
use crate::layout::render::svg::text::width_em;

/// The font size of labels, in millimetres.
pub const LABEL_SIZE: f32 = 2.7;

/// The number of corners of a disc.
const DISC_CORNERS: usize = 24;

/// A direction of view on the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    /// From above: +X to the right, −Z up the page.
    Above,
    /// From the right: −Z to the right, +Y up the page.
    Right,
    /// From the wearer: +X to the right, +Y up the page.
    Wearer,
}

/// A shape in space, in metres.
#[derive(Clone, Debug)]
pub enum Figure {
    /// A flat polygon.
    Polygon(Vec<Vec3>),
    /// Connected lines.
    Line(Vec<Vec3>),
    /// Connected lines that are drawn from above only.
    LineFromAbove(Vec<Vec3>),
    /// The solid between its corners, which is convex.
    Solid(Vec<Vec3>),
    /// A ball: center and radius.
    Ball(Vec3, f32),
    /// Polygons in a plane, of which every second one inside another is a hole. Drawn from above only.
    Area(Vec<Vec<Vec3>>),
}

/// A text beside a point in space.
#[derive(Clone, Debug)]
pub struct Note {
    /// The point.
    pub at: Vec3,
    /// Text.
    pub text: String,
    /// The distance from the point to the middle of the text on the page, in millimetres.
    pub offset: Vec2,
    /// The views with the text.
    pub views: &'static [View],
}

/// Figures with the class of each, and their notes.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    pub figures: Vec<(&'static str, Figure)>,
    pub notes: Vec<Note>,
}

/// All views.
pub const ALL: &[View] = &[View::Above, View::Right, View::Wearer];

impl View {
    /// Returns the name below the view.
    pub fn name(self) -> &'static str {
        match self {
            Self::Above => "from above",
            Self::Right => "from the right",
            Self::Wearer => "from the wearer",
        }
    }

    /// Returns the position on the page, in millimetres at full size.
    fn project(self, point: Vec3) -> Vec2 {
        1e3 * match self {
            Self::Above => Vec2::new(point.x, point.z),
            Self::Right => Vec2::new(-point.z, -point.y),
            Self::Wearer => Vec2::new(point.x, -point.y),
        }
    }
}

impl Scene {
    /// Returns the width and the height of a view without notes, in millimetres at full size.
    pub fn size(&self, view: View) -> Vec2 {
        let mut extent = Canvas::default();
        for (_, figure) in &self.figures {
            match figure {
                Figure::Ball(center, radius) => {
                    extent.cover(view.project(*center), Vec2::splat(radius * 1e3));
                }
                figure => {
                    for corner in figure.corners() {
                        extent.cover(view.project(corner), Vec2::ZERO);
                    }
                }
            }
        }
        extent.size()
    }

    /// Draws a view.
    pub fn draw(&self, view: View, scale: f32) -> Canvas {
        let mut canvas = Canvas::default();
        let project = |point: Vec3| view.project(point) * scale;
        let all = |points: &[Vec3]| points.iter().copied().map(project).collect::<Vec<_>>();
        for (class, figure) in &self.figures {
            match figure {
                Figure::Polygon(corners) => canvas.polygon(class, &all(corners)),
                Figure::Line(points) => canvas.polyline(class, &all(points)),
                Figure::Solid(corners) => canvas.polygon(class, &convex_hull(all(corners))),
                Figure::Ball(center, radius) => {
                    canvas.circle(class, project(*center), radius * 1e3 * scale);
                }
                Figure::Area(outlines) if view == View::Above => {
                    let outlines: Vec<Vec<Vec2>> = outlines.iter().map(|it| all(it)).collect();
                    canvas.outlines(class, outlines.iter().map(Vec::as_slice));
                }
                Figure::LineFromAbove(points) if view == View::Above => {
                    canvas.polyline(class, &all(points));
                }
                Figure::Area(_) | Figure::LineFromAbove(_) => {}
            }
        }
        for (at, text) in self.texts(view, scale) {
            canvas.text("label", at, Align::Middle, LABEL_SIZE, &text);
        }
        canvas
    }

    /// Returns the notes of a view. Notes that would be written over each other become one.
    fn texts(&self, view: View, scale: f32) -> Vec<(Vec2, String)> {
        let mut texts: Vec<(Vec2, String)> = Vec::new();
        for note in self.notes.iter().filter(|note| note.views.contains(&view)) {
            let at = view.project(note.at) * scale + note.offset;
            let room = |text: &str| (width_em(text) + width_em(&note.text)) * LABEL_SIZE / 2.0;
            let mut others = texts.iter_mut();
            let over = others.find(|(other, text)| {
                let distance = (*other - at).abs();
                distance.y < LABEL_SIZE && distance.x < room(text)
            });
            match over {
                Some((_, text)) if *text == note.text => {}
                Some((_, text)) => *text += &format!(", {}", note.text),
                None => texts.push((at, note.text.clone())),
            }
        }
        texts
    }
}

impl Figure {
    fn corners(&self) -> Vec<Vec3> {
        match self {
            Self::Polygon(points) | Self::Line(points) | Self::Solid(points) => points.clone(),
            Self::LineFromAbove(points) => points.clone(),
            Self::Area(outlines) => outlines.concat(),
            Self::Ball(center, _) => vec![*center],
        }
    }
}

/// Returns the corners of a disc around the origin.
pub fn disc(radius: f32) -> impl Iterator<Item = Vec2> {
    let turn = std::f32::consts::TAU / DISC_CORNERS as f32;
    (0..DISC_CORNERS).map(move |index| Vec2::from_angle(index as f32 * turn) * radius)
}

/// Returns the corners of the convex hull of points, in order around it (Andrew's monotone chain).
fn convex_hull(mut points: Vec<Vec2>) -> Vec<Vec2> {
    points.retain(|point| point.is_finite());
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let mut hull = half_hull(points.iter().copied());
    hull.extend(half_hull(points.iter().rev().copied()));
    hull
}

/// Returns one side of a hull, without its last corner.
fn half_hull(points: impl Iterator<Item = Vec2>) -> Vec<Vec2> {
    let mut hull: Vec<Vec2> = Vec::new();
    for point in points {
        while let [.., a, b] = hull[..]
            && (b - a).perp_dot(point - b) <= 0.0
        {
            hull.pop();
        }
        hull.push(point);
    }
    hull.pop();
    hull
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hull_has_the_outer_corners_only() {
        let square = [
            (0.0, 0.0),
            (2.0, 0.0),
            (2.0, 2.0),
            (0.0, 2.0),
            (1.0, 1.0),
            (1.0, 0.0),
        ];
        let hull = convex_hull(square.map(|(x, y)| Vec2::new(x, y)).to_vec());
        assert_eq!(hull.len(), 4, "{hull:?}");
        assert_eq!(convex_hull(vec![Vec2::ZERO; 3]), [Vec2::ZERO]);
        assert_eq!(convex_hull(vec![Vec2::NAN, Vec2::ONE, Vec2::ZERO]).len(), 2);
    }

    #[test]
    fn ahead_is_up_from_above_and_to_the_right_from_the_right() {
        let ahead = Vec3::new(0.0, 0.0, -0.1);
        assert_eq!(View::Above.project(ahead), Vec2::new(0.0, -100.0));
        assert_eq!(View::Right.project(ahead), Vec2::new(100.0, 0.0));
        let up = Vec3::new(0.0, 0.1, 0.0);
        assert_eq!(View::Wearer.project(up), Vec2::new(0.0, -100.0));
    }
}
