//! The marks on the front of a control, for pictures that are not SVG: the same drawing as in SVG, as shapes.

use parry3d::math::Vec2;

use super::svg;
use crate::contact::TargetId;
use crate::layout::model::{Control, ControlKind, Face, Layout};

/// A mark on a front, in millimetres from its center: x to the right along its row, y away from the wearer, before the rotation of
/// the front.
#[derive(Clone, Debug, PartialEq)]
pub struct FrontMark {
    /// The part that it belongs to, which determines its color.
    pub role: MarkRole,
    /// The outline.
    pub shape: MarkShape,
}

/// The part of a control that a mark draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MarkRole {
    /// The area of the front.
    Well,
    /// A groove or a slot in it.
    Groove,
    /// A handle, a dial or a rocker.
    Handle,
    /// A lighter part of a handle.
    Cap,
    /// A line on a handle.
    OnHandle,
    /// A line that shows the value, or the option that is on.
    Value,
    /// A scale and its lines.
    Scale,
    /// A label.
    Label,
    /// The words below a label, such as the turns of a wheel.
    Note,
}

/// The outline of a mark.
#[derive(Clone, Debug, PartialEq)]
pub enum MarkShape {
    /// A disc, or a circle around it.
    Disc {
        /// Center.
        center: Vec2,
        /// Radius.
        radius: f32,
        /// `true` if only its edge is drawn.
        is_hollow: bool,
    },
    /// A rectangle with round corners.
    Box {
        /// Center.
        center: Vec2,
        /// Half of width and height before the rotation.
        half: Vec2,
        /// Radius of the corners.
        radius: f32,
        /// Rotation about the center, in radians, counter-clockwise.
        rotation: f32,
    },
    /// A polygon.
    Polygon(Vec<Vec2>),
    /// Connected lines of a width.
    Line(Vec<Vec2>, f32),
    /// A line of text.
    Text {
        /// Center.
        center: Vec2,
        /// Height of the font.
        size: f32,
        /// Rotation about the center, in radians, counter-clockwise.
        rotation: f32,
        /// The text.
        text: String,
    },
}

impl Layout {
    /// Returns the marks on the front of a control other than a key, from below to above. `value` returns the value of a target,
    /// 0..=1 for the position of a handle, or 1 for on; the default is the position at the start. `None` if the target is
    /// not such a control.
    pub fn front_marks(
        &self,
        target: TargetId,
        value: impl Fn(TargetId) -> Option<f32>,
    ) -> Option<Vec<FrontMark>> {
        self.marks_of(target, value, false)
    }

    /// Returns the marks of [`front_marks`](Self::front_marks), with the numbers of values that are quantities after the label: they
    /// share the room of the label.
    pub fn numbered_front_marks(
        &self,
        target: TargetId,
        value: impl Fn(TargetId) -> Option<f32>,
    ) -> Option<Vec<FrontMark>> {
        self.marks_of(target, value, true)
    }

    fn marks_of(
        &self,
        target: TargetId,
        value: impl Fn(TargetId) -> Option<f32>,
        is_numbered: bool,
    ) -> Option<Vec<FrontMark>> {
        let (control, index) = self.control_at(target)?;
        let kind = valued(control, &value);
        let is_on = value(target).is_some_and(|value| value > 0.5);
        let face = &control.faces[index];
        let values = 0..control.value_targets().len();
        let mut numbers = values
            .filter_map(|position| kind.model().value_number(position))
            .filter(|_| is_numbered)
            .peekable();
        if numbers.peek().is_none() {
            return Some(svg::front_marks(self, &kind, index, is_on, face));
        }
        let mut numbered: Face = face.clone();
        for number in numbers {
            // Without a sign before zero.
            let number = (number * 100.0).round() / 100.0 + 0.0;
            numbered.label = format!("{} {number:.2}", numbered.label);
        }
        Some(svg::front_marks(self, &kind, index, is_on, &numbered))
    }
}

