//! The surfaces that targets lie on, and the scene of all surfaces.

use parry3d::math::{Pose, Vec3};

use super::TargetId;
use super::front_index::FrontIndex;
pub use super::target::{DRAG_MARGIN, Shape, Share, TREMOR_MARGIN, Target};
use crate::hand::{BodyPoint, Finger, FingerSet, Joint, Side};
use crate::kinematics::HandPose;

/// The reference point of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// The origin of the world.
    World,
    /// A joint of the hand that touches: the surface follows the joint's position and keeps the
    /// orientation of the world.
    Joint(Joint),
    /// The place of the open hand [at the start](HandPose::start).
    Start,
    /// The [wrist of the other hand](HandPose::other_wrist).
    OtherHand,
    /// A [measured point of the body](HandPose::body).
    Body(BodyPoint),
}

impl Anchor {
    /// Returns the position in the world (metres) for what this hand uses alone, or together with the other hand; `None` if it
    /// is not known.
    pub fn position(self, pose: &HandPose, is_shared: bool) -> Option<Vec3> {
        match self {
            Self::World => Some(Vec3::ZERO),
            Self::Joint(joint) => pose.position(joint),
            Self::Start if is_shared => pose.start.shared,
            Self::Start => pose.start.own,
            Self::OtherHand => pose.other_wrist,
            Self::Body(point) => pose.body.get(point),
        }
    }
}

/// A group of targets that moves as one.
#[derive(Clone, Debug)]
pub struct Surface {
    side: Option<Side>,
    anchor: Anchor,
    anchor_from_surface: Pose,
    center: Vec3,
    first: u32,
    targets: Vec<Target>,
    /// The fingers that press the targets by bending, in their order; empty if fingertips press them by touch.
    bent_by: Vec<Finger>,
    /// The fingers whose strokes press each target; empty if strokes press none.
    struck: Vec<FingerSet>,
    fronts: FrontIndex,
}

impl Surface {
    /// Returns the pose of the surface for a pose of the hand, or `None` if the anchor joint is not known or
    /// the surface belongs to the other hand.
    pub fn world_from_surface(&self, pose: &HandPose) -> Option<Pose> {
        if self.side.is_some_and(|side| side != pose.side) {
            return None;
        }
        let origin = self.anchor.position(pose, self.side.is_none())?;
        Some(Pose::from_parts(
            origin + self.anchor_from_surface.translation,
            self.anchor_from_surface.rotation,
        ))
    }

    /// Returns `true` if the hand may touch the surface once the surface has its place, at the start, at the other hand or at the body.
    pub fn waits_for_place(&self, pose: &HandPose) -> bool {
        let has_place = matches!(self.anchor, Anchor::World | Anchor::Joint(_));
        !has_place
            && self.side.is_none_or(|side| side == pose.side)
            && self.anchor.position(pose, self.side.is_none()).is_none()
    }

    /// Returns the hand that the surface belongs to, or `None` if both hands can touch it.
    pub fn side(&self) -> Option<Side> {
        self.side
    }

    /// Returns the reference point.
    pub fn anchor(&self) -> Anchor {
        self.anchor
    }

    /// Returns the pose relative to the anchor, in the axes of the world.
    pub fn anchor_from_surface(&self) -> Pose {
        self.anchor_from_surface
    }

    /// Returns the mean of the centers of the fronts, in the surface's frame (metres).
    pub fn center(&self) -> Vec3 {
        self.center
    }

    /// Iterates over the targets and their ids.
    pub fn targets(&self) -> impl Iterator<Item = (TargetId, &Target)> {
        let first = self.first;
        (first..).map(TargetId).zip(&self.targets)
    }

    /// Returns `true` if fingers press its targets by bending, wherever the hand is. Then its place only matters for drawings.
    pub fn is_bent(&self) -> bool {
        !self.bent_by.is_empty()
    }

    /// Returns the finger that presses a target by bending, or `None` if a fingertip presses it by touch.
    pub fn bent_by(&self, id: TargetId) -> Option<Finger> {
        let index = id.0.checked_sub(self.first)? as usize;
        self.bent_by.get(index).copied()
    }

