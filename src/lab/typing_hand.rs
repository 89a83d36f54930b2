//! The posture of a hand that types with the index finger, and how it gets to a key.

use arrayvec::ArrayVec;
use parry3d::math::Vec3;

use crate::contact::TargetId;
use crate::contact::surface::{Scene, Target};
use crate::estimate::{ChannelMap, JointAngles, JointLimits};
use crate::hand::{Dof, Finger};
use crate::kinematics::{ArmModel, Control, HandPose, MAX_CONTROLS, Solution, angles_of, solve};
use crate::time::Timestamp;

/// The finger that types; the others are held up.
const FINGER: Finger = Finger::Index;
/// Height of the fingertip over the keys while it travels, in metres.
const HOVER: f32 = 0.014;
/// How far the fingertip goes past the end of a key's travel, in metres.
const OVERTRAVEL: f32 = 0.002;
/// How far from the bottom of a key the solved fingertip may be before the key counts as out of
/// reach, in metres.
const REACH_ERROR: f64 = 0.003;

/// A hand in a glove, its wrist straight, its palm down, its index finger half bent over the keys.
///
/// It moves what the glove has sensors for, in steps that the glove's converters could tell apart.
#[derive(Clone, Debug)]
pub struct TypingHand {
    arm: ArmModel,
    controls: Vec<Control>,
    resting: JointAngles,
    resting_pose: HandPose,
}

/// Where the fingertip goes to press a key: the centre of its sphere in the world, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeyStroke {
    /// Over the key.
    pub hover: Vec3,
    /// With the key pushed in.
    pub bottom: Vec3,
}

impl TypingHand {
    /// The hand of this arm in a glove with these channels.
    pub fn new(arm: &ArmModel, map: &ChannelMap) -> Self {
        let resting = posture(map);
        Self {
            arm: arm.clone(),
            controls: typing_controls(map),
            resting,
            resting_pose: arm.forward(&resting),
        }
    }

    /// The values of the hand's controls at rest.
    pub fn rest(&self) -> ArrayVec<f64, MAX_CONTROLS> {
        self.controls.iter().map(|control| control.rest).collect()
    }

    /// The values of the controls that bring the fingertip to `tip` (world, metres), beginning at `start`.
    pub fn reach(&self, tip: Vec3, start: &[f64]) -> Solution {
        solve(&self.arm, &self.controls, &self.resting, start, FINGER, tip)
    }

    /// The angles of the whole hand for these values of its controls.
    pub fn angles(&self, values: &[f64]) -> JointAngles {
        angles_of(&self.controls, values, &self.resting)
    }

    /// How the fingertip presses a key, or how far beyond the hand's reach that is, in metres: infinitely
    /// far when the target or its anchor is not there.
    pub fn stroke(&self, scene: &Scene, target: TargetId) -> Result<KeyStroke, f64> {
        let stroke = self.way(scene, target).ok_or(f64::INFINITY)?;
        let distance = self.reach(stroke.bottom, &self.rest()).distance;
        match distance > REACH_ERROR {
            true => Err(distance),
            false => Ok(stroke),
        }
    }

    fn way(&self, scene: &Scene, target: TargetId) -> Option<KeyStroke> {
        let (surface, target) = scene.target(target)?;
        let world_from_surface = surface.world_from_surface(&self.resting_pose)?;
        let world_from_target = world_from_surface * target.surface_from_target;
        let radius = self.resting_pose.tip_radius;
        let at = |height: f32| world_from_target * Vec3::new(0.0, 0.0, height + radius);
        Some(KeyStroke {
            hover: at(HOVER),
            bottom: at(-depth(target)),
        })
    }
}

fn depth(target: &Target) -> f32 {
    target.travel + OVERTRAVEL
}

/// What each angle is while typing: the wrist straight, the palm down, the index finger half bent,
/// the other fingers held up out of the way.
fn typing_angle(dof: Dof) -> f64 {
    match dof {
        Dof::ElbowFlexion => 0.6,
        Dof::WristFlexion => 0.05,
        Dof::IndexMcpFlexion => 0.45,
        Dof::IndexPipFlexion => 0.45,
        Dof::IndexDipFlexion => 0.45,
        Dof::MiddleMcpFlexion | Dof::RingMcpFlexion | Dof::LittleMcpFlexion => -0.5,
        Dof::ThumbCmcAbduction => -0.5,
        _ => 0.0,
    }
}

/// The typing posture, as far as the glove can show it.
fn posture(map: &ChannelMap) -> JointAngles {
    let mut angles = JointAngles::at(Timestamp(0));
    for row in map.rows() {
        angles.set(row.dof, typing_angle(row.dof));
    }
    angles
}

/// A control for each channel that moves the typing finger: its value is the count.
fn typing_controls(map: &ChannelMap) -> Vec<Control> {
    let moving = [
        Dof::ElbowFlexion,
        Dof::WristFlexion,
        Dof::WristDeviation,
        Dof::IndexMcpFlexion,
        Dof::IndexPipFlexion,
    ];
    moving
        .iter()
        .filter_map(|&dof| {
            let row = map.rows().iter().rev().find(|row| row.dof == dof)?;
            Some(channel_control(map, row.channel))
        })
        .collect()
}

/// A control that is one channel: all the angles that it tells, the counts that their joints allow.
fn channel_control(map: &ChannelMap, channel: usize) -> Control {
    let limits = JointLimits::human();
    let mut control = Control {
        moves: ArrayVec::new(),
        range: (1.0, f64::from(map.full_scale()) - 1.0),
        rest: 0.0,
    };
    for row in map.rows().iter().filter(|row| row.channel == channel) {
        let (low, high) = limits.range(row.dof);
        let (one, other) = (row.line.reading(low), row.line.reading(high));
        control.range.0 = control.range.0.max(one.min(other));
        control.range.1 = control.range.1.min(one.max(other));
        control.rest = row.line.reading(typing_angle(row.dof));
        if control.moves.try_push((row.dof, row.line)).is_err() {
            break;
        }
    }
    control.rest = control.rest.clamp(control.range.0, control.range.1);
    control
}