/// Returns a control with the values that are known.
fn valued(control: &Control, value: impl Fn(TargetId) -> Option<f32>) -> ControlKind {
    let mut kind = control.kind.clone();
    for (position, own) in control.value_targets().into_iter().enumerate() {
        if let Some(shown) = value(own) {
            kind = kind.with_value(position, shown);
        }
    }
    kind
}

#[cfg(test)]
mod tests {
    use super::*;

    fn marks(controls: &str, value: Option<f32>) -> Vec<FrontMark> {
        let text = format!("Layout(name: \"a\", boards: [(pose: (anchor: elbow), {controls})])");
        let layout = Layout::parse(&text, "a.ron").unwrap();
        layout.front_marks(TargetId(0), |_| value).unwrap()
    }

    /// Returns the center of the topmost handle.
    fn handle(marks: &[FrontMark]) -> Vec2 {
        let mut centers = marks.iter().filter_map(|mark| match mark.shape {
            MarkShape::Box { center, .. } if mark.role == MarkRole::Handle => Some(center),
            _ => None,
        });
        centers.next_back().unwrap()
    }

    #[test]
    fn the_handle_of_a_slider_is_where_its_value_is() {
        let slider = "sliders: [(name: \"s\", at_mm: (0, 0), length_mm: 100, width_mm: 20)]";
        let at = |value| handle(&marks(slider, value)).x;
        assert!(at(Some(0.0)) < -30.0 && at(Some(1.0)) > 30.0);
        assert!(at(Some(0.5)).abs() < 1e-3);
        assert_eq!(at(None), at(Some(0.0)), "the first position");
    }

    #[test]
    fn the_handle_of_an_xy_pad_is_where_both_values_are() {
        let text = "Layout(name: \"a\", boards: [(pose: (anchor: elbow), \
                    xy_pads: [(name: \"p\", at_mm: (0, 0), size_mm: Box(100, 60))])])";
        let layout = Layout::parse(text, "a.ron").unwrap();
        let [x, y] = ["p x", "p y"].map(|name| layout.target_names().find(name).unwrap());
        let handle = |values: &[(TargetId, f32)]| {
            let value = |target| Some(values.iter().find(|(it, _)| *it == target)?.1);
            let marks = layout.front_marks(TargetId(0), value).unwrap();
            let mut discs = marks.iter().filter_map(|mark| match mark.shape {
                MarkShape::Disc { center, .. } if mark.role == MarkRole::Handle => Some(center),
                _ => None,
            });
            discs.next().unwrap()
        };
        assert_eq!(handle(&[]), Vec2::ZERO, "the middle at the start");
        let corner = handle(&[(x, 1.0), (y, 0.0)]);
        assert!(corner.x > 44.0 && corner.y < -24.0, "{corner}");
        assert_eq!(handle(&[(y, 1.0)]), Vec2::new(0.0, -corner.y));
    }

    #[test]
    fn the_lines_of_an_xy_pad_do_not_cross_its_label() {
        let text = "Layout(name: \"a\", boards: [(pose: (anchor: elbow), \
                    xy_pads: [(name: \"pad\", at_mm: (0, 0), size_mm: Box(100, 60))])])";
        let layout = Layout::parse(text, "a.ron").unwrap();
        let x = layout.target_names().find("pad x").unwrap();
        let steps = (0..=20).map(|step| step as f32 / 20.0);
        for (right, away) in steps
            .clone()
            .flat_map(|it| steps.clone().map(move |other| (it, other)))
        {
            let value = |target| Some(if x == target { right } else { away });
            let marks = layout.front_marks(TargetId(0), value).unwrap();
            let mut texts = marks.iter().filter_map(|mark| match mark.shape {
                MarkShape::Text { center, size, .. } => Some((center, size)),
                _ => None,
            });
            let (center, size) = texts.next().unwrap();
            for mark in marks.iter().filter(|mark| mark.role == MarkRole::Scale) {
                let MarkShape::Line(points, _) = &mark.shape else {
                    continue;
                };
                let (low, high) = (points[0].min(points[1]), points[0].max(points[1]));
                let beside = (center.clamp(low, high) - center).abs();
                assert!(
                    beside.max_element() > size * 0.5,
                    "{right} {away}: {mark:?}"
                );
            }
        }
    }

