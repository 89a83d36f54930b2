//! Postures of a hand that points with the index finger, and inverse kinematics from targets to postures.

use arrayvec::ArrayVec;
use parry3d::math::Vec3;

use super::effector::Effector;
use super::room::place_of_carrier;
use super::sensor::body_points;
use crate::estimate::{AffineMap, BendRanges, ChannelMap, Estimate, JointAngles, JointLimits};
use crate::hand::{Dof, Finger, Input, Joint, Side};
use crate::kinematics::{
    ArmModel, HandPose, IkVariable, MAX_IK_VARIABLES, StartPlace, angles_from_variables,
    half_bent_fingers, solve_ik, typing_angle,
};
use crate::time::Timestamp;

/// The finger that points. The other fingers are extended out of the way.
const FINGER: Finger = Finger::Index;
/// Largest error of the inverse kinematics, in metres. A point with a larger error is out of reach.
pub const REACH_TOLERANCE: f64 = 0.003;
/// Distance between the centers of two pinched fingertips, in metres: pads of 5 mm that give way a little.
const PINCHED: f32 = 0.008;
/// Largest distance of two fingertips that pinch, in metres.
pub(super) const PINCH_GAP: f64 = 0.012;
/// Number of attempts to bring thumb and index finger together.
const PINCH_ROUNDS: usize = 60;

/// Angles that move the hand as a whole.
const CARRYING: [Dof; 5] = [
    Dof::ShoulderZ,
    Dof::ShoulderY,
    Dof::ElbowFlexion,
    Dof::WristFlexion,
    Dof::WristDeviation,
];
/// Angles that move the thumb to the index finger.
const OPPOSING: [Dof; 4] = [
    Dof::ThumbCmcAbduction,
    Dof::ThumbCmcFlexion,
    Dof::ThumbMcpFlexion,
    Dof::ThumbIpFlexion,
];
/// Angles that move the index finger to a thumb that cannot reach it.
const MEETING: [Dof; 2] = [Dof::IndexMcpFlexion, Dof::IndexPipFlexion];

/// A hand in a glove: wrist straight, palm down, index finger half flexed above the keys.
///
/// It moves the angles that the glove measures. Its posture is one value per channel in use, in the order of
/// [`channels`](Self::channels): the linear count of the channel before rounding.
#[derive(Clone, Debug)]
pub struct TypingHand {
    arm: ArmModel,
    channels: Vec<usize>,
    pub(super) variables: Vec<IkVariable>,
    /// The angles that the glove does not measure.
    assumed: JointAngles,
    /// The sticks, triggers and buttons of the glove.
    inputs: Vec<Input>,
    /// The sensor shows head and legs too.
    shows_body: bool,
    bend_ranges: BendRanges,
    pub(super) resting_pose: HandPose,
    /// The place of the open hand at the start.
    start: StartPlace,
    /// The wrist of a hand that carries a board of this one (world, metres).
    other_wrist: Option<Vec3>,
    /// `true` if the sensor shows the hand as a whole and not its joints.
    is_stiff: bool,
}

impl TypingHand {
    /// Creates the hand of an arm that wears a glove with these channels.
    pub fn new(arm: &ArmModel, map: &ChannelMap) -> Self {
        let channels = map.angle_channels();
        let variables = channels.iter().map(|&channel| variable(map, channel));
        let mut assumed = JointAngles::default();
        for &(dof, radians) in map.assumed_angles() {
            assumed.set(dof, radians);
        }
        Self {
            arm: arm.clone(),
            assumed,
            inputs: map.inputs().iter().map(|row| row.input).collect(),
            shows_body: false,
            bend_ranges: BendRanges::of_glove(map),
            variables: variables.collect(),
            channels,
            resting_pose: HandPose::new(Timestamp(0), arm.side(), 0.0),
            start: StartPlace::default(),
            other_wrist: None,
            is_stiff: false,
        }
        .at_rest()
    }

