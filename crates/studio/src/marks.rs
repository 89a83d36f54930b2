//! The marks on fronts of controls - handles, scales, labels - on a picture.

use std::collections::BTreeMap;
use std::f32::consts::FRAC_PI_2;

use parry3d::math::Vec2;

use super::fonts::CAPITAL_HEIGHT;
use super::picture::{Color, Label, Picture, circle, disc_sides, with_known_signs};
use super::scene::SceneColors;
use super::texts::text_with;
use ademan_core::contact::TargetId;
use ademan_core::layout::{FrontMark, Layout, MarkRole, MarkShape};

/// The smallest label that can be read, in points.
const MIN_LABEL_PT: f32 = 5.0;

/// The part of the color of missed strokes on a front with the most of them: its label stays readable.
const HOTTEST: f32 = 0.75;

/// The longest line of a round corner, in points, and the range of the number of its lines.
const CORNER_LINE: f32 = 3.0;
const CORNER_STEPS: (usize, usize) = (3, 32);

/// The place of a front on the screen.
pub struct FrontView<'a> {
    /// Returns the position on the screen, in points, of a point of the front, in millimetres from its center.
    pub to_screen: &'a dyn Fn(Vec2) -> Option<Vec2>,
    /// Points per millimetre in the middle of the front.
    pub scale: f32,
    /// The colors.
    pub colors: &'a SceneColors,
    /// The control is pressed.
    pub is_lit: bool,
    /// The strength of the color of missed strokes, 0..=1.
    pub heat: f32,
}

/// Returns the marks on a front with the numbers of its values after its label, at a number of points per millimetre. Where a
/// number would be too small to read, only the label is drawn. `None` if the target is not a control with marks.
pub fn valued_marks(
    layout: &Layout,
    target: TargetId,
    values: &BTreeMap<TargetId, f32>,
    scale: f32,
) -> Option<Vec<FrontMark>> {
    let value = |of: TargetId| values.get(&of).copied();
    let numbered = layout.numbered_front_marks(target, value)?;
    // The turns of a wheel may be smaller: they have no number.
    let is_readable = |mark: &FrontMark| match (&mark.shape, mark.role) {
        (MarkShape::Text { size, .. }, MarkRole::Label) => {
            size * CAPITAL_HEIGHT * scale >= MIN_LABEL_PT
        }
        _ => true,
    };
    if numbered.iter().all(is_readable) {
        return Some(numbered);
    }
    layout.front_marks(target, value)
}

/// Adds marks to a picture, from below to above.
pub fn add_marks(picture: &mut Picture, marks: &[FrontMark], view: &FrontView) {
    for mark in marks {
        // A mark that is partly behind the eye is left out.
        let _ = add_mark(picture, mark, view);
    }
}

/// Returns the color of a front on which a part of the strokes missed: 0 for none, 1 for the most.
pub fn heated(front: Color, heat: f32, colors: &SceneColors) -> Color {
    front.mix(colors.fault, HOTTEST * heat.clamp(0.0, 1.0))
}

/// Returns half the width of a disc or a box, and 0 for other marks.
pub fn half_width(shape: &MarkShape) -> f32 {
    match shape {
        MarkShape::Disc { radius, .. } => *radius,
        MarkShape::Box { half, .. } => half.x,
        _ => 0.0,
    }
}

fn add_mark(picture: &mut Picture, mark: &FrontMark, view: &FrontView) -> Option<()> {
    let color = view.color(mark.role);
    match &mark.shape {
        MarkShape::Disc {
            center,
            radius,
            is_hollow,
        } => {
            let sides = disc_sides(radius * view.scale);
            let corners = view.map(&circle(*center, *radius, sides))?;
            if *is_hollow {
                add_lines(picture, &corners, true, view.width(0.4), color);
            } else {
                picture.below.add_flat_polygon(&corners, color);
            }
        }
        MarkShape::Box {
            center,
            half,
            radius,
            rotation,
        } => {
            let outline = rounded(*half, *radius, corner_steps(radius * view.scale));
            let turned = outline.into_iter();
            let turned = turned.map(|at| *center + Vec2::from_angle(*rotation).rotate(at));
            let corners = view.map(&turned.collect::<Vec<_>>())?;
            picture.below.add_flat_polygon(&corners, color);
        }
        MarkShape::Polygon(points) => {
            let points = view.map(points)?;
            add_lines(picture, &points, true, view.width(0.5), color);
        }
        MarkShape::Line(points, width) => {
            let points = view.map(points)?;
            add_lines(picture, &points, false, view.width(*width), color);
        }
        MarkShape::Text {
            center,
            size,
            rotation,
            text,
        } => {
            let size = size * CAPITAL_HEIGHT;
            if size * view.scale < MIN_LABEL_PT {
                return None;
            }
            let along = Vec2::from_angle(*rotation) * size;
            let position = (view.to_screen)(*center)?;
            picture.labels.push(Label {
                position,
                right: (view.to_screen)(*center + along)? - position,
                down: (view.to_screen)(*center - along.perp())? - position,
                color,
                text: words(mark.role, text),
            });
        }
    }
    Some(())
}

