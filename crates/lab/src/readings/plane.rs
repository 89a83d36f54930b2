//! The plainest way to detect taps: a fingertip passes the front of a key.

use parry3d::math::{Vec2, Vec3};

use super::keyboard::{KeyPlaces, write};
use crate::contact::TargetId;
use crate::contact::surface::{Scene, Shape, Surface, Target};
use crate::hand::{Finger, Side};
use crate::kinematics::HandPose;

/// The place of a fingertip in the last step, by hand, finger and board: in the frame of the nearest target.
type Last = Option<(TargetId, Vec3)>;

/// A detector that presses a key when the pad of a fingertip passes its front from above, within its outline, without filters or
/// hysteresis.
#[derive(Debug)]
pub(crate) struct PlaneCrossing {
    last: Vec<[Last; Finger::COUNT]>,
    text: String,
}

impl PlaneCrossing {
    /// Creates a detector for a number of boards.
    pub(crate) fn new(boards: usize) -> Self {
        Self {
            last: vec![[None; Finger::COUNT]; 2 * boards],
            text: String::new(),
        }
    }

    /// Looks at a hand.
    pub(crate) fn see(&mut self, scene: &Scene, keys: &KeyPlaces, side: Side, pose: &HandPose) {
        let boards = scene.surfaces().len();
        for (board, surface) in scene.surfaces().iter().enumerate() {
            let is_own = surface.side().is_none_or(|own| own == side);
            let Some(world_from_surface) = surface.world_from_surface(pose).filter(|_| is_own)
            else {
                continue;
            };
            for &finger in Finger::ALL {
                let Some(tip) = pose.fingertip(finger) else {
                    continue;
                };
                let tip = world_from_surface.inverse_transform_point(tip);
                let Some((id, target)) = nearest(surface, tip) else {
                    continue;
                };
                let pad = target.surface_from_target.inverse_transform_point(tip)
                    - Vec3::Z * pose.tip_radius;
                let hand = usize::from(side == Side::Left);
                let last = &mut self.last[hand * boards + board][finger.index()];
                let before = last.replace((id, pad));
                let passed = before.filter(|(_, before)| before.z > 0.0 && pad.z <= 0.0);
                let Some((_, above)) = passed else { continue };
                // Of two frames, if the nearest target has changed; they differ by less than a key then.
                let is_same = last.is_some_and(|(now, _)| before_id(passed) == Some(now));
                let part = above.z / (above.z - pad.z);
                let at = if is_same {
                    above.truncate().lerp(pad.truncate(), part)
                } else {
                    pad.truncate()
                };
                if is_inside(target, at)
                    && let Some(touch) = keys.touch(id, at)
                {
                    write(&mut self.text, touch.character);
                }
            }
        }
    }

    /// Returns the text.
    pub(crate) fn into_text(self) -> String {
        self.text
    }
}

fn before_id(last: Last) -> Option<TargetId> {
    last.map(|(id, _)| id)
}

fn nearest(surface: &Surface, tip: Vec3) -> Option<(TargetId, &Target)> {
    let distance = |target: &Target| target.surface_from_target.translation.distance_squared(tip);
    let targets = surface.targets();
    targets.min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)))
}

fn is_inside(target: &Target, at: Vec2) -> bool {
    match target.shape {
        Shape::Box(half) => at.abs().cmple(half).all(),
        Shape::Disc(radius) => at.length() <= radius,
    }
}
