//! The hands that use a layout, for a drawing.

use parry3d::math::{Pose, Vec2, Vec3};

use crate::contact::TargetId;
use crate::contact::surface::{Anchor, Surface};
use crate::device::pointer::AnchoredFrame;
use crate::kinematics::HandPose;
use crate::layout::draft::LayoutFault;

/// The hands that use a layout, at rest, and what they reach.
///
/// A drawing without hands shows each board and space around its anchor.
#[derive(Clone, Debug, Default)]
pub struct Wearer {
    /// The poses of the hands. A board that either hand can touch is drawn at the first.
    pub hands: Vec<HandPose>,
    /// The parts of boards that a hand reaches.
    pub areas: Vec<ReachArea>,
    /// The names of the targets out of reach, with the distance in metres; infinity without a position.
    pub out_of_reach: Vec<(String, f64)>,
    /// The faults of the layout, whose controls are outlined.
    pub faults: Vec<LayoutFault>,
}

/// The part of a board that a hand reaches.
#[derive(Clone, Debug, PartialEq)]
pub struct ReachArea {
    /// Index of the board in [`Layout::boards`](crate::layout::Layout::boards).
    pub board: usize,
    /// Closed outlines in the plane of the board, in metres. Every second one inside another is a hole.
    pub outlines: Vec<Vec<Vec2>>,
}

impl Wearer {
    /// Returns the pose of a board in the world.
    pub(super) fn world_from_surface(&self, surface: &Surface) -> Pose {
        let mut poses = self.hands.iter();
        let pose = poses.find_map(|hand| surface.world_from_surface(hand));
        pose.unwrap_or(surface.anchor_from_surface())
    }

    /// Returns the pose of a box or space in the world.
    pub(super) fn world_from_frame(&self, frame: &AnchoredFrame) -> Pose {
        let mut poses = self.hands.iter();
        let pose = poses.find_map(|hand| frame.world_from_frame(hand));
        pose.unwrap_or(frame.anchor_from_frame)
    }

    /// Returns the position of an anchor in the world, for the hand that touches a surface.
    pub(super) fn anchor_of(&self, surface: &Surface) -> Vec3 {
        let world_from_surface = self.world_from_surface(surface);
        world_from_surface.translation - surface.anchor_from_surface().translation
    }

    /// Returns `true` if a target is out of reach.
    pub(super) fn is_out_of_reach(&self, name: &str) -> bool {
        self.out_of_reach.iter().any(|(other, _)| other == name)
    }

    /// Returns `true` if a target has a fault.
    pub(super) fn is_faulty(&self, target: TargetId) -> bool {
        let mut faults = self.faults.iter();
        faults.any(|fault| fault.targets.contains(&target))
    }

    /// Returns `true` if the position of an anchor is drawn.
    pub(super) fn has(&self, anchor: Anchor) -> bool {
        match anchor {
            Anchor::World => true,
            Anchor::Joint(_) | Anchor::Start | Anchor::OtherHand | Anchor::Body(_) => {
                let mut hands = self.hands.iter();
                hands.any(|hand| anchor.position(hand, false).is_some())
            }
        }
    }
}