/// Returns the words of a mark, in the language of the window if they are not from the layout: the turns of a wheel.
fn words(role: MarkRole, text: &str) -> String {
    let turns = text.strip_suffix(" turns");
    match turns.filter(|_| role == MarkRole::Note) {
        Some(turns) => text_with("front-turns", &[("turns", turns.into())]),
        None => with_known_signs(text),
    }
}

impl FrontView<'_> {
    fn map(&self, points: &[Vec2]) -> Option<Vec<Vec2>> {
        points
            .iter()
            .map(|point| (self.to_screen)(*point))
            .collect()
    }

    /// Returns the width of a line on the screen, which is seen at any distance.
    fn width(&self, millimetres: f32) -> f32 {
        (millimetres * self.scale).max(0.7)
    }

    fn color(&self, role: MarkRole) -> Color {
        let colors = self.colors;
        match role {
            MarkRole::Well if self.is_lit => colors.lit,
            MarkRole::Well => heated(colors.key.mix(colors.key_side, 0.3), self.heat, colors),
            MarkRole::Groove => colors.groove,
            MarkRole::Handle => colors.label.mix(colors.key, 0.25),
            MarkRole::Cap if self.is_lit => colors.lit,
            MarkRole::Cap => heated(colors.key, self.heat, colors),
            MarkRole::OnHandle => colors.key,
            MarkRole::Value => colors.ring,
            MarkRole::Scale => colors.label.mix(colors.key, 0.45),
            MarkRole::Label | MarkRole::Note if self.is_lit => colors.lit_label,
            MarkRole::Label | MarkRole::Note => colors.label,
        }
    }
}

fn add_lines(picture: &mut Picture, points: &[Vec2], is_closed: bool, width: f32, color: Color) {
    for ends in points.windows(2) {
        let ends = [(ends[0], color), (ends[1], color)];
        picture.below.add_line(ends, width);
    }
    if let (true, [first, .., last]) = (is_closed, points) {
        picture
            .below
            .add_line([(*last, color), (*first, color)], width);
    }
}

/// Returns the number of lines with which a corner of a radius in points looks round.
pub fn corner_steps(radius: f32) -> usize {
    let lines = (radius * FRAC_PI_2 / CORNER_LINE) as usize;
    lines.clamp(CORNER_STEPS.0, CORNER_STEPS.1)
}

