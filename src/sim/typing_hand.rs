//! The posture of a hand that points with the index finger, and how it gets to a target.

use arrayvec::ArrayVec;
use parry3d::math::{Pose, Vec2, Vec3};

use super::action::TargetPoint;
use crate::contact::TargetId;
use crate::contact::surface::{Scene, Target};
use crate::estimate::{ChannelMap, Estimate, JointAngles, JointLimits};
use crate::hand::{Dof, Finger, Joint};
use crate::kinematics::{
    ArmModel, HandPose, IkVariable, MAX_IK_VARIABLES, angles_from_variables, solve_ik,
};
use crate::time::Timestamp;

/// The finger that points; the others are held up.
const FINGER: Finger = Finger::Index;
/// Height of the fingertip over the targets while it travels, in metres.
const HOVER: f32 = 0.014;
/// How far the fingertip goes past the end of a target's travel, in metres.
const OVERTRAVEL: f32 = 0.002;
/// How far from where it should be the solved fingertip may be before that counts as out of reach,
/// in metres.
pub const REACH_TOLERANCE: f64 = 0.003;
/// From the middle of one fingertip to the middle of the other in a pinch, in metres: pads of 5 mm
/// that give way a little.
const PINCHED: f32 = 0.008;
/// Further apart than this, in metres, two fingertips do not pinch.
pub(super) const PINCH_GAP: f64 = 0.012;
/// How many times thumb and index finger go towards each other before the pinch is given up.
const PINCH_ROUNDS: usize = 60;

/// The angles that bring the index fingertip to its place.
const REACHING: [Dof; 5] = [
    Dof::ElbowFlexion,
    Dof::WristFlexion,
    Dof::WristDeviation,
    Dof::IndexMcpFlexion,
    Dof::IndexPipFlexion,
];
/// The angles that bring the thumb to the index finger.
const OPPOSING: [Dof; 4] = [
    Dof::ThumbCmcAbduction,
    Dof::ThumbCmcFlexion,
    Dof::ThumbMcpFlexion,
    Dof::ThumbIpFlexion,
];
/// The angles with which the index finger meets a thumb that does not come all the way.
const MEETING: [Dof; 2] = [Dof::IndexMcpFlexion, Dof::IndexPipFlexion];

/// A hand in a glove, its wrist straight, its palm down, its index finger half bent over the keys.
///
/// It moves what the glove has sensors for. Its posture is one value for each channel in use, in the
/// order of [`channels`](Self::channels): the exact count that the channel would give.
#[derive(Clone, Debug)]
pub struct TypingHand {
    arm: ArmModel,
    channels: Vec<usize>,
    controls: Vec<IkVariable>,
    resting_pose: HandPose,
}

/// Where the fingertip goes to press a key: the centre of its sphere in the world, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TapPath {
    /// Over the key.
    pub hover: Vec3,
    /// With the key pushed in.
    pub bottom: Vec3,
}

/// A target as the fingertip meets it: heights are those of the fingertip's pad over the front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Front {
    /// The target's frame in the world.
    pub(super) world_from_target: Pose,
    /// The height in mid air.
    pub(super) hover: f32,
    /// The height at the end of the travel, below 0.
    pub(super) bottom: f32,
    /// How far the target can be pushed in, in metres.
    pub(super) travel: f32,
    tip_radius: f32,
}

impl Front {
    /// The centre of the fingertip (world, metres) whose pad is so high over a place of the front.
    pub(super) fn tip(&self, spot: TargetPoint, height: f32) -> Vec3 {
        self.world_from_target * spot.offset.extend(height + self.tip_radius)
    }

    /// Where the pad of a fingertip whose centre is at `tip` (world, metres) is, in the target's frame.
    pub(super) fn pad(&self, tip: Vec3) -> Vec3 {
        self.world_from_target.inverse_transform_point(tip) - Vec3::Z * self.tip_radius
    }
}

impl TypingHand {
    /// The hand of this arm in a glove with these channels.
    pub fn new(arm: &ArmModel, map: &ChannelMap) -> Self {
        let mut channels: Vec<usize> = map.rows().iter().map(|row| row.channel).collect();
        channels.sort_unstable();
        channels.dedup();
        let controls: Vec<IkVariable> = channels
            .iter()
            .map(|&channel| channel_control(map, channel))
            .collect();
        let mut hand = Self {
            arm: arm.clone(),
            channels,
            controls,
            resting_pose: HandPose::new(Timestamp(0), arm.side(), 0.0),
        };
        hand.resting_pose = hand.pose(&hand.rest_values());
        hand
    }

    /// The channels of the glove that are in use, in ascending order.
    pub fn channels(&self) -> &[usize] {
        &self.channels
    }

    /// The posture at rest.
    pub fn rest_values(&self) -> Vec<f64> {
        self.controls.iter().map(|control| control.rest).collect()
    }