    #[test]
    fn the_mark_of_a_knob_turns_with_its_value() {
        let knob = "knobs: [(name: \"k\", at_mm: (0, 0), diameter_mm: 40, range_deg: 270)]";
        let tip = |value| {
            let marks = marks(knob, Some(value));
            let mut lines = marks.iter().filter_map(|mark| match &mark.shape {
                MarkShape::Line(points, _) if mark.role == MarkRole::Value => {
                    points.last().copied()
                }
                _ => None,
            });
            lines.next_back().unwrap()
        };
        assert!(tip(0.5).y > 10.0, "away from the wearer in the middle");
        assert!(tip(0.0).x < -5.0 && tip(1.0).x > 5.0);
    }

    #[test]
    fn the_spring_of_a_wheel_is_seen_on_its_rim() {
        let spring = |control: &str| -> Vec<MarkRole> {
            let marks = marks(control, None);
            let arrows = marks.iter().filter(|mark| match &mark.shape {
                MarkShape::Line(points, _) => points.len() == 3,
                _ => false,
            });
            arrows.map(|mark| mark.role).collect()
        };
        let wheel = "valves: [(name: \"w\", at_mm: (0, 0), diameter_mm: 90, turns: 2.5, initial: 0.5, springs_back: true)]";
        assert_eq!(spring(wheel), [MarkRole::OnHandle; 4]);
        // Around the rim of a dial.
        let dial = "knobs: [(name: \"k\", at_mm: (0, 0), diameter_mm: 40, initial: 0.5, springs_back: true)]";
        assert_eq!(spring(dial), [MarkRole::Scale; 4]);
    }

    #[test]
    fn an_open_menu_has_a_mark_at_its_highlighted_sector_and_the_labels_of_its_nested_menu() {
        let menu = "radial_menus: [(name: \"m\", at_mm: (0, 0), diameter_mm: 60, sectors: [(name: \"up\", tap: Key(\"A\")), \
                    (name: \"down\", menu: [(name: \"far\", tap: Key(\"B\")), (name: \"near\", tap: Key(\"C\"))])])]";
        let drawn = |value: f32| {
            let marks = marks(menu, Some(value));
            let labels: Vec<String> = marks
                .iter()
                .filter_map(|mark| match &mark.shape {
                    MarkShape::Text { text, .. } => Some(text.clone()),
                    _ => None,
                })
                .collect();
            let mut heights = marks.iter().filter_map(|mark| match &mark.shape {
                MarkShape::Line(points, _) if mark.role == MarkRole::Value => {
                    Some(points[points.len() / 2].y)
                }
                _ => None,
            });
            (labels.join(" "), heights.next().map_or(0.0, f32::signum))
        };
        let expected = [
            ("up down m", 0.0),
            ("up down m", 1.0),
            ("up down m", -1.0),
            ("far near down", 0.0),
            ("far near down", 1.0),
            ("far near down", -1.0),
        ];
        for (index, (labels, height)) in expected.into_iter().enumerate() {
            let value = index as f32 / 5.0;
            assert_eq!(drawn(value), (labels.to_owned(), height), "{value}");
        }
    }

    /// Returns the texts of marks, joined, and the rectangles of their lines.
    fn texts(marks: &[FrontMark]) -> (String, Vec<(Vec2, f32)>) {
        let lines = marks.iter().filter_map(|mark| match &mark.shape {
            MarkShape::Text {
                center, size, text, ..
            } => Some((text.clone(), (*center, *size))),
            _ => None,
        });
        let (words, places): (Vec<String>, _) = lines.unzip();
        (words.join(" "), places)
    }

