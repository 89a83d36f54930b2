//! A picture on the screen: colored triangles and labels, before any window toolkit.

use std::f32::consts::{PI, TAU};

use parry3d::math::Vec2;

/// A color: red, green, blue, opacity; not premultiplied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Color(pub [u8; 4]);

#[cfg(test)]
impl Color {
    /// Returns the contrast to another color, as the Web Content Accessibility Guidelines 2.2 define it: 1..=21.
    pub fn contrast(self, other: Self) -> f32 {
        let (a, b) = (self.luminance(), other.luminance());
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    fn luminance(self) -> f32 {
        let linear = |value: u8| match f32::from(value) / 255.0 {
            value if value <= 0.04045 => value / 12.92,
            value => ((value + 0.055) / 1.055).powf(2.4),
        };
        let [red, green, blue, _] = self.0;
        0.2126 * linear(red) + 0.7152 * linear(green) + 0.0722 * linear(blue)
    }
}

impl Color {
    /// Creates an opaque color.
    pub const fn rgb(red: u8, green: u8, blue: u8) -> Self {
        Self([red, green, blue, 255])
    }

    /// Returns the color with another opacity, 0..=1.
    #[must_use]
    pub fn with_opacity(self, opacity: f32) -> Self {
        let [red, green, blue, _] = self.0;
        Self([red, green, blue, (opacity.clamp(0.0, 1.0) * 255.0) as u8])
    }

    /// Returns the color at `t` between this one (0) and another (1).
    #[must_use]
    pub fn mix(self, other: Self, t: f32) -> Self {
        let t = t.clamp(0.0, 1.0);
        let mut mixed = self.0;
        for (own, channel) in mixed.iter_mut().zip(other.0) {
            *own = (f32::from(*own) * (1.0 - t) + f32::from(channel) * t).round() as u8;
        }
        Self(mixed)
    }
}

/// A word on the picture, in perspective.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// The middle of the word, in points.
    pub position: Vec2,
    /// The direction of the text, as long as a letter is high.
    pub right: Vec2,
    /// The direction from the top of a letter to its bottom, as long as a letter is high.
    pub down: Vec2,
    /// The color.
    pub color: Color,
    /// The word.
    pub text: String,
}

/// Triangles in the order in which they are drawn.
#[derive(Clone, Debug, Default)]
pub struct Triangles {
    /// Corners: position in points, and color.
    pub vertices: Vec<(Vec2, Color)>,
    /// Indices of the corners, three for each triangle.
    pub indices: Vec<u32>,
}

/// An image on the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// The upper left and the lower right corner, in points.
    pub corners: [Vec2; 2],
    /// Width and height, in pixels.
    pub size: [usize; 2],
    /// The pixels, row by row from the top.
    pub pixels: Vec<Color>,
}

/// A picture, in layers from below to above.
#[derive(Clone, Debug, Default)]
pub struct Picture {
    /// Boards and targets in space.
    pub below: Triangles,
    /// Labels of keys and controls.
    pub labels: Vec<Label>,
    /// Hands.
    pub skin: Option<Image>,
    /// Bones, and what is edited.
    pub above: Triangles,
    /// Rings, trails and cursors.
    pub marks: Triangles,
}

/// The largest number of labels of a picture of which those below a shape are looked for: with more, the keys are too small for it to
/// matter.
const MAX_HIDDEN: usize = 1000;

/// The part of a letter, as a multiple of its height, by which a label reaches to both sides at least.
const LETTER_REACH: f32 = 0.15;

impl Picture {
    /// Removes the labels that a convex shape hides, which is added next: all labels are drawn above all shapes.
    pub fn hide_labels(&mut self, outline: &[Vec2]) {
        let low = outline.iter().copied().reduce(Vec2::min);
        let high = outline.iter().copied().reduce(Vec2::max);
        let (Some(low), Some(high)) = (low, high) else {
            return;
        };
        if self.labels.len() > MAX_HIDDEN {
            return;
        }
        let is_hidden =
            |at: Vec2| at.cmpge(low).all() && at.cmple(high).all() && is_inside(outline, at);
        self.labels.retain(|label| {
            // Most labels are far away, and a text has no more letters than bytes.
            let farthest = label.right.abs() * (LETTER_REACH * label.text.len() as f32);
            let [from, to] = [label.position - farthest, label.position + farthest];
            if !(from.cmple(high).all() && to.cmpge(low).all()) {
                return true;
            }
            let reach = label.right * (LETTER_REACH * label.text.chars().count() as f32);
            let points = [-reach, Vec2::ZERO, reach].map(|offset| label.position + offset);
            !points.into_iter().any(is_hidden)
        });
    }
}