    /// Creates the hand of an arm whose joints are measured without a glove: each joint angle is a channel. The last joint
    /// of a finger follows the joint before it, because one tendon pulls both.
    pub fn without_glove(arm: &ArmModel) -> Self {
        let limits = JointLimits::human();
        let links = arm.links().iter().filter_map(|link| link.dof);
        let variable = |dof| {
            let mut variable = IkVariable::from_dof(dof, limits.range(dof), typing_angle(dof));
            if let Some(last) = follower(dof) {
                let (low, high) = limits.range(last);
                variable.range = (variable.range.0.max(low), variable.range.1.min(high));
                variable.mappings.push((last, AffineMap::IDENTITY));
            }
            variable
        };
        let links =
            links.filter(|&dof| !Dof::ALL.iter().any(|&other| follower(other) == Some(dof)));
        let variables: Vec<IkVariable> = links.map(variable).collect();
        Self {
            arm: arm.clone(),
            assumed: JointAngles::default(),
            inputs: Vec::new(),
            shows_body: false,
            bend_ranges: BendRanges::human(),
            channels: (0..variables.len()).collect(),
            variables,
            resting_pose: HandPose::new(Timestamp(0), arm.side(), 0.0),
            start: StartPlace::default(),
            other_wrist: None,
            is_stiff: false,
        }
        .at_rest()
    }

    /// Returns `true` if the glove has this stick, trigger or button.
    pub fn has_input(&self, input: Input) -> bool {
        self.inputs.contains(&input)
    }

    /// Becomes the hand of a sensor that shows head and legs too.
    #[must_use]
    pub(super) fn with_body(self) -> Self {
        Self {
            shows_body: true,
            ..self
        }
    }

    /// Returns `true` if the sensor shows head and legs.
    pub fn shows_body(&self) -> bool {
        self.shows_body
    }

    /// Returns the side.
    pub fn side(&self) -> Side {
        self.arm.side()
    }

    /// Becomes the hand of a sensor that shows it as a whole: only the path of the index fingertip counts.
    pub(super) fn stiffened(self) -> Self {
        Self {
            is_stiff: true,
            ..self
        }
    }

    /// Returns `true` if only the path of the index fingertip counts.
    pub(super) fn is_stiff(&self) -> bool {
        self.is_stiff
    }

    /// Returns the arm.
    pub(super) fn arm(&self) -> &ArmModel {
        &self.arm
    }

    /// Returns the hand with the pose of its posture at rest.
    pub(super) fn at_rest(mut self) -> Self {
        self.start = StartPlace::from_pose(&self.pose(&self.open_values()));
        let mut resting_pose = self.pose(&self.rest_values());
        self.other_wrist = place_of_carrier(&resting_pose);
        resting_pose.other_wrist = self.other_wrist;
        Self {
            resting_pose,
            ..self
        }
    }

    /// Returns the posture at the start of a layout that is placed by the hand: at rest, with straight fingers.
    pub(super) fn open_values(&self) -> Vec<f64> {
        let mut values = self.rest_values();
        for (index, value) in values.iter_mut().enumerate() {
            if self.finger_of(index).is_some() {
                *value = self.value_near(index, 0.0);
            }
        }
        values
    }

    /// Returns the channels of the glove that are in use, in ascending order.
    pub fn channels(&self) -> &[usize] {
        &self.channels
    }

    /// Returns the posture at rest.
    pub fn rest_values(&self) -> Vec<f64> {
        self.variables
            .iter()
            .map(|variable| variable.rest)
            .collect()
    }

    /// Sets the rest value of a channel, to which it returns where the fingertip leaves it free.
    pub(super) fn set_rest(&mut self, index: usize, value: f64) {
        self.variables[index].rest = value;
    }

    /// Returns the joint angles of a posture.
    pub fn angles(&self, values: &[f64]) -> JointAngles {
        angles_from_variables(&self.variables, values, &self.assumed)
    }

    /// Returns the pose of the hand in a posture.
    pub fn pose(&self, values: &[f64]) -> HandPose {
        self.placed(self.angles(values))
    }

