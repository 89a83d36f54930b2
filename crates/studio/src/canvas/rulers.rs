//! Rulers along the upper and the left edge of a picture, in millimetres.

use parry3d::math::Vec2;

use super::Bounds;
use super::viewport::Viewport;
use crate::picture::{Color, Label, Picture};
use crate::scene::SceneColors;

/// Width of a ruler, in points.
pub const WIDTH: f32 = 18.0;

/// Distances between ticks and between numbers, in millimetres. Each is a multiple of the previous distance.
const STEPS: [f32; 7] = [1.0, 5.0, 10.0, 50.0, 100.0, 500.0, 1000.0];

/// The smallest distances between ticks and between numbers, in points.
const TICK_GAP: f32 = 5.0;
const NUMBER_GAP: f32 = 30.0;

/// Lengths of ticks, in points: with a number, at a larger step than the others, and others.
const TICKS: [f32; 3] = [9.0, 6.0, 3.5];

/// Height of a number, and distance of its middle from the edge of the picture, in points.
const NUMBER: f32 = 6.5;
const NUMBER_MIDDLE: f32 = 5.5;

/// Room for half a number beside the corner and before the end, in points.
const NUMBER_ROOM: f32 = 9.0;

/// Opacity of a ruler over the items, and of the extent of what is selected.
const OPACITY: f32 = 0.92;
const SELECTED_OPACITY: f32 = 0.35;

/// The part of the background in ticks and numbers.
const PALENESS: f32 = 0.25;

/// The marks on rulers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rulers {
    /// The position of the pointer on the picture, in points.
    pub pointer: Option<Vec2>,
    /// The rectangle around what is selected, in millimetres.
    pub selected: Option<Bounds>,
}

/// Returns the distances between ticks and between numbers at a zoom in points per millimetre.
fn steps(scale: f32) -> [f32; 2] {
    let apart = |gap: f32| {
        let fits = |step: &&f32| **step * scale >= gap;
        *STEPS.iter().find(fits).unwrap_or(&STEPS[STEPS.len() - 1])
    };
    [apart(TICK_GAP), apart(NUMBER_GAP)]
}

/// A ruler that is drawn: 0 along the upper edge, 1 along the left one.
struct Pen<'a> {
    picture: &'a mut Picture,
    axis: usize,
    ink: Color,
}

impl Pen<'_> {
    /// Returns the point of the picture at a distance along the ruler, and one from the edge.
    fn point(&self, along: f32, across: f32) -> Vec2 {
        match self.axis {
            0 => Vec2::new(along, across),
            _ => Vec2::new(across, along),
        }
    }

    /// Adds a rectangle over a part of the ruler.
    fn add_bar(&mut self, [from, to]: [f32; 2], [near, far]: [f32; 2], color: Color) {
        let corners = [(from, near), (to, near), (to, far), (from, far)];
        let corners = corners.map(|(along, across)| self.point(along, across));
        self.picture.below.add_plain_polygon(&corners, color);
    }

    fn add_tick(&mut self, along: f32, length: f32) {
        let ends = [along - 0.5, along + 0.5];
        self.add_bar(ends, [WIDTH - length, WIDTH], self.ink);
    }

    fn add_number(&mut self, along: f32, number: f32) {
        // The left ruler is read from its right.
        let (right, down) = match self.axis {
            0 => (Vec2::X, Vec2::Y),
            _ => (Vec2::NEG_Y, Vec2::X),
        };
        self.picture.labels.push(Label {
            position: self.point(along, NUMBER_MIDDLE),
            right: right * NUMBER,
            down: down * NUMBER,
            color: self.ink,
            text: format!("{number}"),
        });
    }
}

