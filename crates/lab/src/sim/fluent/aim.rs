//! The way from a target to a posture, as a person learns it by looking at the hand that the pipeline shows.

use parry3d::math::{Pose, Vec2, Vec3};

use super::hand::FluentHand;
use crate::capture::Reading;
use crate::contact::TargetId;
use crate::contact::surface::{Anchor, Scene, Surface};
use crate::hand::{Finger, Joint};
use crate::kinematics::HandPose;
use crate::sim::effector::{Effector, Limb};
use crate::time::Timestamp;

/// Looks at the shown hand while a person learns to touch a target.
const LOOKS: usize = 8;
/// The height above the keys at which another finger presses nothing while one is at the end of its travel, in metres: strokes go deeper.
const CLEARANCE: f32 = 0.015;
/// The distance from the centers of all keys at which another finger is beside the board, in metres.
const BESIDE: f32 = 0.03;
/// Steps of the coordinates of an axis within a length of 1.
const AXIS_STEPS: f32 = 1e5;

/// Experience of a person with a target and a finger.
#[derive(Clone, Debug)]
pub(super) struct Aim {
    /// The posture at the center of the target, pressed.
    pub(super) base: Vec<f64>,
    effector: Effector,
    /// The pose of what the board is anchored to, in that posture.
    world_from_anchor: Pose,
    /// The own fingertip minus the shown one (world, metres).
    correction: Vec3,
    tip_radius: f32,
    /// The remaining distance of the shown fingertip, in metres.
    pub(super) miss: f32,
    /// `true` if no other finger is at a key of the board.
    pub(super) is_clear: bool,
}

impl Aim {
    /// Returns `true` if the finger reaches the target.
    pub(super) fn is_reached(&self) -> bool {
        f64::from(self.miss) <= self.effector.limb.tolerance()
    }
}

/// Returns `true` if all fingers but one are above the keys of a board or beside it.
fn is_clear(
    surface: &Surface,
    world_from_surface: &Pose,
    pose: &HandPose,
    presser: Finger,
) -> bool {
    let [_, highest] = surface.front_heights();
    let others = Finger::ALL.iter().filter(|finger| **finger != presser);
    let mut tips = others.filter_map(|finger| pose.fingertip(*finger));
    tips.all(|tip| {
        let tip = world_from_surface.inverse_transform_point(tip);
        let is_above = tip.z - pose.tip_radius > highest + CLEARANCE;
        let is_beside = surface.targets().all(|(_, target)| {
            let center = target.surface_from_target.translation;
            (tip - center).truncate().length() > BESIDE
        });
        is_above || is_beside
    })
}

/// Returns the pose of a target in the world, for the anchor as the person has learned it.
fn world_from_target(scene: &Scene, target: TargetId, aim: &Aim) -> Option<Pose> {
    let (surface, found) = scene.target(target)?;
    // The board may have moved since.
    Some(aim.world_from_anchor * surface.anchor_from_surface() * found.surface_from_target)
}

/// Returns where the fingertip is in the world when its pad is at a point of a target (target frame, metres).
pub(super) fn goal_of(scene: &Scene, target: TargetId, aim: &Aim, point: Vec3) -> Option<Vec3> {
    let pose = world_from_target(scene, target, aim)?;
    Some(pose * (point + Vec3::Z * aim.tip_radius) + aim.correction)
}

/// Returns the part of a movement (world) that lies in the plane of a target, along its X and Y.
pub(super) fn within_plane(
    scene: &Scene,
    target: TargetId,
    aim: &Aim,
    moved: Vec3,
) -> Option<Vec2> {
    Some(along_axes(&world_from_target(scene, target, aim)?, moved))
}

fn along_axes(world_from_target: &Pose, moved: Vec3) -> Vec2 {
    // Rounded, so that the axes of a flat board that is not turned are exactly axes of the world.
    let [right, away] = [Vec3::X, Vec3::Y].map(|axis| {
        let in_world = world_from_target.rotation * axis;
        (in_world * AXIS_STEPS).round() / AXIS_STEPS
    });
    Vec2::new(moved.dot(right), moved.dot(away))
}

