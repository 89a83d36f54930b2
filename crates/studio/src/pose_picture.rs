//! A picture of the hand in a calibration pose, in the style of the 3D view.

use parry3d::math::{Vec2, Vec3};

use super::camera::{Camera, Viewpoint};
use super::picture::Picture;
use super::scene::{self, SceneColors};
use ademan_core::calibrate::CalibrationPose;
use ademan_core::estimate::Estimate;
use ademan_core::hand::{Dof, Joint, Side};
use ademan_core::kinematics::{ArmModel, BoneLengths, HandPose};
use ademan_core::time::Timestamp;

/// Lengths of hand and forearm of the drawn person, in metres: the median of adults.
const LENGTHS: (f64, f64) = (0.189, 0.262);

/// The part of the forearm that is in the picture of a pose of the hand.
const FOREARM: f32 = 0.35;

/// A hand in a calibration pose.
pub struct PosePicture {
    pose: HandPose,
    shows_arm: bool,
}

impl PosePicture {
    /// Creates the picture of a pose of the hand of this side.
    pub fn new(pose: CalibrationPose, side: Side) -> Option<Self> {
        let bones = BoneLengths::from_hand_and_forearm(LENGTHS.0, LENGTHS.1).ok()?;
        let arm = ArmModel::anthropometric(side, &bones).ok()?;
        Some(Self {
            pose: arm.forward(&Estimate::new(Timestamp(0), pose.angles())),
            shows_arm: pose.defines(Dof::ElbowFlexion),
        })
    }

    /// Returns the position from which the fingers are seen best: above, or below the fingers of a fist.
    pub fn finger_viewpoint(&self) -> Viewpoint {
        use Joint::{MiddlePhalanxProximal, MiddleTip, Wrist};
        let joints = [Wrist, MiddlePhalanxProximal, MiddleTip];
        match joints.map(|joint| self.pose.position(joint)) {
            [Some(wrist), Some(knuckle), Some(tip)]
                if wrist.distance(tip) < wrist.distance(knuckle) =>
            {
                Viewpoint::Below
            }
            _ => Viewpoint::Above,
        }
    }

    /// Draws the hand from a named position on a picture of this size.
    pub fn draw(&self, viewpoint: Viewpoint, size: Vec2, colors: &SceneColors) -> Picture {
        let mut camera = Camera::default();
        let aspect = size.x / size.y.max(1.0);
        camera.frame(&self.points(), 0.0, viewpoint, aspect);
        scene::draw_hand(&self.pose, &camera, size, colors)
    }

    /// Returns the points that the picture shows: the hand and the near end of the forearm, or the whole arm.
    fn points(&self) -> Vec<Vec3> {
        let is_arm = |joint: Joint| matches!(joint, Joint::Shoulder | Joint::Elbow);
        let known = self.pose.known();
        let joints = known.filter(|(joint, _)| self.shows_arm || !is_arm(*joint));
        let mut points: Vec<Vec3> = joints.map(|(_, pose)| pose.translation).collect();
        let ends = [Joint::Wrist, Joint::Elbow].map(|joint| self.pose.position(joint));
        if let [Some(wrist), Some(elbow)] = ends {
            points.push(wrist.lerp(elbow, FOREARM));
        }
        points
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pose_is_drawn_within_the_picture_and_unlike_the_flat_hand() {
        let size = Vec2::new(400.0, 300.0);
        let draw = |pose, viewpoint| {
            let picture = PosePicture::new(pose, Side::Right).unwrap();
            let drawn = picture.draw(viewpoint, size, &SceneColors::LIGHT);
            drawn.skin.expect("a hand")
        };
        let flat = draw(CalibrationPose::Flat, Viewpoint::Side);
        for &pose in CalibrationPose::GUIDED {
            for viewpoint in [Viewpoint::Above, Viewpoint::Below, Viewpoint::Side] {
                let image = draw(pose, viewpoint);
                let opaque = image.pixels.iter().filter(|color| color.0[3] > 250);
                let count = opaque.count();
                assert!(count > 4_000, "{pose} {viewpoint:?}: {count} pixels");
            }
        }
        let fist = draw(CalibrationPose::Fist, Viewpoint::Side);
        assert_ne!(fist, flat);
    }

    #[test]
    fn only_the_fingers_of_a_fist_are_seen_from_below() {
        for &pose in CalibrationPose::GUIDED {
            let picture = PosePicture::new(pose, Side::Left).unwrap();
            let is_below = picture.finger_viewpoint() == Viewpoint::Below;
            assert_eq!(is_below, pose == CalibrationPose::Fist, "{pose}");
        }
    }
}
