//! Forward kinematics of eight hands.

use parry3d::math::Vec3;
use wide::f32x8;

use super::{AllTips, LANES, LaneAngles};
use crate::hand::{Dof, Finger, Joint};
use crate::kinematics::{ArmModel, LanePose, PreparedLinks, sin_cos};

/// A vector of each hand: x, y and z.
pub(super) type LaneVector = [f32x8; 3];

/// The positions of the fingertips of eight hands in the world, in metres; NaN for a finger that the arm lacks.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub struct LaneTips {
    tips: AllTips,
}

impl Default for LaneTips {
    fn default() -> Self {
        Self {
            tips: [[[f32::NAN; LANES]; 3]; Finger::COUNT],
        }
    }
}

impl LaneTips {
    /// Returns a fingertip of the hand in a lane, 0 to 7, or `None` if the arm lacks the finger.
    ///
    /// # Panics
    ///
    /// Panics if there is no such lane.
    pub fn get(&self, lane: usize, finger: Finger) -> Option<Vec3> {
        let tip = self.tips[finger.index()].map(|lanes| lanes[lane]);
        Some(Vec3::from_array(tip)).filter(|tip| !tip.is_nan())
    }
}

/// Eight hands: the positions of all joints and fingertips that the arm has.
pub(super) struct LaneHands {
    pub joints: [LaneVector; Joint::COUNT],
    /// The rotations of the links, by degree of freedom.
    turns: [Turn; Dof::COUNT],
}

/// A rotation by half an angle of each hand.
#[derive(Clone, Copy)]
struct Turn {
    sines: f32x8,
    cosines: f32x8,
    /// `true` if all angles are 0, as in a glove that does not measure them.
    is_none: bool,
}

impl LaneHands {
    pub fn new() -> Self {
        let none = Turn {
            sines: f32x8::ZERO,
            cosines: f32x8::ONE,
            is_none: true,
        };
        Self {
            joints: [[f32x8::splat(f32::NAN); 3]; Joint::COUNT],
            turns: [none; Dof::COUNT],
        }
    }

    pub fn tip(&self, finger: Finger) -> LaneVector {
        self.joints[Joint::tip(finger).index()]
    }

    /// Copies the fingertips to `tips`.
    pub fn copy_tips(&self, tips: &mut LaneTips) {
        for (&finger, tip) in Finger::ALL.iter().zip(&mut tips.tips) {
            *tip = to_arrays(self.tip(finger));
        }
    }
}

/// An arm model for eight hands.
pub(super) struct LaneArm {
    root: LanePose<f32x8>,
    links: PreparedLinks,
    /// The degrees of freedom of the links, each once.
    dofs: Vec<usize>,
}

impl LaneArm {
    pub fn new(arm: &ArmModel) -> Self {
        let links = PreparedLinks::new(arm.links(), |_| false);
        let mut dofs: Vec<usize> = links.angles().collect();
        dofs.sort_unstable();
        dofs.dedup();
        Self {
            root: LanePose::splat(&arm.world_from_root(), f32x8::splat),
            links,
            dofs,
        }
    }

    /// Computes the joints and fingertips in place of earlier ones of the same arm.
    pub fn forward_into(&self, angles: &LaneAngles, hands: &mut LaneHands) {
        for &dof in &self.dofs {
            hands.turns[dof].set(angles.dof(dof));
        }
        let half_angle = |dof: usize| {
            let turn = &hands.turns[dof];
            (!turn.is_none).then_some((turn.sines, turn.cosines))
        };
        let links = &self.links;
        links.forward(&self.root, half_angle, |joint, pose| {
            hands.joints[joint.index()] = pose.translation;
        });
    }
}

impl Turn {
    fn set(&mut self, radians: &[f32; LANES]) {
        self.is_none = radians.iter().all(|radians| radians.to_bits() == 0);
        if self.is_none {
            return;
        }
        let (mut sines, mut cosines) = ([0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            (sines[lane], cosines[lane]) = sin_cos(radians[lane] * 0.5);
        }
        (self.sines, self.cosines) = (f32x8::new(sines), f32x8::new(cosines));
    }
}

/// Returns the arrays of a vector.
#[inline]
pub(super) fn to_arrays(vector: LaneVector) -> [[f32; LANES]; 3] {
    vector.map(f32x8::to_array)
}