/// Returns `true` if a point is inside a convex outline.
fn is_inside(outline: &[Vec2], at: Vec2) -> bool {
    let (mut is_left, mut is_right) = (false, false);
    for (index, &from) in outline.iter().enumerate() {
        let to = outline[(index + 1) % outline.len()];
        let turn = (to - from).perp_dot(at - from);
        is_left |= turn > 0.0;
        is_right |= turn < 0.0;
    }
    is_left != is_right
}

/// Width of the soft edge of a shape, in points.
const FEATHER: f32 = 1.0;

/// Lines of half a circle at the end of a capsule.
const ARC_STEPS: usize = 12;

/// The longest side of a disc or ring, in points, and the range of the number of its sides.
const DISC_SIDE: f32 = 3.0;
const DISC_SIDES: (usize, usize) = (24, 128);

impl Triangles {
    /// Adds a convex polygon with soft edges; each corner has a color.
    pub fn add_polygon(&mut self, corners: &[(Vec2, Color)]) {
        let count = corners.len() as u32;
        if count < 3 {
            return;
        }
        let center = corners.iter().map(|(at, _)| *at).sum::<Vec2>() / count as f32;
        let first = self.vertices.len() as u32;
        for &(at, color) in corners {
            let out = (at - center).normalize_or_zero() * FEATHER;
            self.vertices.push((at, color));
            self.vertices.push((at + out, color.with_opacity(0.0)));
        }
        let inner = |index: u32| first + 2 * (index % count);
        for index in 1..count - 1 {
            self.indices.extend([first, inner(index), inner(index + 1)]);
        }
        for index in 0..count {
            let (a, b) = (inner(index), inner(index + 1));
            self.indices.extend([a, b, b + 1, a, b + 1, a + 1]);
        }
    }

    /// Adds a convex polygon of one color.
    pub fn add_flat_polygon(&mut self, corners: &[Vec2], color: Color) {
        let corners: Vec<_> = corners.iter().map(|&corner| (corner, color)).collect();
        self.add_polygon(&corners);
    }

    /// Adds a convex polygon of one color without soft edges, which many small shapes do not need.
    pub fn add_plain_polygon(&mut self, corners: &[Vec2], color: Color) {
        let first = self.vertices.len() as u32;
        let vertices = corners.iter().map(|&corner| (corner, color));
        self.vertices.extend(vertices);
        for index in 1..(corners.len() as u32).saturating_sub(1) {
            let triangle = [first, first + index, first + index + 1];
            self.indices.extend(triangle);
        }
    }

    /// Adds a line of this width, with a color at each end.
    pub fn add_line(&mut self, [from, to]: [(Vec2, Color); 2], width: f32) {
        let side = (to.0 - from.0).perp().normalize_or_zero();
        let first = self.vertices.len() as u32;
        for (at, color) in [from, to] {
            let clear = color.with_opacity(0.0);
            let (inner, outer) = (side * width / 2.0, side * (width / 2.0 + FEATHER));
            self.vertices.extend([
                (at + outer, clear),
                (at + inner, color),
                (at - inner, color),
                (at - outer, clear),
            ]);
        }
        for band in 0..3 {
            let (a, b) = (first + band, first + 4 + band);
            self.indices.extend([a, b, b + 1, a, b + 1, a + 1]);
        }
    }

    /// Adds a ring of this width around a center.
    pub fn add_ring(&mut self, center: Vec2, radius: f32, width: f32, color: Color) {
        let steps = disc_sides(radius + width) as u32;
        let first = self.vertices.len() as u32;
        for step in 0..steps {
            let direction = Vec2::from_angle(step as f32 / steps as f32 * TAU);
            for (offset, opacity) in [
                (-FEATHER, 0.0),
                (0.0, 1.0),
                (width, 1.0),
                (width + FEATHER, 0.0),
            ] {
                let own = f32::from(color.0[3]) / 255.0;
                let color = color.with_opacity(opacity * own);
                self.vertices
                    .push((center + direction * (radius + offset), color));
            }
        }
        for step in 0..steps {
            let (a, b) = (first + 4 * step, first + 4 * ((step + 1) % steps));
            for band in 0..3 {
                let (a, b) = (a + band, b + band);
                self.indices.extend([a, b, b + 1, a, b + 1, a + 1]);
            }
        }
    }
}

