//! Sliders, and the drawing of sliders and levers.

use std::f32::consts::FRAC_PI_2;

use parry3d::math::Vec2;
use serde::Deserialize;

use super::value_output::{ValueOutputSchema, kept_output};
use super::{ControlModel, Front, Handle, KindSpec};
use crate::contact::surface::DRAG_MARGIN;
use crate::device::slider::{GrabMode, Slider, Track};
use crate::document::{DocumentError, Spanned, schema};
use crate::layout::builder::{FaceSpec, LayoutBuilder};
use crate::layout::model::{ControlKind, Face};
use crate::layout::quantity::{Fraction, Offset, Rotation, Size, Steps};
use crate::layout::render::drawing::{Canvas, Placement, Words, draw_label, draw_outline};
use crate::layout::schema::{Label, OutlineSchema};

/// The kind, for editors.
pub(crate) const KIND: KindSpec = KindSpec {
    table: "Slider",
    name: "slider",
    words: ["Slider", "Deslizador"],
    new: r#"(name: "Slider", at_mm: AT, length_mm: 60)"#,
};

schema! {
    /// A slider along a straight track.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "Slider", deny_unknown_fields)]
    pub(in crate::layout) struct SliderSchema<'a> {
        /// Name.
        #[serde(borrow)]
        name: Spanned<'a>,
        /// Text drawn on it. Default: the name.
        #[serde(default)]
        label: Option<Label>,
        /// Center of the track.
        at_mm: (Offset, Offset),
        /// Length of the track; its ends are 0 and 1.
        length_mm: Size,
        /// Width of the track.
        #[serde(default)]
        width_mm: Size,
        /// Direction of the track, counter-clockwise: 0 points to the right, 90 away from you.
        #[serde(default)]
        rotation_deg: Rotation,
        /// Reaction of the handle to a press.
        #[serde(default)]
        grab: GrabModeSchema,
        /// Number of steps. A hysteresis of a tenth of a step prevents flicker between two steps. Default: continuous.
        #[serde(default)]
        steps: Option<Steps>,
        /// Initial value. Default: 0.
        #[serde(default)]
        initial: Option<Fraction>,
        /// Output of the value. Default: none.
        #[serde(borrow, default)]
        output: Option<ValueOutputSchema<'a>>,
    }
}

schema! {
    /// The reaction of a handle to a press.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
    #[serde(rename = "GrabMode")]
    enum GrabModeSchema {
        /// The handle jumps to the finger.
        #[default]
        Absolute,
        /// The handle moves as far as the finger.
        Relative,
    }
}

impl<'a> SliderSchema<'a> {
    /// Adds the slider to the current board.
    pub fn build(&self, builder: &mut LayoutBuilder<'a>) -> Result<(), DocumentError> {
        let output = kept_output(builder, self.output)?;
        let half_length = builder.board().metres(self.length_mm.get()) / 2.0;
        let spec = FaceSpec {
            rotation: self.rotation_deg.get().to_radians() as f32,
            size: OutlineSchema::Box(self.length_mm, self.width_mm),
            margin: DRAG_MARGIN,
            ..builder.face_spec("slider", self.name, &self.label, self.at_mm)
        };
        builder.add_single_face(spec, |target| {
            ControlKind::Slider(Slider {
                target,
                half_length,
                track: Track::Straight,
                grab: match self.grab {
                    GrabModeSchema::Absolute => GrabMode::Absolute,
                    GrabModeSchema::Relative => GrabMode::Relative,
                },
                steps: self.steps.map(|steps| steps.get() as u16),
                initial: self.initial.map_or(0.0, |initial| initial.get() as f32),
                springs_back: false,
                output,
            })
        })
    }
}

impl ControlModel for Slider {
    fn handle(&self) -> Handle {
        Handle::Line {
            half_length: self.half_length,
        }
    }

    fn initial_value(&self, _: usize) -> Option<f32> {
        Some(self.initial)
    }

    fn set_value(&mut self, _: usize, value: f32) {
        self.initial = value;
    }

    fn describe(&self, words: &Words) -> Vec<String> {
        let (kind, unit) = match self.track {
            Track::Straight => ("slider".to_owned(), "steps"),
            Track::Hinged(throw) => (format!("lever, {:.0}°", throw.to_degrees()), "detents"),
        };
        let steps = self.steps.map(|steps| format!(", {steps} {unit}"));
        let spring = if self.springs_back {
            ", springs back"
        } else {
            ""
        };
        let output = words.value_output(self.output);
        vec![format!(
            "{kind}{}{spring}{output}",
            steps.unwrap_or_default()
        )]
    }

    fn draw(&self, front: &Front, canvas: &mut Canvas) {
        draw_slider(self, front.face, canvas);
    }
}

/// The maximum height of a line of text, in millimetres.
const MAX_STRIP: f32 = 5.0;

/// The largest number of steps with a mark each.
const MAX_TICKS: u16 = 50;