    fn placed(&self, angles: JointAngles) -> HandPose {
        let mut pose = self.arm.forward(&Estimate::new(Timestamp(0), angles));
        pose.start = self.start;
        pose.other_wrist = self.other_wrist;
        pose.body = body_points(&pose);
        pose
    }

    /// Returns the pose of a hand whose arm rests and whose fingers are half bent.
    pub(super) fn half_bent_pose(&self) -> HandPose {
        let mut angles = self.angles(&self.rest_values());
        let fingers = half_bent_fingers();
        for &dof in Dof::ALL.iter().filter(|dof| dof.finger().is_some()) {
            angles.set(dof, fingers.get(dof));
        }
        self.placed(angles)
    }

    /// Returns a fingertip in a posture (world, metres); the origin if the arm has none.
    pub(super) fn tip_of(&self, finger: Finger, values: &[f64]) -> Vec3 {
        self.pose(values).fingertip(finger).unwrap_or_default()
    }

    /// Returns the elbow at rest (world, metres); the origin if the arm model has none.
    pub(super) fn elbow(&self) -> Vec3 {
        self.resting_pose.position(Joint::Elbow).unwrap_or_default()
    }

    /// Moves the index fingertip to `tip` (world, metres) by elbow, wrist and index finger, except the channels with
    /// the indices `locked`. Returns the remaining distance in metres.
    pub fn reach(&self, tip: Vec3, values: &mut [f64], locked: &[usize]) -> f64 {
        self.reach_with(Effector::INDEX, tip, values, locked)
    }

    /// Does the same as [`reach`](Self::reach) with another finger or fewer joints.
    pub(super) fn reach_with(
        &self,
        effector: Effector,
        tip: Vec3,
        values: &mut [f64],
        locked: &[usize],
    ) -> f64 {
        let indices = (0..self.variables.len()).filter(|&index| self.is_used_by(effector, index));
        let free = indices.filter(|index| !locked.contains(index));
        self.solve(Joint::tip(effector.finger), free, tip, values)
    }

    /// Moves a joint of the palm or the wrist to `goal` (world, metres) by shoulder, elbow and wrist; the fingers stay as they are.
    /// Returns the remaining distance in metres.
    pub(super) fn carry(&self, joint: Joint, goal: Vec3, values: &mut [f64]) -> f64 {
        self.solve(joint, self.indices_of(&CARRYING), goal, values)
    }

    /// Like [`reach`](Self::reach), with the thumb at the index finger. The index finger moves as little as possible.
    pub(super) fn reach_pinched(&self, tip: Vec3, values: &mut [f64], locked: &[usize]) -> f64 {
        let meeting = self.indices_of(&MEETING);
        let with_finger: Vec<usize> = meeting.chain(locked.iter().copied()).collect();
        let mut distance = self.reach(tip, values, &with_finger);
        if distance > REACH_TOLERANCE / 3.0 {
            distance = self.reach(tip, values, locked);
        }
        self.bring_thumb_to_index(values);
        distance
    }

    /// Returns `true` if pointing with the index finger moves a channel.
    pub(super) fn is_used_to_reach(&self, index: usize) -> bool {
        self.is_used_by(Effector::INDEX, index)
    }

    fn is_used_by(&self, effector: Effector, index: usize) -> bool {
        let mut measured = self.variables[index].mappings.iter();
        measured.any(|(dof, _)| effector.uses(*dof))
    }

    /// Returns the finger that a channel measures; `None` for the arm.
    pub(super) fn finger_of(&self, index: usize) -> Option<Finger> {
        let first = self.variables[index].mappings.first();
        first.and_then(|(dof, _)| dof.finger())
    }

    /// Returns the value of a channel at which its first angle is as near to `radians` as it can be.
    pub(super) fn value_near(&self, index: usize, radians: f64) -> f64 {
        let variable = &self.variables[index];
        let (low, high) = variable.range;
        let first = variable.mappings.first();
        let value = first.map(|(_, map)| map.apply_inverse(radians));
        value.unwrap_or(variable.rest).clamp(low, high)
    }

