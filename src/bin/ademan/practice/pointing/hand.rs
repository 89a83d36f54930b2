//! The simulated hand of a pointing lesson.

use std::fmt::Write;

use ademan::contact::surface::Anchor;
use ademan::device::pointer::mode::HandPoint;
use ademan::device::pointer::{ClickMethod, PointerSettings, PointingMode};
use ademan::hand::Joint;
use ademan::layout::Layout;
use ademan::message::escape;
use parry3d::math::Vec3;

use super::task::{SCREEN, TARGETS, target};
use crate::failure::Failure;

/// Time of a movement from target to target and of a push, in milliseconds.
const MOVE_MS: u32 = 600;
const PUSH_MS: u32 = 150;

/// Rest after each of them: a push begins at rest.
const REST_MS: u32 = 200;

/// Additional depth of a push, so that it clicks in spite of the filter, in metres.
const PUSH_MARGIN: f32 = 0.013;

/// Returns the script of a hand that points at each target and pushes forward. It does so where the fingertip is the pointer only.
pub fn script(layout: &Layout) -> Result<String, Failure> {
    let no_hand = || {
        Failure::wrong_use(format!(
            "the simulated hand cannot point on `{}`; choose `--layout direct`, or name a source with `--source`",
            escape(&layout.name)
        ))
    };
    let pointer = layout.pointer.as_ref().ok_or_else(no_hand)?;
    let PointingMode::Direct(direct) = &pointer.mode else {
        return Err(no_hand());
    };
    let depth = push_depth(pointer).ok_or_else(no_hand)?;
    let follows_tip = direct.point == HandPoint::Index;
    if !follows_tip || direct.frame.anchor != Anchor::Joint(Joint::Elbow) {
        return Err(no_hand());
    }
    let mut script = String::new();
    for click in 0..=TARGETS {
        let [x, y] = target(click);
        let right = (x / SCREEN[0] - 0.5) as f32 * direct.size.x;
        let up = (0.5 - y / SCREEN[1]) as f32 * direct.size.y;
        for (forward, milliseconds) in [
            (0.0, MOVE_MS),
            (depth + PUSH_MARGIN, PUSH_MS),
            (0.0, PUSH_MS),
        ] {
            let local = Vec3::new(right, up, -forward);
            let point = direct.frame.anchor_from_frame.transform_point(local) * 1e3;
            let _ = writeln!(
                script,
                "point {:.1} {:.1} {:.1} {milliseconds}; wait {REST_MS}",
                point.x, point.y, point.z
            );
        }
    }
    Ok(script)
}

/// Returns the depth of the push that clicks, in metres.
fn push_depth(pointer: &PointerSettings) -> Option<f32> {
    pointer.clicks.iter().find_map(|(method, _)| match method {
        ClickMethod::Push(depth) => Some(*depth),
        ClickMethod::Gesture(_) => None,
    })
}