/// Returns the number of sides with which a disc of a radius in points looks round.
pub fn disc_sides(radius: f32) -> usize {
    let sides = (radius * TAU / DISC_SIDE) as usize;
    sides.clamp(DISC_SIDES.0, DISC_SIDES.1)
}

/// Returns the outline of a disc.
pub fn disc(center: Vec2, radius: f32) -> Vec<Vec2> {
    circle(center, radius, disc_sides(radius))
}

/// Returns the outline of a disc with a number of sides.
pub fn circle(center: Vec2, radius: f32, sides: usize) -> Vec<Vec2> {
    let angle = |step: usize| step as f32 / sides as f32 * TAU;
    (0..sides)
        .map(|step| center + Vec2::from_angle(angle(step)) * radius)
        .collect()
}

/// Returns the outline of two discs and what is between them.
pub fn capsule((from, from_radius): (Vec2, f32), (to, to_radius): (Vec2, f32)) -> Vec<Vec2> {
    let along = to - from;
    let angle = along.y.atan2(along.x);
    let mut outline = Vec::with_capacity(2 * ARC_STEPS + 2);
    for (center, radius, start) in [
        (to, to_radius, angle - PI / 2.0),
        (from, from_radius, angle + PI / 2.0),
    ] {
        for step in 0..=ARC_STEPS {
            let at = start + step as f32 / ARC_STEPS as f32 * PI;
            outline.push(center + Vec2::from_angle(at) * radius);
        }
    }
    outline
}