    /// From now on, the channel at `place` goes back to `value` wherever the fingertip lets it choose.
    pub(super) fn set_rest(&mut self, place: usize, value: f64) {
        self.controls[place].rest = value;
    }

    /// The angles of the whole hand in this posture.
    pub fn angles(&self, values: &[f64]) -> JointAngles {
        angles_from_variables(&self.controls, values, &JointAngles::default())
    }

    /// Where the whole hand is in this posture.
    pub fn pose(&self, values: &[f64]) -> HandPose {
        let estimate = Estimate::new(Timestamp(0), self.angles(values));
        self.arm.forward(&estimate)
    }

    /// Where the index fingertip is in this posture (world, metres); the origin where the arm has none.
    pub(super) fn tip(&self, values: &[f64]) -> Vec3 {
        self.pose(values).fingertip(FINGER).unwrap_or_default()
    }

    /// Where the elbow is at rest (world, metres); the origin where the arm model does not say.
    pub(super) fn elbow(&self) -> Vec3 {
        self.resting_pose.position(Joint::Elbow).unwrap_or_default()
    }

    /// Brings the index fingertip to `tip` (world, metres) by elbow, wrist and index finger, without the
    /// channels at the places `held`. Returns how far away it stays, in metres.
    pub fn reach(&self, tip: Vec3, values: &mut [f64], held: &[usize]) -> f64 {
        let free = |place: &usize| !held.contains(place);
        let places = self.places_of(&REACHING).filter(free);
        self.bring(FINGER, places, tip, values)
    }

    /// As [`reach`](Self::reach), with the thumb at the index finger, which moves as little as it can.
    pub(super) fn reach_pinched(&self, tip: Vec3, values: &mut [f64], held: &[usize]) -> f64 {
        let meeting = self.places_of(&MEETING);
        let stiff: Vec<usize> = meeting.chain(held.iter().copied()).collect();
        let mut distance = self.reach(tip, values, &stiff);
        if distance > REACH_TOLERANCE / 3.0 {
            distance = self.reach(tip, values, held);
        }
        self.follow(values);
        distance
    }

    /// Whether pointing moves the channel at `place`.
    pub(super) fn reaches_with(&self, place: usize) -> bool {
        self.places_of(&REACHING).any(|other| other == place)
    }

    /// The places of the channels that move the thumb.
    pub(super) fn thumb(&self) -> impl Iterator<Item = usize> {
        self.places_of(&OPPOSING)
    }

    /// Brings the tips of thumb and index finger together: the thumb goes to the index finger, which
    /// meets it as far as it has to.
    pub(super) fn pinch(&self, values: &mut [f64]) {
        self.close(values);
        if self.gap(values) < PINCH_GAP {
            return;
        }
        // Two straight fingers can be stuck beside each other; half bent ones are not.
        for place in self.places_of(&OPPOSING).chain(self.places_of(&MEETING)) {
            let (low, high) = self.controls[place].range;
            values[place] = low.midpoint(high);
        }
        self.close(values);
    }

    fn close(&self, values: &mut [f64]) {
        self.follow(values);
        for _ in 0..PINCH_ROUNDS {
            let Some(goal) = self.beside(Finger::Thumb, FINGER, values) else {
                return;
            };
            if self.gap(values) < PINCH_GAP - 0.002 {
                return;
            }
            self.bring(FINGER, self.places_of(&MEETING), goal, values);
            self.follow(values);
        }
    }

    /// Brings the thumb's tip to that of the index finger, which stays.
    pub(super) fn follow(&self, values: &mut [f64]) {
        if let Some(goal) = self.beside(FINGER, Finger::Thumb, values) {
            self.bring(Finger::Thumb, self.places_of(&OPPOSING), goal, values);
        }
    }

    /// From the tip of the thumb to that of the index finger, in metres; infinite where the arm lacks
    /// one of them.
    pub(super) fn gap(&self, values: &[f64]) -> f64 {
        let pose = self.pose(values);
        let tips = pose.fingertip(Finger::Thumb).zip(pose.fingertip(FINGER));
        tips.map_or(f64::INFINITY, |(thumb, index)| {
            f64::from(thumb.distance(index))
        })
    }

    /// Where the tip of `other` is when it touches that of `finger` from the side that it is on.
    fn beside(&self, finger: Finger, other: Finger, values: &[f64]) -> Option<Vec3> {
        let pose = self.pose(values);
        let (here, there) = (pose.fingertip(finger)?, pose.fingertip(other)?);
        Some(here + (there - here).normalize_or(Vec3::NEG_Y) * PINCHED)
    }

