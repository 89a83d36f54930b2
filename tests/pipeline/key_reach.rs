//! Positions of a fingertip on a key.

use ademan::contact::TargetId;
use ademan::contact::surface::Scene;
use ademan::sim::TypingHand;
use parry3d::math::{Pose, Vec3};

/// The height of the fingertip above a key before a press, in metres.
const HOVER: f32 = 0.014;
/// The distance beyond the travel of a key to which a finger presses it, in metres.
const OVERTRAVEL: f32 = 0.002;

/// A key that a fingertip presses. Heights are measured from the front of the key to the pad of the fingertip, in metres.
pub struct KeyReach {
    world_from_target: Pose,
    pub travel: f32,
    tip_radius: f32,
}

impl KeyReach {
    /// Creates the key at its place for a hand at rest; `None` if the scene or the arm lacks it.
    pub fn new(hand: &TypingHand, scene: &Scene, target: TargetId) -> Option<Self> {
        let (surface, target) = scene.target(target)?;
        let pose = hand.pose(&hand.rest_values());
        Some(Self {
            world_from_target: surface.world_from_surface(&pose)? * target.surface_from_target,
            travel: target.travel,
            tip_radius: pose.tip_radius,
        })
    }

    /// Returns the center of the fingertip (world, metres) at a height.
    pub fn tip(&self, height: f32) -> Vec3 {
        self.world_from_target * (Vec3::Z * (height + self.tip_radius))
    }

    /// Returns the height of the fingertip whose center is at `tip` (world, metres).
    pub fn height(&self, tip: Vec3) -> f32 {
        self.world_from_target.inverse_transform_point(tip).z - self.tip_radius
    }

    /// Returns the center of the fingertip above the key (world, metres).
    pub fn hover(&self) -> Vec3 {
        self.tip(HOVER)
    }

    /// Returns the center of the fingertip with the key fully pressed (world, metres).
    pub fn bottom(&self) -> Vec3 {
        self.tip(-self.travel - OVERTRAVEL)
    }
}