/// Returns the outline of a rectangle with round corners of a number of lines around the origin.
pub fn rounded(half: Vec2, radius: f32, steps: usize) -> Vec<Vec2> {
    let radius = radius.min(half.min_element());
    let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
    let mut outline = Vec::with_capacity(corners.len() * (steps + 1));
    for (corner, (x, y)) in corners.into_iter().enumerate() {
        for step in 0..=steps {
            let turn = corner as f32 + step as f32 / steps as f32;
            let round = Vec2::from_angle(turn * FRAC_PI_2) * radius;
            outline.push(Vec2::new(x, y) * (half - radius) + round);
        }
    }
    outline
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::THEMES;
    use crate::texts::{Language, set_language};
    use ademan_runtime::files::Load;
    use std::f32::consts::TAU;

    /// Returns the view of a front that is not pressed, in the dark theme.
    fn view(scale: f32, to_screen: &dyn Fn(Vec2) -> Option<Vec2>) -> FrontView<'_> {
        FrontView {
            to_screen,
            scale,
            colors: &SceneColors::DARK,
            is_lit: false,
            heat: 0.0,
        }
    }

    #[test]
    fn the_label_of_a_pressed_knob_is_on_a_lit_hub() {
        let to_screen = |point: Vec2| Some(point);
        let mut view = view(3.0, &to_screen);
        view.is_lit = true;
        assert_eq!(view.color(MarkRole::Cap), SceneColors::DARK.lit);
        assert_eq!(view.color(MarkRole::Label), SceneColors::DARK.lit_label);
    }

    #[test]
    fn a_wheel_is_round_at_every_size_on_the_screen() {
        let layout = Layout::load("steering-wheel").unwrap();
        let wheel = layout.target_names().find("Wheel").unwrap();
        let marks = layout.front_marks(wheel, |_| None).unwrap();
        let rims = marks.into_iter().filter_map(|mark| match mark.shape {
            MarkShape::Disc { radius, .. } => Some((radius, mark)),
            _ => None,
        });
        let rims: Vec<_> = rims.collect();
        assert!(rims.len() >= 2);
        for scale in [2.0_f32, 6.0] {
            for (radius, mark) in &rims {
                let mut picture = Picture::default();
                let to_screen = |point: Vec2| Some(point * scale);
                let view = view(scale, &to_screen);
                add_marks(&mut picture, std::slice::from_ref(mark), &view);
                // No side of a polygon with so many of them is farther than a quarter of a point from its circle.
                let sides = disc_sides(radius * scale) as f32;
                let gap = radius * scale * (1.0 - (TAU / (2.0 * sides)).cos());
                assert!(gap < 0.25, "{radius} mm: {gap}");
                let corners = picture.below.vertices.len() as f32;
                assert!(corners >= 2.0 * sides, "{corners} of {sides} sides");
            }
        }
    }

    #[test]
    fn a_handle_is_seen_on_its_track_in_every_theme() {
        for (is_dark, has_high_contrast, _) in THEMES {
            let colors = SceneColors::new(is_dark, has_high_contrast);
            let to_screen = |point: Vec2| Some(point);
            let mut view = view(3.0, &to_screen);
            view.colors = &colors;
            let groove = view.color(MarkRole::Groove);
            // As the guidelines ask for graphics, and more where high contrast is asked for.
            let least = if has_high_contrast { 7.0 } else { 3.0 };
            let ratio = view.color(MarkRole::Handle).contrast(groove);
            assert!(ratio >= least, "{is_dark} {has_high_contrast}: {ratio}");
        }
    }

    #[test]
    fn a_number_that_cannot_be_read_leaves_the_room_to_the_label() {
        let words = |file: &str, name: &str, scale: f32| -> String {
            let layout = Layout::load(file).unwrap();
            let knob = layout.target_names().find(name).unwrap();
            let values = BTreeMap::from([(knob, 0.25)]);
            let marks = valued_marks(&layout, knob, &values, scale).unwrap();
            let texts = marks.into_iter().filter_map(|mark| match mark.shape {
                MarkShape::Text { text, .. } => Some(text),
                _ => None,
            });
            texts.collect::<Vec<_>>().join(" ")
        };
        assert_eq!(words("mixer", "Balance 1", 8.0), "Bal 0.25");
        assert_eq!(words("mixer", "Balance 1", 1.5), "Bal");
        // Its turns cannot be read at this scale.
        let wheel = words("steering-wheel", "Wheel", 2.0);
        assert!(wheel.contains("Wheel 0.25"), "{wheel}");
    }

    #[test]
    fn the_turns_of_a_wheel_are_in_the_language_of_the_window_and_labels_as_they_are() {
        let layout = Layout::load("steering-wheel").unwrap();
        let wheel = layout.target_names().find("Wheel").unwrap();
        let marks = layout.front_marks(wheel, |_| None).unwrap();
        let written = |language| {
            set_language(language);
            let mut picture = Picture::default();
            add_marks(&mut picture, &marks, &view(8.0, &|point| Some(point * 8.0)));
            let texts = picture.labels.into_iter().map(|label| label.text);
            texts.collect::<Vec<_>>()
        };
        assert!(written(Language::English).contains(&"2.5 turns".to_owned()));
        assert!(written(Language::Spanish).contains(&"2.5 vueltas".to_owned()));
        assert_eq!(words(MarkRole::Label, "3 turns"), "3 turns");
        set_language(Language::English);
    }

    #[test]
    fn the_handle_of_a_fader_moves_with_its_value() {
        let layout = Layout::load("media").unwrap();
        let fader = &layout.controls[0].faces[0];
        let to_screen = |point: Vec2| Some(point * Vec2::new(3.0, -3.0));
        let picture = |value: f32| {
            let marks = layout.front_marks(fader.target, |_| Some(value)).unwrap();
            let mut picture = Picture::default();
            add_marks(&mut picture, &marks, &view(3.0, &to_screen));
            picture
        };
        let (low, high) = (picture(0.0), picture(1.0));
        assert_eq!(low.below.vertices.len(), high.below.vertices.len());
        assert_ne!(low.below.vertices, high.below.vertices);
        assert!(low.labels.iter().any(|label| !label.text.is_empty()));
        let count = low.below.vertices.len() as u32;
        assert!(low.below.indices.iter().all(|index| *index < count));
    }
}
