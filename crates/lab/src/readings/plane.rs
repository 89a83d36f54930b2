//! The plainest way to detect taps: a fingertip passes the front of a key.

use parry3d::math::{Vec2, Vec3};

use super::keyboard::{KeyPlaces, Touch, nearest_target, write};
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
                let Some((id, target)) = with_nearest_center(surface, tip) else {
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
                // The end of a wide key may be nearer to the center of another one.
                let on_surface = target.surface_from_target * at.extend(0.0);
                if let Some(touch) = touch_at(surface, keys, on_surface) {
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

/// Returns the tap of the key whose outline holds a point of a surface.
fn touch_at(surface: &Surface, keys: &KeyPlaces, point: Vec3) -> Option<Touch> {
    let id = nearest_target(surface, point)?;
    let target = surface.target(id)?;
    let at = target.surface_from_target.inverse_transform_point(point);
    let at = at.truncate();
    is_inside(target, at).then(|| keys.touch(id, at)).flatten()
}

fn with_nearest_center(surface: &Surface, tip: Vec3) -> Option<(TargetId, &Target)> {
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

#[cfg(test)]
mod tests {
    use parry3d::math::{Pose, Rotation};

    use super::*;
    use crate::document::Document;
    use crate::hand::Joint;
    use crate::layout::Layout;
    use crate::time::Timestamp;

    #[test]
    fn a_tap_on_the_end_of_a_wide_key_types_it() {
        let document = Document::shipped("qwerty-flat").expect("a shipped layout");
        let layout = Layout::from_document(document).expect("a layout");
        let keys = KeyPlaces::new(&layout, false);
        let space = layout.key("Space").expect("a key").face.target;
        let (surface, target) = layout.scene.target(space).expect("a target");
        let mut detector = PlaneCrossing::new(layout.boards.len());
        for height in [0.005, -0.002] {
            let mut pose = HandPose::new(Timestamp(0), Side::Right, 0.005);
            pose.set(Joint::Elbow, Pose::IDENTITY);
            let world_from_surface = surface.world_from_surface(&pose).expect("a place");
            // Below C: the center of C is nearer than the center of the space bar.
            let pad = Vec3::new(-0.04, 0.0, height + pose.tip_radius);
            let tip = world_from_surface * (target.surface_from_target * pad);
            let world_from_tip = Pose::from_parts(tip, Rotation::IDENTITY);
            pose.set(Joint::tip(Finger::Index), world_from_tip);
            detector.see(&layout.scene, &keys, Side::Right, &pose);
        }
        assert_eq!(detector.into_text(), " ");
    }
}