/// Draws a track along X with its handle.
fn draw_slider(slider: &Slider, face: &Face, canvas: &mut Canvas) {
    let half = face.outline.half_extents() * 1e3;
    draw_outline("well", &face.outline, 0.0, canvas);
    let strip = (half.y * 0.6).min(MAX_STRIP).min(half.x * 0.5);
    // The label is upright to within an eighth of a turn: beside a track along it, or at the near end of one across it.
    let quarter_turns = (face.outline.rotation / FRAC_PI_2).round();
    let is_across = quarter_turns.rem_euclid(2.0) == 1.0;
    let down = if quarter_turns.rem_euclid(4.0) >= 2.0 {
        -1.0
    } else {
        1.0
    };
    let (lane, room) = if is_across {
        (0.0, half.y)
    } else {
        (-down * strip * 0.5, half.y - strip * 0.5)
    };
    let handle = handle_half(slider, half, room);
    let margin = handle.x + 1.0;
    let mut ends = [-half.x + margin, half.x - margin];
    if is_across {
        let label_at = Vec2::X * -down * (half.x - strip * 0.5 - 0.8);
        let label_room = Vec2::new(half.y - 0.8, strip / 2.0);
        draw_turned_label(face, label_at, label_room, canvas);
        ends[usize::from(down < 0.0)] += down * strip;
    } else {
        let label_at = Vec2::Y * down * (half.y - strip * 0.5 - 0.4);
        let label_room = Vec2::new(half.x - 1.2, strip / 2.0);
        draw_turned_label(face, label_at, label_room, canvas);
    }
    let track = DrawnTrack { ends, lane, room };
    track.draw_groove(slider, canvas);
    track.draw_handle(slider, handle, canvas);
}

/// Returns half the length along the track and half the width of a handle.
fn handle_half(slider: &Slider, half: Vec2, room: f32) -> Vec2 {
    let length = (room * 0.36).min(half.x * 0.16).min(4.0);
    match slider.track {
        Track::Straight => Vec2::new(length, room * 0.72),
        Track::Hinged(_) => Vec2::splat((room * 0.72).min(length * 1.7)),
    }
}

/// A track on its front, in millimetres.
struct DrawnTrack {
    /// The positions of the values 0 and 1 along X.
    ends: [f32; 2],
    /// The position of the track along Y.
    lane: f32,
    /// Half of the width for ticks and handle.
    room: f32,
}

impl DrawnTrack {
    fn draw_groove(&self, slider: &Slider, canvas: &mut Canvas) {
        let [low, high] = self.ends;
        let center = Vec2::new((low + high) / 2.0, self.lane);
        let (class, width) = match slider.track {
            Track::Straight => ("groove", (self.room * 0.12).clamp(0.3, 1.1)),
            Track::Hinged(_) => ("slot", self.room * 0.3),
        };
        let half = Vec2::new((high - low) / 2.0 + width, width);
        canvas.rect(class, center, half, width);
        let Some(steps) = slider.steps.filter(|steps| *steps <= MAX_TICKS) else {
            return;
        };
        for step in 0..=steps {
            let x = self.position(slider, f32::from(step) / f32::from(steps));
            for side in [-1.0, 1.0] {
                let tick = [0.6, 0.85].map(|y| Vec2::new(x, self.lane + side * y * self.room));
                canvas.line("tick", tick);
            }
        }
    }

    /// Draws the handle; a lever has a ball on an arm from the hinge.
    fn draw_handle(&self, slider: &Slider, half: Vec2, canvas: &mut Canvas) {
        let at = Vec2::new(self.position(slider, slider.initial), self.lane);
        match slider.track {
            Track::Straight => {
                canvas.rect("metal", at, half, half.x * 0.45);
                let notch = [-0.75, 0.75].map(|y| at + Vec2::Y * y * half.y);
                canvas.line("on-metal", notch);
            }
            Track::Hinged(_) => {
                let hinge = Vec2::new((self.ends[0] + self.ends[1]) / 2.0, self.lane);
                canvas.circle("metal", hinge, half.y * 0.4);
                canvas.line("spoke", [hinge, at]);
                canvas.circle("metal", at, half.y);
                canvas.circle("on-metal", at, half.y * 0.55);
                if slider.springs_back {
                    self.draw_spring(at, half.y, canvas);
                }
            }
        }
    }

    /// Draws arrows along the track toward the position to which a spring returns the handle, from each side that has room.
    fn draw_spring(&self, at: Vec2, radius: f32, canvas: &mut Canvas) {
        let [low, high] = self.ends;
        for side in [-1.0, 1.0] {
            let tips = [1.5, 1.9].map(|distance| at + Vec2::X * side * radius * distance);
            if tips.iter().any(|tip| tip.x < low || tip.x > high) {
                continue;
            }
            for tip in tips {
                let wings = [-1.0, 1.0].map(|y| tip + Vec2::new(side * 0.35, y * 0.35) * radius);
                canvas.polyline("icon", &[wings[0], tip, wings[1]]);
            }
        }
    }

    fn position(&self, slider: &Slider, value: f32) -> f32 {
        let [low, high] = self.ends;
        let t = (slider.track.position(value) + 1.0) / 2.0;
        low + (high - low) * t.clamp(0.0, 1.0)
    }
}

fn draw_turned_label(face: &Face, at: Vec2, half: Vec2, canvas: &mut Canvas) {
    let mut label = Canvas::default();
    draw_label("label", &face.label, Vec2::ZERO, half, &mut label);
    let quarter_turns = (face.outline.rotation / FRAC_PI_2).round();
    let placement = Placement {
        degrees: quarter_turns * 90.0,
        ..Placement::at(at)
    };
    canvas.group(placement, None, &label);
}