    fn bring(
        &self,
        finger: Finger,
        places: impl Iterator<Item = usize>,
        tip: Vec3,
        values: &mut [f64],
    ) -> f64 {
        if self.resting_pose.fingertip(finger).is_none() {
            return f64::INFINITY;
        }
        let places: ArrayVec<usize, MAX_IK_VARIABLES> = places.collect();
        let controls: ArrayVec<IkVariable, MAX_IK_VARIABLES> = places
            .iter()
            .map(|&place| self.controls[place].clone())
            .collect();
        let start: ArrayVec<f64, MAX_IK_VARIABLES> =
            places.iter().map(|&place| values[place]).collect();
        let fixed = self.angles(values);
        let found = solve_ik(&self.arm, &controls, &fixed, &start, finger, tip);
        for (place, value) in places.into_iter().zip(found.values) {
            values[place] = value;
        }
        found.distance
    }

    /// The places of the channels that tell these angles.
    fn places_of(&self, dofs: &[Dof]) -> impl Iterator<Item = usize> {
        let tells =
            |control: &IkVariable| control.mappings.iter().any(|(dof, _)| dofs.contains(dof));
        let places = 0..self.controls.len();
        places.filter(move |&place| tells(&self.controls[place]))
    }

    /// The place of the channel that tells an angle, if the glove has one.
    pub(super) fn place_of(&self, dof: Dof) -> Option<usize> {
        // Of two channels that tell one angle, the later one counts.
        self.places_of(&[dof]).last()
    }

    /// The angles that the glove tells, in the order of [`Dof::ALL`].
    pub(super) fn dofs(&self) -> impl Iterator<Item = Dof> {
        let all = Dof::ALL.iter().copied();
        all.filter(|&dof| self.place_of(dof).is_some())
    }

    /// The value of the channel at `place` that shows `radians`, or the range of angles that it can show.
    pub(super) fn value(&self, place: usize, dof: Dof, radians: f64) -> Result<f64, (f64, f64)> {
        let control = &self.controls[place];
        let mut lines = control.mappings.iter().rev();
        let Some((_, line)) = lines.find(|(moved, _)| *moved == dof) else {
            return Err((0.0, 0.0));
        };
        let ends = (line.apply(control.range.0), line.apply(control.range.1));
        let (low, high) = (ends.0.min(ends.1), ends.0.max(ends.1));
        match (low..=high).contains(&radians) {
            true => Ok(line.apply_inverse(radians)),
            false => Err((low, high)),
        }
    }

    /// How the fingertip presses a key, or how far beyond the hand's reach that is, in metres: infinitely
    /// far when the target or its anchor is not there.
    pub fn tap_path(&self, scene: &Scene, target: TargetId) -> Result<TapPath, f64> {
        self.tap_path_at(scene, target, Vec2::ZERO)
    }

    /// The same beside the middle of the target's front: `at` along its own X and Y, in metres.
    pub fn tap_path_at(&self, scene: &Scene, target: TargetId, at: Vec2) -> Result<TapPath, f64> {
        let front = self.front(scene, target).ok_or(f64::INFINITY)?;
        let tip = |height| front.tip(TargetPoint { target, offset: at }, height);
        let stroke = TapPath {
            hover: tip(front.hover),
            bottom: tip(front.bottom),
        };
        let distance = self.reach(stroke.bottom, &mut self.rest_values(), &[]);
        match distance > REACH_TOLERANCE {
            true => Err(distance),
            false => Ok(stroke),
        }
    }

    /// Where a target is; `None` when it or its anchor is not there.
    pub(super) fn front(&self, scene: &Scene, target: TargetId) -> Option<Front> {
        let (surface, target) = scene.target(target)?;
        let world_from_surface = surface.world_from_surface(&self.resting_pose)?;
        Some(Front {
            world_from_target: world_from_surface * target.surface_from_target,
            hover: HOVER,
            bottom: -depth(target),
            travel: target.travel,
            tip_radius: self.resting_pose.tip_radius,
        })
    }
}

fn depth(target: &Target) -> f32 {
    target.travel + OVERTRAVEL
}

/// What each angle is at rest: the wrist straight, the palm down, the index finger half bent, the other
/// fingers held up out of the way.
fn resting_angle(dof: Dof) -> f64 {
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

/// A control that is one channel: all the angles that it tells, the counts that their joints allow.
fn channel_control(map: &ChannelMap, channel: usize) -> IkVariable {
    let limits = JointLimits::human();
    let mut control = IkVariable {
        mappings: ArrayVec::new(),
        range: (1.0, f64::from(map.full_scale()) - 1.0),
        rest: 0.0,
    };
    for row in map.rows().iter().filter(|row| row.channel == channel) {
        let (low, high) = limits.range(row.dof);
        let (one, other) = (
            row.calibration.apply_inverse(low),
            row.calibration.apply_inverse(high),
        );
        control.range.0 = control.range.0.max(one.min(other));
        control.range.1 = control.range.1.min(one.max(other));
        control.rest = row.calibration.apply_inverse(resting_angle(row.dof));
        if control
            .mappings
            .try_push((row.dof, row.calibration))
            .is_err()
        {
            break;
        }
    }
    control.rest = control.rest.clamp(control.range.0, control.range.1);
    control
}