    #[test]
    fn the_number_of_a_value_follows_the_label() {
        let numbered = |controls: &str, value: Option<f32>| {
            let text =
                format!("Layout(name: \"a\", boards: [(pose: (anchor: elbow), {controls})])");
            let layout = Layout::parse(&text, "a.ron").unwrap();
            let marks = layout.numbered_front_marks(TargetId(0), |_| value);
            texts(&marks.unwrap()).0
        };
        let slider = "sliders: [(name: \"Low\", at_mm: (0, 0), length_mm: 100, width_mm: 20, initial: 0.25)]";
        let lever = "levers: [(name: \"Gear\", at_mm: (0, 0), length_mm: 80, width_mm: 20)]";
        let knob = "knobs: [(name: \"Gain\", at_mm: (0, 0), diameter_mm: 40, endless: true)]";
        let pad = "xy_pads: [(name: \"Tilt\", at_mm: (0, 0), size_mm: Box(100, 60))]";
        let toggle = "toggles: [(name: \"Mute\", at_mm: (0, 0), size_mm: Box(20, 20))]";
        for (control, value, expected) in [
            (slider, None, "Low 0.25"),
            (slider, Some(0.756), "Low 0.76"),
            (lever, Some(0.5), "Gear 0.50"),
            (knob, Some(-1.25), "Gain -1.25"),
            (knob, Some(-0.001), "Gain 0.00"),
            (pad, Some(1.0), "Tilt 1.00 1.00"),
            (toggle, Some(1.0), "Mute"),
        ] {
            assert_eq!(numbered(control, value), expected, "{control}");
        }
    }

    #[test]
    fn a_number_stays_in_its_control_and_moves_no_other_mark() {
        for (name, layout) in Layout::shipped().unwrap() {
            for face in layout.controls.iter().flat_map(|control| &control.faces) {
                let plain = layout.front_marks(face.target, |_| Some(0.5)).unwrap();
                let numbered = layout.numbered_front_marks(face.target, |_| Some(0.5));
                let numbered = numbered.unwrap();
                let is_text = |mark: &&FrontMark| matches!(mark.shape, MarkShape::Text { .. });
                let others = |marks: &[FrontMark]| -> Vec<FrontMark> {
                    marks.iter().filter(|it| !is_text(it)).cloned().collect()
                };
                assert_eq!(others(&plain), others(&numbered), "{name}: {}", face.name);
                let half = face.outline.half_extents() * 1e3;
                let half = half.max(Vec2::new(half.y, half.x));
                for (center, size) in texts(&numbered).1 {
                    let reach = center.abs() + Vec2::splat(size / 2.0);
                    assert!(reach.cmple(half).all(), "{name}: {}: {reach}", face.name);
                }
            }
        }
    }

    #[test]
    fn no_line_of_a_mark_leaves_its_control() {
        for (name, layout) in Layout::shipped().unwrap() {
            for face in layout.controls.iter().flat_map(|control| &control.faces) {
                // In millimetres, with the width of a line.
                let half = face.outline.half_extents() * 1e3 + 1.0;
                for value in [0.0, 0.5, 1.0] {
                    let marks = layout.front_marks(face.target, |_| Some(value)).unwrap();
                    let lines = marks.iter().filter_map(|mark| match &mark.shape {
                        MarkShape::Line(points, _) => Some(points),
                        _ => None,
                    });
                    for point in lines.flatten() {
                        let is_inside = point.abs().cmple(half).all();
                        assert!(is_inside, "{name}: {} at {value}: {point}", face.name);
                    }
                }
            }
        }
    }

    #[test]
    fn every_control_of_the_shipped_layouts_has_marks_and_a_label() {
        for (name, layout) in Layout::shipped().unwrap() {
            for face in layout.controls.iter().flat_map(|control| &control.faces) {
                let marks = layout.front_marks(face.target, |_| Some(1.0)).unwrap();
                assert!(marks.len() >= 2, "{name}: {}", face.name);
                assert!(
                    marks.iter().any(|mark| mark.role == MarkRole::Label),
                    "{name}: {}",
                    face.name
                );
            }
            for key in &layout.keys {
                assert_eq!(layout.front_marks(key.face.target, |_| None), None);
            }
        }
    }
}
