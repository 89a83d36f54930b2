//! Marks of fingertips: rings on the boards below them, and their trails.

use parry3d::math::Vec3;

use super::Canvas;
use crate::model::StudioModel;
use crate::trails::{SECONDS, Trail};
use ademan_core::hand::Finger;
use ademan_core::kinematics::HandPose;

/// Height of a fingertip over a board below which its ring is drawn, in metres.
const RING_HEIGHT: f32 = 0.06;

/// Radius of the ring of a fingertip that touches, in metres.
const RING_RADIUS: f32 = 0.004;

/// Radius that a ring gains per metre of height.
const RING_GROWTH: f32 = 0.35;

/// Width of a trail, in points.
const TRAIL_WIDTH: f32 = 1.2;

/// Opacity of a trail at the fingertip.
const TRAIL_OPACITY: f32 = 0.6;

/// Adds a ring on the board below each fingertip that is near it. It shrinks as the fingertip comes down.
pub(super) fn add_rings(canvas: &mut Canvas, model: &StudioModel, pose: &HandPose) {
    for index in 0..model.view.layout.boards.len() {
        let Some(world_from_board) = model.world_from_board(index) else {
            continue;
        };
        for tip in Finger::ALL
            .iter()
            .filter_map(|&finger| pose.fingertip(finger))
        {
            let on_board = world_from_board.inverse_transform_point(tip);
            let height = (on_board.z - pose.tip_radius).max(0.0);
            if height > RING_HEIGHT || on_board.z < -RING_HEIGHT {
                continue;
            }
            let below = world_from_board * Vec3::new(on_board.x, on_board.y, 0.0);
            let Some(center) = canvas.project(below) else {
                continue;
            };
            let radius = (RING_RADIUS + RING_GROWTH * height) * center.scale;
            let opacity = 0.9 * (1.0 - height / RING_HEIGHT);
            let color = canvas.colors.ring.with_opacity(opacity);
            canvas
                .picture
                .marks
                .add_ring(center.position, radius, 1.6, color);
        }
    }
}

/// Adds the path of a fingertip, which fades with its age.
pub(super) fn add_trail(canvas: &mut Canvas, trail: &Trail) {
    let points: Vec<_> = trail
        .iter()
        .filter_map(|(age, point)| Some((age, canvas.project(point)?.position)))
        .collect();
    let color = canvas.colors.ring;
    for pair in points.windows(2) {
        let [(from_age, from), (to_age, to)] = [pair[0], pair[1]];
        let fade = |age: f32| color.with_opacity(TRAIL_OPACITY * (1.0 - age / SECONDS));
        let ends = [(from, fade(from_age)), (to, fade(to_age))];
        canvas.picture.marks.add_line(ends, TRAIL_WIDTH);
    }
}
