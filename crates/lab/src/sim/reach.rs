//! The reach of the fingers of a simulated hand.

use parry3d::math::{Vec2, Vec3};

use super::action::TargetPoint;
use super::effector::{Effector, Limb};
use super::reach_target::ReachTarget;
use super::typing_hand::TypingHand;
use crate::contact::TargetId;
use crate::contact::surface::{Anchor, Scene, Surface};
use crate::hand::{Finger, FingerSet, Joint};

/// Height of the fingertip above the targets while it travels, in metres.
const HOVER: f32 = 0.014;
/// Distance of the fingertip beyond the end of a target's travel, in metres.
const OVERTRAVEL: f32 = 0.002;

/// The way from the nearest position of the fingertip to a position out of reach, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Miss {
    /// The length; infinity if the scene or the arm lacks the target or its anchor.
    pub distance: f64,
    /// The part horizontally away from the elbow; negative if the position is too near.
    pub outward: f32,
    /// The part upwards.
    pub up: f32,
    /// The part to the right, seen from the elbow.
    pub right: f32,
}

impl Miss {
    /// The miss of a target without a position.
    pub const NO_POSITION: Self = Self {
        distance: f64::INFINITY,
        outward: 0.0,
        up: 0.0,
        right: 0.0,
    };
}

impl TypingHand {
    /// Returns the way from the nearest position of the fingertip to `tip` (world, metres); `None` if `tip` is within reach.
    pub fn miss(&self, tip: Vec3) -> Option<Miss> {
        self.miss_with(Effector::INDEX, tip)
    }

    /// Returns the shortest way by which `fingers` miss a point of a target, at `offset` from its center along its X and Y in metres;
    /// `None` if one of them reaches it.
    pub fn miss_of_fingers(
        &self,
        scene: &Scene,
        target: TargetId,
        offset: Vec2,
        fingers: FingerSet,
    ) -> Option<Miss> {
        let found = scene.target(target).zip(self.reach_target(scene, target));
        let Some(((surface, _), reach_target)) = found else {
            return Some(Miss::NO_POSITION);
        };
        let point = TargetPoint { target, offset };
        let tip = reach_target.tip_position(point, reach_target.bottom_height);
        let limb = if moves_with_wrist(surface) {
            Limb::Hand
        } else {
            Limb::Arm
        };
        let mut shortest: Option<Miss> = None;
        let fingers = Finger::ALL
            .iter()
            .filter(|finger| fingers.contains(**finger));
        for &finger in fingers {
            let miss = self.miss_with(Effector { finger, limb }, tip)?;
            if shortest.is_none_or(|other| miss.distance < other.distance) {
                shortest = Some(miss);
            }
        }
        shortest
    }

    /// Returns the way from the nearest position of a fingertip to `tip` (world, metres); `None` if `tip` is within reach.
    fn miss_with(&self, effector: Effector, tip: Vec3) -> Option<Miss> {
        let mut values = self.rest_values();
        let distance = self.reach_with(effector, tip, &mut values, &[]);
        if distance <= effector.limb.tolerance() {
            return None;
        }
        // A hand without this fingertip has no position to compare.
        if !distance.is_finite() {
            return Some(Miss::NO_POSITION);
        }
        let way = tip - self.tip_of(effector.finger, &values);
        let center = match effector.limb {
            Limb::Arm => self.elbow(),
            Limb::Hand | Limb::Finger => self.wrist(),
        };
        let horizontal = (tip - center) * Vec3::new(1.0, 0.0, 1.0);
        let outward = horizontal.normalize_or(Vec3::NEG_Z);
        Some(Miss {
            distance,
            outward: way.dot(outward),
            up: way.y,
            right: way.dot(outward.cross(Vec3::Y)),
        })
    }

    /// Returns the wrist at rest (world, metres); the origin if the arm model has none.
    fn wrist(&self) -> Vec3 {
        self.resting_pose.position(Joint::Wrist).unwrap_or_default()
    }

    /// Returns the geometry of a target; `None` if the scene or the arm lacks the target or its anchor.
    pub(super) fn reach_target(&self, scene: &Scene, target: TargetId) -> Option<ReachTarget> {
        let (surface, target) = scene.target(target)?;
        let world_from_surface = surface.world_from_surface(&self.resting_pose)?;
        Some(ReachTarget {
            world_from_target: world_from_surface * target.surface_from_target,
            hover_height: HOVER,
            bottom_height: -(target.travel + OVERTRAVEL),
            travel: target.travel,
            tip_radius: self.resting_pose.tip_radius,
        })
    }
}

/// Returns the fingers that may press a target: the one that the layout names, or else a person's, `pressing`. If that is empty, the
/// index finger, and any finger on a board that moves with the wrist.
pub fn pressing_fingers(scene: &Scene, target: TargetId, pressing: FingerSet) -> FingerSet {
    let named = scene.finger(target);
    let named = named.filter(|finger| pressing.is_empty() || pressing.contains(*finger));
    let on_wrist = scene
        .target(target)
        .is_some_and(|(surface, _)| moves_with_wrist(surface));
    match named {
        Some(finger) => FingerSet::NONE.with(finger),
        None if !pressing.is_empty() => pressing,
        None if on_wrist => FingerSet::ALL,
        None => FingerSet::NONE.with(Finger::Index),
    }
}

fn moves_with_wrist(surface: &Surface) -> bool {
    surface.anchor() == Anchor::Joint(Joint::Wrist)
}