    /// Returns the target that a finger presses by bending.
    fn bend_target(&self, finger: Finger) -> Option<(TargetId, &Target)> {
        let index = self.bent_by.iter().position(|other| *other == finger)?;
        Some((self.target_id(index as u32), &self.targets[index]))
    }

    /// Returns `true` if a finger presses the target with this index on the surface by strokes.
    pub(super) fn is_struck(&self, index: u32, finger: Finger) -> bool {
        let fingers = self.struck.get(index as usize);
        fingers.is_some_and(|fingers| fingers.contains(finger))
    }

    /// Returns `true` if any target is pressed by strokes.
    pub fn has_struck_targets(&self) -> bool {
        !self.struck.is_empty()
    }

    /// Returns the index of the fronts, in the surface's frame.
    pub(super) fn fronts(&self) -> &FrontIndex {
        &self.fronts
    }

    /// Returns `true` if all fronts are parallel to the surface, so that a fingertip enters one from above only.
    pub fn is_flat(&self) -> bool {
        matches!(self.fronts, FrontIndex::Grid(_))
    }

    /// Returns heights below and above all fronts, in the surface's frame (metres).
    pub fn front_heights(&self) -> [f32; 2] {
        if self.targets.is_empty() || self.is_bent() {
            [f32::INFINITY, f32::NEG_INFINITY]
        } else {
            self.fronts.heights()
        }
    }

    /// Returns the id of the target with this index on the surface.
    pub fn target_id(&self, index: u32) -> TargetId {
        TargetId(self.first + index)
    }

    /// Returns the target with this id, or `None` if it is not on this surface.
    pub fn target(&self, id: TargetId) -> Option<&Target> {
        self.targets.get(id.0.checked_sub(self.first)? as usize)
    }
}

/// All surfaces and targets of a layout.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    surfaces: Vec<Surface>,
    target_count: u32,
    /// The fingers that targets are made for.
    fingers: Vec<(TargetId, Finger)>,
}

impl Scene {
    /// Creates a scene without targets.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a surface for both hands. Its targets receive the next ids, in order. Returns the id of the
    /// first.
    pub fn add_surface(
        &mut self,
        anchor: Anchor,
        anchor_from_surface: Pose,
        targets: Vec<Target>,
    ) -> TargetId {
        self.add_surface_for(None, anchor, anchor_from_surface, targets)
    }

    /// Adds a surface for one hand, or for both if `side` is `None`; see [`add_surface`](Self::add_surface).
    pub fn add_surface_for(
        &mut self,
        side: Option<Side>,
        anchor: Anchor,
        anchor_from_surface: Pose,
        targets: Vec<Target>,
    ) -> TargetId {
        let fronts = FrontIndex::new(&targets);
        self.push(Surface {
            side,
            anchor,
            anchor_from_surface,
            center: Vec3::ZERO,
            first: 0,
            targets,
            bent_by: Vec::new(),
            struck: Vec::new(),
            fronts,
        })
    }

    /// Adds a surface whose targets are pressed by bending a finger: a target is pressed while the bend of its finger, as a
    /// fraction of its range, is beyond `press_at`, until it is back at `release_at`. Each finger has one target at most.
    pub fn add_bend_surface(
        &mut self,
        side: Option<Side>,
        anchor: Anchor,
        anchor_from_surface: Pose,
        targets: impl IntoIterator<Item = (Finger, Target)>,
    ) -> TargetId {
        let (bent_by, targets) = targets.into_iter().unzip();
        self.push(Surface {
            side,
            anchor,
            anchor_from_surface,
            center: Vec3::ZERO,
            first: 0,
            targets,
            bent_by,
            struck: Vec::new(),
            // No fingertip enters a front.
            fronts: FrontIndex::new(&[]),
        })
    }

    fn push(&mut self, mut surface: Surface) -> TargetId {
        let first = self.target_count;
        let targets = &surface.targets;
        self.target_count += targets.len() as u32;
        let centers = targets
            .iter()
            .map(|target| target.surface_from_target.translation);
        surface.center = centers.sum::<Vec3>() / (targets.len().max(1) as f32);
        surface.first = first;
        self.surfaces.push(surface);
        TargetId(first)
    }

