//! Labels that lie on the fronts of keys.

use parry3d::math::{Pose, Vec2, Vec3};

use super::Canvas;
use super::boards::half_extents;
use crate::fonts::{Fitted, fitted};
use crate::picture::{Color, Label, with_known_signs};
use ademan_core::contact::surface::Target;

/// The room of a label, as a part of the width and height of its front.
const ROOM: f32 = 0.85;

/// The largest label as a part of the height of its front, and in metres.
const MAX_PART: f32 = 0.55;
const MAX_LABEL: f32 = 0.009;

/// The smallest label that can be read, in points. The strokes of a smaller one are thinner than half a pixel.
const MIN_LABEL_PT: f32 = 6.0;

/// The mean direction of the labels of a board, as its cosine, from which they have the same quarter turn.
const ALIKE: f32 = 0.5;

/// The direction of a label, as its cosine, up to which it has the quarter turn of its board: the others are upside down.
const UPSIDE_DOWN: f32 = -0.2;

/// A quarter turn of a label on its front.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Turn {
    None,
    Left,
    Half,
    Right,
}

const TURNS: [Turn; 4] = [Turn::None, Turn::Left, Turn::Half, Turn::Right];

/// The axes of a front on the screen, in points per metre.
#[derive(Clone, Copy, Debug)]
struct Axes {
    x: Vec2,
    y: Vec2,
}

impl Axes {
    /// Returns the axes in the middle of a front. `None` if they are behind the eye.
    fn new(canvas: &Canvas, target: &Target, front: &Pose) -> Option<Self> {
        let reach = half_extents(target).min_element();
        let direction = |axis: Vec3| {
            let way = front.rotation * axis * reach;
            let ahead = canvas.project(front.translation + way)?;
            let behind = canvas.project(front.translation - way)?;
            Some((ahead.position - behind.position) / (2.0 * reach))
        };
        Some(Self {
            x: direction(Vec3::X)?,
            y: direction(Vec3::Y)?,
        })
    }

    /// Returns the directions to the right and down of a label with a turn.
    fn turned(self, turn: Turn) -> (Vec2, Vec2) {
        let Self { x, y } = self;
        match turn {
            Turn::None => (x, -y),
            Turn::Left => (y, x),
            Turn::Half => (-x, y),
            Turn::Right => (-y, -x),
        }
    }

    /// Returns how far a label with a turn runs to the right of the screen: 1 if it does, −1 if it is upside down.
    fn rightward(self, turn: Turn) -> f32 {
        let (right, _) = self.turned(turn);
        right.x / right.length().max(1e-6)
    }

    /// Returns the turn in which a label is upright.
    fn upright(self) -> Turn {
        most_upright(|turn| self.rightward(turn)).0
    }
}

/// Returns the turn with the largest cosine, and that.
fn most_upright(rightward: impl Fn(Turn) -> f32) -> (Turn, f32) {
    let turns = TURNS.map(|turn| (turn, rightward(turn)));
    let best = turns.into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
    best.unwrap_or((Turn::None, 0.0))
}

/// Returns the turn of the labels of a board, so that neighbors do not differ: in it, most are upright. `None` if the fronts
/// point in all directions.
pub(super) fn board_turn<'a>(
    canvas: &Canvas,
    fronts: impl Iterator<Item = (&'a Target, &'a Pose)>,
) -> Option<Turn> {
    let axes = fronts.filter_map(|(target, front)| Axes::new(canvas, target, front));
    let axes: Vec<Axes> = axes.collect();
    let (turn, sum) = most_upright(|turn| axes.iter().map(|it| it.rightward(turn)).sum());
    (sum >= ALIKE * axes.len() as f32).then_some(turn)
}

/// Adds the label of a front, which lies on it with the turn of its board. It has a turn of its own if it were upside down.
pub(super) fn add_label(
    canvas: &mut Canvas,
    (text, color): (&str, Color),
    (target, front): (&Target, &Pose),
    board_turn: Option<Turn>,
) {
    let (Some(center), Some(axes)) = (
        canvas.project(front.translation),
        Axes::new(canvas, target, front),
    ) else {
        return;
    };
    let turn = board_turn.filter(|&turn| axes.rightward(turn) > UPSIDE_DOWN);
    let turn = turn.unwrap_or_else(|| axes.upright());
    let half = half_extents(target);
    let extent = 2.0
        * match turn {
            Turn::None | Turn::Half => half,
            Turn::Left | Turn::Right => Vec2::new(half.y, half.x),
        };
    let largest = (MAX_PART * extent.y).min(MAX_LABEL);
    let Fitted { text, size } = fitted(with_known_signs(text), ROOM * extent, largest);
    let (right, down) = axes.turned(turn);
    if size * down.length().min(right.length()) >= MIN_LABEL_PT {
        canvas.picture.labels.push(Label {
            position: center.position,
            right: right * size,
            down: down * size,
            color,
            text,
        });
    }
}
