//! The way from a target to a posture, as a person learns it by looking at the hand that the pipeline shows.

use parry3d::math::{Pose, Vec3};

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

/// Returns where the fingertip is in the world when its pad is at a point of a target (target frame, metres).
pub(super) fn goal_of(scene: &Scene, target: TargetId, aim: &Aim, point: Vec3) -> Option<Vec3> {
    let (surface, found) = scene.target(target)?;
    // The board may have moved since.
    let world_from_target =
        aim.world_from_anchor * surface.anchor_from_surface() * found.surface_from_target;
    Some(world_from_target * (point + Vec3::Z * aim.tip_radius) + aim.correction)
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