/// Draws both rulers over a picture of this size in points.
pub fn draw(rulers: &Rulers, viewport: &Viewport, size: Vec2, colors: &SceneColors) -> Picture {
    let mut picture = Picture::default();
    let visible = viewport.visible(size);
    let [tick, numbered] = steps(viewport.scale);
    let larger = STEPS.iter().copied().find(|step| *step > tick);
    let is_at = |mark: f32, step: f32| (mark / step).round() * step == mark;
    for axis in [0, 1] {
        let mut pen = Pen {
            picture: &mut picture,
            axis,
            ink: colors.label.mix(colors.background, PALENESS),
        };
        let on_screen = |mm: f32| viewport.to_screen(Vec2::splat(mm), size)[axis];
        let end = size[axis];
        let background = colors.background.with_opacity(OPACITY);
        pen.add_bar([axis as f32 * WIDTH, end], [0.0, WIDTH], background);
        if let Some(bounds) = rulers.selected {
            let ends = [bounds.min[axis], bounds.max[axis]].map(on_screen);
            let (low, high) = (ends[0].min(ends[1]).max(WIDTH), ends[0].max(ends[1]));
            let shade = colors.ring.with_opacity(SELECTED_OPACITY);
            if low < high.min(end) {
                pen.add_bar([low, high.min(end)], [0.0, WIDTH], shade);
            }
        }
        pen.add_bar([WIDTH, end], [WIDTH - 1.0, WIDTH], pen.ink);
        let (first, last) = (visible.min[axis] / tick, visible.max[axis] / tick);
        for index in first.ceil() as i32..=last.floor() as i32 {
            let mark = index as f32 * tick;
            let along = on_screen(mark);
            if along < WIDTH {
                continue;
            }
            let length = match (
                is_at(mark, numbered),
                larger.is_some_and(|it| is_at(mark, it)),
            ) {
                (true, _) => TICKS[0],
                (false, true) => TICKS[1],
                (false, false) => TICKS[2],
            };
            pen.add_tick(along, length);
            let room = WIDTH + NUMBER_ROOM..=end - NUMBER_ROOM;
            if length == TICKS[0] && room.contains(&along) {
                pen.add_number(along, mark);
            }
        }
        if let Some(pointer) = rulers.pointer
            && (WIDTH..=end).contains(&pointer[axis])
        {
            let along = pointer[axis];
            pen.add_bar([along - 1.0, along + 1.0], [0.0, WIDTH], colors.label);
        }
    }
    picture
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: Vec2 = Vec2::new(800.0, 500.0);

    /// The corner at the left near is 100 mm to the right of the origin.
    fn viewport(scale: f32) -> Viewport {
        Viewport {
            center: Vec2::new(100.0, 40.0),
            scale,
        }
    }

    fn numbers(picture: &Picture) -> Vec<(i32, Vec2)> {
        let labels = picture.labels.iter();
        let number = |label: &Label| (label.text.parse().unwrap(), label.position);
        labels.map(number).collect()
    }

    #[test]
    fn ticks_and_numbers_stay_apart_at_every_zoom() {
        for (scale, expected) in [
            (0.05, [100.0, 1000.0]),
            (0.3, [50.0, 100.0]),
            (0.7, [10.0, 50.0]),
            (1.1, [5.0, 50.0]),
            (3.0, [5.0, 10.0]),
            (5.0, [1.0, 10.0]),
            (8.0, [1.0, 5.0]),
            (60.0, [1.0, 1.0]),
        ] {
            assert_eq!(steps(scale), expected, "{scale}");
        }
    }

    #[test]
    fn a_number_stands_where_its_millimetre_is() {
        let viewport = viewport(3.0);
        let picture = draw(&Rulers::default(), &viewport, SIZE, &SceneColors::LIGHT);
        let (top, left): (Vec<_>, Vec<_>) = numbers(&picture)
            .into_iter()
            .partition(|(_, at)| at.y == NUMBER_MIDDLE);
        for (numbers, axis) in [(top, 0), (left, 1)] {
            assert!(numbers.len() > 10, "{}", numbers.len());
            for (number, at) in numbers {
                assert_eq!(number % 10, 0);
                let expected = viewport.to_screen(Vec2::splat(number as f32), SIZE);
                assert!((at[axis] - expected[axis]).abs() < 1e-2, "{number}");
            }
        }
    }

    #[test]
    fn no_number_is_cut_at_an_end() {
        let viewport = viewport(3.0);
        // The numbers are 30 points apart: some width ends at each part of one.
        for points in 0..30 {
            let size = SIZE + Vec2::splat(points as f32);
            let picture = draw(&Rulers::default(), &viewport, size, &SceneColors::LIGHT);
            for (number, at) in numbers(&picture) {
                let axis = usize::from(at.y != NUMBER_MIDDLE);
                let room = WIDTH + NUMBER_ROOM..=size[axis] - NUMBER_ROOM;
                assert!(room.contains(&at[axis]), "{number} at {at} of {size}");
            }
        }
    }

    #[test]
    fn the_pointer_and_the_extent_of_the_selection_are_marked_on_both() {
        let (viewport, colors) = (viewport(3.0), SceneColors::DARK);
        let marked = Rulers {
            pointer: Some(Vec2::new(320.0, 123.0)),
            selected: Some(Bounds::between(
                Vec2::new(90.0, 30.0),
                Vec2::new(120.0, 50.0),
            )),
        };
        let picture = draw(&marked, &viewport, SIZE, &colors);
        let of_color = |color: Color| -> Vec<Vec2> {
            let vertices = picture.below.vertices.iter();
            let own = vertices.filter(|(_, it)| *it == color);
            own.map(|(at, _)| *at).collect()
        };
        let pointer = of_color(colors.label);
        assert_eq!((pointer[0].x, pointer[4].y), (319.0, 122.0));
        let shade = of_color(colors.ring.with_opacity(SELECTED_OPACITY));
        let (top, left) = (&shade[..4], &shade[4..]);
        assert_eq!((top[0].x, top[1].x), (370.0, 460.0));
        assert_eq!((left[0].y, left[1].y), (220.0, 280.0));
        let outside = Rulers {
            pointer: None,
            selected: Some(Bounds::between(Vec2::splat(900.0), Vec2::splat(950.0))),
        };
        let plain = draw(&Rulers::default(), &viewport, SIZE, &colors);
        let vertices = |it: &Picture| it.below.vertices.len();
        assert_eq!(
            vertices(&draw(&outside, &viewport, SIZE, &colors)),
            vertices(&plain)
        );
    }

    #[test]
    fn numbers_are_readable_in_every_theme() {
        for (is_dark, has_high_contrast, least) in crate::scene::THEMES {
            let colors = SceneColors::new(is_dark, has_high_contrast);
            let picture = draw(&Rulers::default(), &viewport(3.0), SIZE, &colors);
            let ratio = picture.labels[0].color.contrast(colors.background);
            assert!(ratio >= least, "{is_dark} {has_high_contrast}: {ratio}");
        }
    }
}