    /// Returns `true` if a surface is anchored at the place of the hand at the start.
    pub fn starts_at_hand(&self) -> bool {
        let mut surfaces = self.surfaces.iter();
        surfaces.any(|surface| surface.anchor == Anchor::Start)
    }

    /// Returns `true` if a surface is anchored at the other hand.
    pub fn follows_other_hand(&self) -> bool {
        let mut surfaces = self.surfaces.iter();
        surfaces.any(|surface| surface.anchor == Anchor::OtherHand)
    }

    /// Returns `true` if a surface is anchored at a point of the body.
    pub fn follows_body(&self) -> bool {
        let mut surfaces = self.surfaces.iter();
        surfaces.any(|surface| matches!(surface.anchor, Anchor::Body(_)))
    }

    /// Returns `true` if a finger presses a target by bending.
    pub fn has_bend_targets(&self) -> bool {
        self.surfaces.iter().any(Surface::is_bent)
    }

    /// Returns the target that a finger of a hand presses by bending.
    pub fn bend_target(&self, side: Side, finger: Finger) -> Option<(TargetId, &Target)> {
        let of_hand = |surface: &&Surface| surface.side.is_none_or(|own| own == side);
        let mut surfaces = self.surfaces.iter().filter(of_hand);
        surfaces.find_map(|surface| surface.bend_target(finger))
    }

    /// Returns the surfaces, in the order in which they were added.
    pub fn surfaces(&self) -> &[Surface] {
        &self.surfaces
    }

    /// Moves the surface with this index; does nothing if there is none.
    ///
    /// A [`ContactTracker`](super::ContactTracker) sees the displacement as a movement of the fingertips unless it is
    /// [reset](super::ContactTracker::reset).
    pub fn set_surface_pose(&mut self, index: usize, anchor_from_surface: Pose) {
        if let Some(surface) = self.surfaces.get_mut(index) {
            surface.anchor_from_surface = anchor_from_surface;
        }
    }

    /// Detaches the surface with this index from its anchor and fixes it in the world; does nothing if there is none. Contact trackers
    /// see it as [moved](Self::set_surface_pose).
    pub fn place_in_world(&mut self, index: usize, world_from_surface: Pose) {
        if let Some(surface) = self.surfaces.get_mut(index) {
            surface.anchor = Anchor::World;
            surface.anchor_from_surface = world_from_surface;
        }
    }

    /// Makes a target pressed by strokes of these fingers: by the lowest point of a fingertip that goes through its front and turns.
    /// Other fingers press the target whose front they enter, at the press depth.
    pub fn set_struck(&mut self, target: TargetId, fingers: FingerSet) {
        for surface in &mut self.surfaces {
            if surface.target(target).is_some() {
                let targets = surface.targets.len();
                surface.struck.resize(targets, FingerSet::NONE);
                surface.struck[(target.0 - surface.first) as usize] = fingers;
            }
        }
    }

    /// Makes a target for a finger. Every finger can still touch it.
    pub fn set_finger(&mut self, target: TargetId, finger: Finger) {
        self.fingers.push((target, finger));
    }

    /// Returns the finger that a target is made for, if it is made for one.
    pub fn finger(&self, target: TargetId) -> Option<Finger> {
        let mut fingers = self.fingers.iter();
        let found = fingers.find(|(other, _)| *other == target);
        found.map(|(_, finger)| *finger)
    }

    /// Returns the number of targets.
    pub fn len(&self) -> usize {
        self.target_count as usize
    }

    /// Returns `true` if there are no targets.
    pub fn is_empty(&self) -> bool {
        self.target_count == 0
    }

    /// Returns the target with this id and its surface.
    pub fn target(&self, id: TargetId) -> Option<(&Surface, &Target)> {
        self.surfaces
            .iter()
            .find_map(|surface| Some((surface, surface.target(id)?)))
    }
}
