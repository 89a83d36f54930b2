//! The other hand of a person with one hand in the setup: it rests beside what the first hand touches, and touches nothing.

use parry3d::math::{Pose, Rot3, Vec3};

use super::{bearing, points_to_touch};
use crate::model::StudioModel;
use ademan_core::hand::{Finger, Joint, Side};
use ademan_core::kinematics::HandPose;

/// Distance of the joints of the hand from the nearest key beside it, in metres: the skin around them and some room.
const GAP_M: f32 = 0.05;

/// Returns the hand where it rests beside all boards and targets whose place is known, on its own side of them: its forearm points
/// forward as seen by the wearer, and its index fingertip is at the middle of their depth and height. It stays where it is if there
/// are none.
pub fn beside(model: &StudioModel, hand: &HandPose) -> HandPose {
    let touched = points_to_touch(model);
    let (Some(tip), Some(elbow), Some(wrist), false) = (
        hand.fingertip(Finger::Index),
        hand.position(Joint::Elbow),
        hand.position(Joint::Wrist),
        touched.is_empty(),
    ) else {
        return *hand;
    };
    let bearing = bearing(model);
    let forearm = wrist - elbow;
    let heading = (-forearm.x).atan2(-forearm.z);
    let turn = Rot3::from_rotation_y(bearing - heading);
    let outward = match hand.side {
        Side::Right => Vec3::X,
        Side::Left => Vec3::NEG_X,
    };
    let outward = Rot3::from_rotation_y(bearing) * outward;
    // Relative to the tip, which then is where it would touch the middle of everything.
    let joints = hand
        .known()
        .filter(|(joint, _)| *joint != Joint::Shoulder)
        .map(|(_, pose)| turn * (pose.translation - tip));
    let inner = joints.map(|joint| -joint.dot(outward));
    let inner = inner.fold(f32::MIN, f32::max);
    let middle = middle(&touched);
    let edge = touched.iter().map(|point| (point - middle).dot(outward));
    let edge = edge.fold(f32::MIN, f32::max);
    let at = middle + outward * (edge + GAP_M + inner);
    let mut moved = *hand;
    for (joint, pose) in hand.known() {
        let position = at + turn * (pose.translation - tip);
        moved.set(joint, Pose::from_parts(position, turn * pose.rotation));
    }
    moved
}

/// Returns the middle of the box around points.
fn middle(points: &[Vec3]) -> Vec3 {
    let low = points.iter().copied().fold(Vec3::MAX, Vec3::min);
    let high = points.iter().copied().fold(Vec3::MIN, Vec3::max);
    low.midpoint(high)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::camera::{Camera, Viewpoint};
    use crate::scene::tests::model_of;
    use crate::scene::{SceneColors, SceneOptions, bearing, draw, points_of_interest};
    use ademan_core::kinematics::{ArmModel, BoneLengths};
    use ademan_core::layout::Layout;
    use ademan_lab::sim::PointerHand;
    use ademan_runtime::files::Load;
    use parry3d::math::Vec2;

    /// Returns a layout below the resting hand of a side, and the other hand beside it.
    fn scene(layout: &str, side: Side) -> (StudioModel, HandPose) {
        let bones = BoneLengths::from_hand_and_forearm(0.19, 0.26).unwrap();
        let rest = |own| PointerHand::new(&ArmModel::anthropometric(own, &bones).unwrap()).pose();
        let mut model = model_of(Arc::new(Layout::load(layout).unwrap()));
        model.poses[side.index()] = Some(rest(side));
        let other = beside(&model, &rest(side.opposite()));
        (model, other)
    }

    #[test]
    fn the_other_hand_rests_on_its_own_side_of_every_key_and_points_forward() {
        for layout in ["qwerty-flat", "mixer", "piano", "numpad"] {
            for side in [Side::Right, Side::Left] {
                let (model, hand) = scene(layout, side);
                let right = Rot3::from_rotation_y(bearing(&model)) * Vec3::X;
                let outward = if side == Side::Right { -right } else { right };
                let keys = points_to_touch(&model);
                assert!(!keys.is_empty(), "{layout}");
                let edge = keys.iter().map(|key| key.dot(outward));
                let edge = edge.fold(f32::MIN, f32::max);
                let joints = hand.known().filter(|(joint, _)| *joint != Joint::Shoulder);
                let nearest = joints.map(|(_, pose)| pose.translation.dot(outward));
                let gap = nearest.fold(f32::MAX, f32::min) - edge;
                assert!((gap - GAP_M).abs() < 1e-4, "{layout}: {gap}");
                let joint = |joint| hand.position(joint).unwrap();
                let forearm = joint(Joint::Wrist) - joint(Joint::Elbow);
                assert!(forearm.dot(right).abs() < 1e-4, "{layout}: {forearm}");
            }
        }
    }

    #[test]
    fn no_pixel_of_the_other_hand_is_over_a_key() {
        for layout in ["qwerty-flat", "mixer", "piano"] {
            let (mut model, hand) = scene(layout, Side::Right);
            model.resting = Some(hand);
            let size = Vec2::new(900.0, 500.0);
            let mut camera = Camera::default();
            let points = points_of_interest(&model);
            camera.frame(&points, bearing(&model), Viewpoint::Eye, size.x / size.y);
            let keys = points_to_touch(&model).into_iter();
            let keys = keys.filter_map(|key| Some(camera.project(key, size)?.position));
            let keys: Vec<Vec2> = keys.collect();
            let low = keys.iter().copied().fold(Vec2::MAX, Vec2::min);
            let high = keys.iter().copied().fold(Vec2::MIN, Vec2::max);
            // The other hand alone.
            model.poses = [None; Side::COUNT];
            let options = SceneOptions::default();
            let picture = draw(&model, &camera, size, &SceneColors::DARK, options);
            let skin = picture.skin.expect("the hand is in the picture");
            let [left, right] = skin.corners;
            let [width, height] = skin.size;
            let scale = (right - left) / Vec2::new(width as f32, height as f32);
            for (index, color) in skin.pixels.iter().enumerate() {
                let pixel = Vec2::new((index % width) as f32, (index / width) as f32);
                let at = left + pixel * scale;
                let is_over = at.cmpge(low).all() && at.cmple(high).all();
                assert!(!is_over || color.0[3] == 0, "{layout}: {at}");
            }
        }
    }
}
