//! Thumb and index finger that close over a knob.

use std::f32::consts::TAU;

use parry3d::bounding_volume::Aabb;
use parry3d::math::{Rotation, Vec3};

use crate::contact::TargetId;
use crate::contact::surface::Scene;
use crate::contact::sweep::is_inside;
use crate::device::target_index::Places;
use crate::hand::{Finger, Joint};
use crate::kinematics::HandPose;

/// Thumb and index fingertip are closed when their middles are nearer together than this, in metres; the
/// figures of Ultraleap's interaction engine.
const CLOSED: f32 = 0.025;
/// They are open when they are further apart than this.
const OPEN: f32 = 0.030;
/// How far in front of a knob or behind it they may close, in metres.
const HEIGHT: f32 = 0.04;

/// What thumb and index finger of one hand do.
#[derive(Clone, Copy, Debug, Default)]
pub(super) enum Pinch {
    /// They are apart.
    Open,
    /// They closed, or may have, where there is no knob: they have to open first.
    #[default]
    Closed,
    /// They hold a knob.
    On(Held),
}

impl Pinch {
    /// Whether they hold the knob at this place of the list.
    pub(super) fn is_on(&self, place: usize) -> bool {
        matches!(self, Self::On(held) if held.place == place)
    }
}

/// A knob between thumb and index finger.
#[derive(Clone, Copy, Debug)]
pub(super) struct Held {
    /// The place of the knob in its list.
    pub(super) place: usize,
    /// The value without steps.
    pub(super) value: f32,
    /// The number of its surface, which spares the search for it.
    surface: usize,
    target: TargetId,
    /// How the hand was turned against the target when it took the knob.
    hand_from_target: Rotation,
    /// How far it has turned about the normal since then, in radians.
    twist: f32,
}

/// Where the tips of thumb and index finger are.
pub(super) struct Tips {
    middle: Vec3,
    apart: f32,
}

impl Tips {
    /// The fingers that pinch.
    pub(super) const FINGERS: [Finger; 2] = [Finger::Thumb, Finger::Index];

    /// `None` where one of them cannot be believed, or the hand may have been anywhere since.
    pub(super) fn of(pose: &HandPose) -> Option<Self> {
        let is_doubtful = |&finger: &Finger| pose.untrusted.contains(finger);
        if pose.jumped || Self::FINGERS.iter().any(is_doubtful) {
            return None;
        }
        let [thumb, index] = Self::FINGERS.map(|finger| pose.fingertip(finger));
        let (thumb, index) = (thumb?, index?);
        let (middle, apart) = (thumb.midpoint(index), thumb.distance(index));
        (middle.is_finite() && apart.is_finite()).then_some(Self { middle, apart })
    }

    pub(super) fn are_open(&self) -> bool {
        self.apart > OPEN
    }

    pub(super) fn are_closed(&self) -> bool {
        self.apart < CLOSED
    }
}

/// The knob that the tips close over; its value is not known here, and 0.
///
/// Looks through the fronts less than [`HEIGHT`] from them only, and only when they close. Does not allocate: see
/// [`first_crossing`](crate::contact::hit_test::first_crossing).
pub(super) fn knob_under(
    tips: &Tips,
    pose: &HandPose,
    scene: &Scene,
    knobs: &Places,
) -> Option<Held> {
    for (number, surface) in scene.surfaces().iter().enumerate() {
        let Some(world_from_surface) = surface.world_from_surface(pose) else {
            continue;
        };
        let middle = world_from_surface.inverse_transform_point(tips.middle);
        let around = Aabb::new(middle - Vec3::splat(HEIGHT), middle + Vec3::splat(HEIGHT));
        for leaf in surface.front_bvh().intersect_aabb(&around) {
            let id = surface.target_id(leaf);
            let (Some(place), Some(target)) = (knobs.of(id), surface.target(id)) else {
                continue;
            };
            let middle = target.surface_from_target.inverse_transform_point(middle);
            if !is_inside(target.shape, middle.truncate(), 0.0) {
                continue;
            }
            return Some(Held {
                place,
                value: 0.0,
                surface: number,
                target: id,
                hand_from_target: target_from_hand(number, id, pose, scene)?.inverse(),
                twist: 0.0,
            });
        }
    }
    None
}

impl Held {
    /// How far the hand has turned about the knob's normal since the last time, in radians,
    /// counter-clockwise as seen from the front; `None` when that is not known any more.
    ///
    /// The twist of a turn `q` about Z is 2 atan(z/w), whatever its swing is. It is taken of the whole turn
    /// since the pinch began: those of frame after frame would add up to something when the hand only swings.
    pub(super) fn turn(&mut self, pose: &HandPose, scene: &Scene) -> Option<f32> {
        let target_from_hand = target_from_hand(self.surface, self.target, pose, scene)?;
        let turn = target_from_hand * self.hand_from_target;
        let twist = 2.0 * (turn.z / turn.w).atan();
        if !twist.is_finite() {
            return Some(0.0);
        }
        let since = twist - self.twist;
        self.twist = twist;
        Some(since - TAU * (since / TAU).round())
    }
}

/// How the hand is turned against a target.
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
    Some(world_from_target.inverse() * world_from_hand).filter(|turn| turn.is_finite())
}
