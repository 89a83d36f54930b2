//! Thumb and index finger that close over a knob.

use std::f32::consts::TAU;

use parry3d::math::{Rotation, Vec3};

use crate::contact::TargetId;
use crate::contact::hit_test::for_each_front_near;
use crate::contact::surface::Scene;
use crate::contact::sweep::is_inside;
use crate::device::target_index::TargetIndex;
use crate::hand::{Finger, Joint};
use crate::kinematics::HandPose;

/// Thumb and index finger are closed when their fingertip centers are closer together than this, in metres.
/// Value of the Ultraleap Interaction Engine.
const CLOSED_BELOW: f32 = 0.025;
/// Thumb and index finger are open when the centers are further apart than this, in metres.
const OPEN_ABOVE: f32 = 0.030;
/// Maximum distance from the front of a knob, before it or behind it, at which they may close, in metres.
const MAX_HEIGHT: f32 = 0.04;

/// The pinch of one hand.
#[derive(Clone, Copy, Debug, Default)]
pub(super) enum PinchState {
    /// The fingers are apart.
    Open,
    /// The fingers are closed, or may be, and hold no knob. They have to open first.
    #[default]
    Closed,
    /// The fingers hold a knob.
    Holding(PinchGrip),
}

impl PinchState {
    /// Returns `true` if the fingers hold the knob with this index.
    pub(super) fn holds(&self, knob: usize) -> bool {
        matches!(self, Self::Holding(grip) if grip.knob == knob)
    }
}

/// A knob between thumb and index finger.
#[derive(Clone, Copy, Debug)]
pub(super) struct PinchGrip {
    /// The index of the knob.
    pub(super) knob: usize,
    /// The value before quantisation.
    pub(super) value: f32,
    /// The index of the knob's surface in the scene.
    surface: usize,
    target: TargetId,
    /// The inverse of the hand's orientation relative to the target at the start of the pinch.
    hand_from_target: Rotation,
    /// The rotation about the normal since the start, in radians.
    twist: f32,
}

/// The midpoint and the distance of the fingertips of thumb and index finger.
pub(super) struct PinchTips {
    midpoint: Vec3,
    distance: f32,
}

impl PinchTips {
    /// The fingers that pinch.
    pub(super) const FINGERS: [Finger; 2] = [Finger::Thumb, Finger::Index];

    /// Returns `None` if one of the fingers is unknown or untrusted, or if the hand was re-acquired.
    pub(super) fn from_pose(pose: &HandPose) -> Option<Self> {
        let is_untrusted = |&finger: &Finger| pose.untrusted.contains(finger);
        if pose.jumped || Self::FINGERS.iter().any(is_untrusted) {
            return None;
        }
        let [thumb, index] = Self::FINGERS.map(|finger| pose.fingertip(finger));
        let (thumb, index) = (thumb?, index?);
        let (midpoint, distance) = (thumb.midpoint(index), thumb.distance(index));
        (midpoint.is_finite() && distance.is_finite()).then_some(Self { midpoint, distance })
    }

    pub(super) fn are_open(&self) -> bool {
        self.distance > OPEN_ABOVE
    }

    pub(super) fn are_closed(&self) -> bool {
        self.distance < CLOSED_BELOW
    }
}

/// Returns the grip on the knob that the fingertips close over, with value 0, if there is one.
///
/// Tests only the fronts within [`MAX_HEIGHT`] of the midpoint, and only when the fingers close. Does not allocate.
pub(super) fn grip_between(
    tips: &PinchTips,
    pose: &HandPose,
    scene: &Scene,
    knobs: &TargetIndex,
) -> Option<PinchGrip> {
    for (surface_index, surface) in scene.surfaces().iter().enumerate() {
        let Some(world_from_surface) = surface.world_from_surface(pose) else {
            continue;
        };
        let midpoint = world_from_surface.inverse_transform_point(tips.midpoint);
        let mut gripped = None;
        for_each_front_near(surface, midpoint, MAX_HEIGHT, |front| {
            let id = surface.target_id(front);
            let (Some(knob), Some(target)) = (knobs.get(id), surface.target(id)) else {
                return;
            };
            let midpoint = target.surface_from_target.inverse_transform_point(midpoint);
            if is_inside(target.shape, midpoint.truncate(), 0.0) {
                gripped.get_or_insert((knob, id));
            }
        });
        if let Some((knob, target)) = gripped {
            let hand_from_target = target_from_hand(surface_index, target, pose, scene)?.inverse();
            return Some(PinchGrip {
                knob,
                value: 0.0,
                surface: surface_index,
                target,
                hand_from_target,
                twist: 0.0,
            });
        }
    }
    None
}

impl PinchGrip {
    /// Returns the rotation of the hand about the knob's normal since the last call, in radians,
    /// counter-clockwise as seen from the front; `None` if the pose of the hand or of the knob is unknown.
    ///
    /// The twist of a rotation `q` about Z is 2 atan(z/w), independent of its swing. It is computed from the
    /// rotation since the start of the pinch: the sum of the twists of single steps drifts when the hand
    /// swings.
    pub(super) fn rotation_since_last(&mut self, pose: &HandPose, scene: &Scene) -> Option<f32> {
        let target_from_hand = target_from_hand(self.surface, self.target, pose, scene)?;
        let rotation = target_from_hand * self.hand_from_target;
        let twist = 2.0 * (rotation.z / rotation.w).atan();
        if !twist.is_finite() {
            return Some(0.0);
        }
        let change = twist - self.twist;
        self.twist = twist;
        Some(change - TAU * (change / TAU).round())
    }
}

/// Returns the orientation of the hand relative to a target.
fn target_from_hand(
    surface: usize,
    target: TargetId,
    pose: &HandPose,
    scene: &Scene,
) -> Option<Rotation> {
    let surface = scene.surfaces().get(surface)?;
    let surface_from_target = surface.target(target)?.surface_from_target.rotation;
    let world_from_target = surface.world_from_surface(pose)?.rotation * surface_from_target;
    let world_from_hand = pose.get(Joint::Wrist)?.rotation;
    Some(world_from_target.inverse() * world_from_hand).filter(|rotation| rotation.is_finite())
}