impl FluentHand {
    /// Learns to touch a target with a finger; `None` if the arm or the scene lacks one of them.
    pub(super) fn learn(&mut self, scene: &Scene, target: TargetId, finger: Finger) -> Option<Aim> {
        if let Some(known) = self.aims.get(&(target, finger)) {
            return Some(known.clone());
        }
        let (surface, found) = scene.target(target)?;
        let limb = match surface.anchor() {
            Anchor::Joint(Joint::Wrist) => Limb::Hand,
            _ => Limb::Arm,
        };
        let effector = Effector { finger, limb };
        let hand = self.typing_hand(finger).clone();
        let mut values = hand.rest_values();
        let (mut best, mut pad) = (None::<Aim>, Vec3::NEG_Z * found.travel);
        for _ in 0..LOOKS {
            let pose = self.shown(&values)?;
            let world_from_surface = surface.world_from_surface(&pose)?;
            pad.z = -found.travel;
            let center = pad + Vec3::Z * pose.tip_radius;
            let goal = world_from_surface * (found.surface_from_target * center);
            let (shown, own) = (pose.fingertip(finger)?, hand.tip_of(finger, &values));
            let miss = goal.distance(shown);
            if best.as_ref().is_none_or(|best| miss < best.miss) {
                best = Some(Aim {
                    base: values.clone(),
                    effector,
                    world_from_anchor: world_from_surface * surface.anchor_from_surface().inverse(),
                    correction: own - shown,
                    tip_radius: pose.tip_radius,
                    miss,
                    is_clear: is_clear(surface, &world_from_surface, &pose, finger),
                });
            }
            hand.reach_with(effector, own + (goal - shown), &mut values, &[]);
        }
        let mut aim = best?;
        let reference = *self.references[finger.index()].get_or_insert(aim.correction);
        let adaptation = self.person.adaptation as f32;
        aim.correction = reference + (aim.correction - reference) * adaptation;
        self.aims.insert((target, finger), aim.clone());
        Some(aim)
    }

    /// Returns the posture in which the pad of a finger is at a point of a target (target frame, metres), and the fingertip in the
    /// world.
    pub(super) fn posture_at(
        &self,
        scene: &Scene,
        target: TargetId,
        aim: &Aim,
        point: Vec3,
    ) -> Option<(Vec<f64>, Vec3)> {
        let goal = goal_of(scene, target, aim, point)?;
        let mut values = aim.base.clone();
        let hand = self.typing_hand(aim.effector.finger);
        hand.reach_with(aim.effector, goal, &mut values, &[]);
        Some((values, goal))
    }

    /// Returns the hand that the pipeline shows in a posture, without its filters.
    pub(super) fn shown(&mut self, values: &[f64]) -> Option<HandPose> {
        let angles = self.typing_hand(Finger::Index).angles(values);
        let sample = self.sensors.expected(&self.own, &angles);
        let mut estimator = self.unfiltered.clone();
        let reading = Reading::new(Timestamp(1), Some(self.side), sample);
        let estimate = estimator.update(&reading).ok()?;
        let mut pose = self.assumed.forward(estimate);
        pose.start = self.start;
        Some(pose)
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::FRAC_PI_2;

    use parry3d::math::Rot3;

    use super::*;

    #[test]
    fn a_movement_has_the_axes_of_a_turned_board_and_on_a_flat_one_exactly_those_of_the_world() {
        let flat = Rot3::from_rotation_x(-FRAC_PI_2);
        let moved = Vec3::new(0.031, 0.007, -0.0173);
        let on = |rotation: Rot3, movement: Vec3| {
            along_axes(
                &Pose::from_parts(Vec3::new(0.1, 0.2, 0.3), rotation),
                movement,
            )
        };
        assert_eq!(on(flat, moved), Vec2::new(moved.x, -moved.z));
        for (bearing, tilt) in [(35.0_f32, 0.0_f32), (-35.0, 20.0), (170.0, 90.0)] {
            let tilted = Rot3::from_rotation_x(tilt.to_radians());
            let turned = Rot3::from_rotation_y(-bearing.to_radians()) * tilted * flat;
            // The movement along the normal of the board does not count.
            let way = turned * Vec3::new(0.02, -0.03, 0.05);
            let found = on(turned, way);
            assert!(
                found.distance(Vec2::new(0.02, -0.03)) < 1e-5,
                "{bearing} {tilt}: {found}"
            );
        }
    }
}