/// Returns the convex hull of points (Andrew's monotone chain).
pub fn convex_hull(mut points: Vec<Vec2>) -> Vec<Vec2> {
    remove_inner_points(&mut points);
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let half = |sorted: &mut dyn Iterator<Item = Vec2>| {
        let mut chain: Vec<Vec2> = Vec::new();
        for point in sorted {
            while let [.., a, b] = chain[..]
                && (b - a).perp_dot(point - a) <= 0.0
            {
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut hull = half(&mut points.iter().copied());
    hull.extend(half(&mut points.iter().rev().copied()));
    hull
}

/// Removes the points inside the quadrilateral of those that are farthest along the diagonals: of many points most, and none of
/// the hull (Akl and Toussaint).
fn remove_inner_points(points: &mut Vec<Vec2>) {
    let farthest = |direction: Vec2| {
        let along = |point: &Vec2| point.dot(direction);
        points
            .iter()
            .copied()
            .max_by(|a, b| along(a).total_cmp(&along(b)))
    };
    let diagonals = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
    let [Some(a), Some(b), Some(c), Some(d)] = diagonals.map(|(x, y)| farthest(Vec2::new(x, y)))
    else {
        return;
    };
    let edges = [(a, b), (b, c), (c, d), (d, a)];
    let is_left = |point: Vec2, (from, to): (Vec2, Vec2)| (to - from).perp_dot(point - from) > 0.0;
    points.retain(|&point| !edges.iter().all(|&edge| is_left(point, edge)));
}

/// Replaces the signs that the font of the window lacks. Backspace has a word: an arrow would be taken for the arrow key.
pub fn with_known_signs(label: &str) -> String {
    if label == "␣" {
        return "Space".to_owned();
    }
    let mut known = String::with_capacity(label.len());
    for sign in label.chars() {
        match sign {
            '⏎' => known.push('↵'),
            '⌫' => known.push_str("Back"),
            '␣' => known.push(' '),
            other => known.push(other),
        }
    }
    known
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hull_of_a_square_is_its_corners() {
        let square = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)].map(|(x, y)| Vec2::new(x, y));
        let mut points = square.to_vec();
        points.extend([Vec2::ONE, Vec2::new(1.0, 0.5)]);
        let hull = convex_hull(points);
        assert_eq!(hull.len(), 4);
        assert!(square.iter().all(|corner| hull.contains(corner)));
    }

    #[test]
    fn the_hull_of_many_points_is_that_of_the_outer_ones() {
        let mut random = fastrand::Rng::with_seed(3);
        let mut number = || random.f32() * 2.0 - 1.0;
        let inner: Vec<Vec2> = (0..500)
            .map(|_| Vec2::new(number(), number()) * 0.6)
            .collect();
        let outer: Vec<Vec2> = (0..24)
            .map(|at| Vec2::from_angle(at as f32 * 0.26))
            .collect();
        let mut points = [inner, outer.clone()].concat();
        let hull = convex_hull(points.clone());
        assert_eq!(hull.len(), outer.len());
        assert!(outer.iter().all(|corner| hull.contains(corner)));
        remove_inner_points(&mut points);
        assert!(points.len() < 200, "{}", points.len());
    }

    #[test]
    fn a_shape_hides_the_labels_below_it_and_no_others() {
        let label = |text: &str, x: f32| Label {
            position: Vec2::new(x, 0.0),
            right: Vec2::X * 10.0,
            down: Vec2::Y * 10.0,
            color: Color::rgb(1, 2, 3),
            text: text.to_owned(),
        };
        // The end of a long one reaches into the disc.
        let labels = [
            ("left", -40.0),
            ("reaching", -26.0),
            ("A", 0.0),
            ("B", 40.0),
        ];
        let mut picture = Picture {
            labels: labels.map(|(text, x)| label(text, x)).into(),
            ..Picture::default()
        };
        picture.hide_labels(&disc(Vec2::ZERO, 20.0));
        picture.hide_labels(&[]);
        // A label in the rectangle around a triangle is not below the triangle.
        let corner = [(30.0, 20.0), (50.0, 20.0), (50.0, -1.0)].map(|(x, y)| Vec2::new(x, y));
        picture.hide_labels(&corner);
        let texts: Vec<&str> = picture.labels.iter().map(|it| it.text.as_str()).collect();
        assert_eq!(texts, ["left", "B"]);
    }

    #[test]
    fn all_indices_of_a_polygon_and_a_ring_are_corners() {
        let mut triangles = Triangles::default();
        let corners = capsule((Vec2::ZERO, 4.0), (Vec2::new(30.0, 0.0), 3.0));
        triangles.add_flat_polygon(&corners, Color::rgb(1, 2, 3));
        triangles.add_ring(Vec2::ZERO, 10.0, 2.0, Color::rgb(1, 2, 3));
        triangles.add_plain_polygon(&[Vec2::ZERO; 4], Color::rgb(1, 2, 3));
        let count = triangles.vertices.len() as u32;
        assert!(triangles.indices.iter().all(|&index| index < count));
        assert_eq!(triangles.indices.len() % 3, 0);
    }

    #[test]
    fn a_large_disc_and_its_ring_are_as_round_as_a_small_one() {
        for (radius, sides) in [(3.0, 24), (40.0, 83), (5000.0, 128)] {
            assert_eq!(disc(Vec2::ZERO, radius).len(), sides);
        }
        let mut triangles = Triangles::default();
        triangles.add_ring(Vec2::ZERO, 300.0, 2.0, Color::rgb(1, 2, 3));
        let corners = triangles.vertices.iter().step_by(4);
        let corners: Vec<Vec2> = corners.map(|(at, _)| *at).collect();
        // The middle of a side is less than a third of a point within the ring.
        let middle = (corners[0] + corners[1]) / 2.0;
        assert!(299.0 - middle.length() < 0.33, "{}", middle.length());
    }

    #[test]
    fn no_sign_of_another_key_looks_like_an_arrow_key() {
        let signs = ["⌫", "⏎", "␣"].map(with_known_signs);
        assert_eq!(signs, ["Back", "↵", "Space"]);
        let is_arrow = |sign: &String| sign.contains(['←', '⟵', '⬅']);
        assert!(!signs.iter().any(is_arrow));
        assert_eq!(with_known_signs("a ⌫"), "a Back");
    }

    #[test]
    fn colors_mix() {
        let (black, white) = (Color::rgb(0, 0, 0), Color::rgb(255, 255, 255));
        assert_eq!(black.mix(white, 0.5), Color::rgb(128, 128, 128));
        assert_eq!(black.mix(white, 7.0), white);
    }
}