    /// Returns the indices of the channels that move the thumb.
    pub(super) fn thumb_indices(&self) -> impl Iterator<Item = usize> {
        self.indices_of(&OPPOSING)
    }

    /// Brings the tips of thumb and index finger together. The index finger moves only as far as the thumb cannot.
    pub(super) fn pinch(&self, values: &mut [f64]) {
        self.close_pinch(values);
        if self.pinch_gap(values) < PINCH_GAP {
            return;
        }
        // Two extended fingers can block each other; two half flexed ones cannot.
        for index in self.indices_of(&OPPOSING).chain(self.indices_of(&MEETING)) {
            let (low, high) = self.variables[index].range;
            values[index] = low.midpoint(high);
        }
        self.close_pinch(values);
    }

    fn close_pinch(&self, values: &mut [f64]) {
        self.bring_thumb_to_index(values);
        for _ in 0..PINCH_ROUNDS {
            let Some(goal) = self.pinch_position(Finger::Thumb, FINGER, values) else {
                return;
            };
            if self.pinch_gap(values) < PINCH_GAP - 0.002 {
                return;
            }
            self.solve(Joint::tip(FINGER), self.indices_of(&MEETING), goal, values);
            self.bring_thumb_to_index(values);
        }
    }

    /// Moves the tip of the thumb to the index finger, which stays.
    pub(super) fn bring_thumb_to_index(&self, values: &mut [f64]) {
        if let Some(goal) = self.pinch_position(FINGER, Finger::Thumb, values) {
            self.solve(Joint::ThumbTip, self.indices_of(&OPPOSING), goal, values);
        }
    }

    /// Returns the distance from the tip of the thumb to the tip of the index finger in metres; infinity if the arm
    /// lacks one of them.
    pub(super) fn pinch_gap(&self, values: &[f64]) -> f64 {
        let pose = self.pose(values);
        let tips = pose.fingertip(Finger::Thumb).zip(pose.fingertip(FINGER));
        tips.map_or(f64::INFINITY, |(thumb, index)| {
            f64::from(thumb.distance(index))
        })
    }

    /// Returns the position of the tip of `other` (world, metres) where it touches the tip of `finger` from its side.
    fn pinch_position(&self, finger: Finger, other: Finger, values: &[f64]) -> Option<Vec3> {
        let pose = self.pose(values);
        let (tip, other_tip) = (pose.fingertip(finger)?, pose.fingertip(other)?);
        Some(tip + (other_tip - tip).normalize_or(Vec3::NEG_Y) * PINCHED)
    }

    /// Moves a joint to `goal` with the channels `indices`. Returns the remaining distance in metres.
    fn solve(
        &self,
        joint: Joint,
        indices: impl Iterator<Item = usize>,
        goal: Vec3,
        values: &mut [f64],
    ) -> f64 {
        if self.resting_pose.position(joint).is_none() {
            return f64::INFINITY;
        }
        let indices: ArrayVec<usize, MAX_IK_VARIABLES> = indices.collect();
        let variables = indices.iter().map(|&index| self.variables[index].clone());
        let variables: ArrayVec<IkVariable, MAX_IK_VARIABLES> = variables.collect();
        let start = indices.iter().map(|&index| values[index]);
        let start: ArrayVec<f64, MAX_IK_VARIABLES> = start.collect();
        let fixed = self.angles(values);
        let solution = solve_ik(&self.arm, &variables, &fixed, &start, joint, goal);
        for (index, value) in indices.into_iter().zip(solution.values) {
            values[index] = value;
        }
        solution.distance
    }

    /// Returns the indices of the channels that measure one of these angles.
    fn indices_of(&self, dofs: &[Dof]) -> impl Iterator<Item = usize> {
        let measures = |variable: &IkVariable| {
            let mut measured = variable.mappings.iter().map(|(dof, _)| dof);
            measured.any(|dof| dofs.contains(dof))
        };
        let indices = 0..self.variables.len();
        indices.filter(move |&index| measures(&self.variables[index]))
    }

    /// Returns the index of the channel that measures an angle; `None` if the glove has none.
    pub(super) fn index_of(&self, dof: Dof) -> Option<usize> {
        // Of two channels for one angle, the estimator uses the later one.
        self.indices_of(&[dof]).last()
    }

    /// Returns the angles that the glove measures, in the order of [`Dof::ALL`].
    pub(super) fn dofs(&self) -> impl Iterator<Item = Dof> {
        let all = Dof::ALL.iter().copied();
        all.filter(|&dof| self.index_of(dof).is_some())
    }

    /// Returns the value of a channel at which an angle is `radians`. The error is the range of angles, in radians,
    /// that the channel covers.
    pub(super) fn value_at(&self, index: usize, dof: Dof, radians: f64) -> Result<f64, (f64, f64)> {
        let variable = &self.variables[index];
        let mut mappings = variable.mappings.iter().rev();
        let Some((_, map)) = mappings.find(|(mapped, _)| *mapped == dof) else {
            return Err((0.0, 0.0));
        };
        let ends = (map.apply(variable.range.0), map.apply(variable.range.1));
        let (low, high) = (ends.0.min(ends.1), ends.0.max(ends.1));
        if (low..=high).contains(&radians) {
            Ok(map.apply_inverse(radians))
        } else {
            Err((low, high))
        }
    }

    /// Returns the channels that bend a finger, with their values at a bend, a fraction of the range of the finger.
    pub(super) fn values_at_bend(&self, finger: Finger, bend: f64) -> Vec<(usize, f64)> {
        let mut values: Vec<(usize, f64)> = Vec::new();
        for (dof, radians) in self.bend_ranges.angles_at(finger, bend) {
            let Some(index) = self.index_of(dof) else {
                continue;
            };
            let IkVariable {
                mappings, range, ..
            } = &self.variables[index];
            let mut mappings = mappings.iter().rev();
            if let Some((_, map)) = mappings.find(|(mapped, _)| *mapped == dof)
                && values.iter().all(|(other, _)| *other != index)
            {
                values.push((index, map.apply_inverse(radians).clamp(range.0, range.1)));
            }
        }
        values
    }
}

/// Returns the angle of the last joint of a finger that follows `dof`.
fn follower(dof: Dof) -> Option<Dof> {
    match dof {
        Dof::ThumbMcpFlexion => Some(Dof::ThumbIpFlexion),
        Dof::IndexPipFlexion => Some(Dof::IndexDipFlexion),
        Dof::MiddlePipFlexion => Some(Dof::MiddleDipFlexion),
        Dof::RingPipFlexion => Some(Dof::RingDipFlexion),
        Dof::LittlePipFlexion => Some(Dof::LittleDipFlexion),
        _ => None,
    }
}

/// Returns the variable of a channel: the angles that it measures, and the counts that their limits allow.
fn variable(map: &ChannelMap, channel: usize) -> IkVariable {
    let limits = JointLimits::human();
    let mut variable = IkVariable {
        mappings: ArrayVec::new(),
        range: (1.0, f64::from(map.full_scale()) - 1.0),
        rest: 0.0,
    };
    for row in map.rows().iter().filter(|row| row.channel == channel) {
        let calibration = row.calibration;
        let (least, most) = limits.range(row.dof);
        let ends = (
            calibration.apply_inverse(least),
            calibration.apply_inverse(most),
        );
        let low = variable.range.0.max(ends.0.min(ends.1));
        let high = variable.range.1.min(ends.0.max(ends.1));
        // A wrong calibration puts the whole range of a joint beyond the counts of its sensor.
        if low <= high {
            variable.range = (low, high);
        }
        variable.rest = calibration.apply_inverse(typing_angle(row.dof));
        if variable.mappings.try_push((row.dof, calibration)).is_err() {
            break;
        }
    }
    variable.rest = variable.rest.clamp(variable.range.0, variable.range.1);
    variable
}
