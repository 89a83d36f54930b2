//! Inverse kinematics: the angles that move a fingertip or another joint to a target.

use arrayvec::ArrayVec;
use glam::{DMat3, DVec3};
use parry3d::math::{Pose, Vec3};

use super::arm_model::ArmModel;
use super::joint_rotations::half_angle;
use super::link::{Link, MAX_LINKS, far_end};
use super::prepared_links::PreparedLink;
use crate::estimate::{AffineMap, JointAngles};
use crate::hand::{Dof, Joint};

/// The most variables of one problem.
pub const MAX_IK_VARIABLES: usize = 16;

const MAX_ITERATIONS: usize = 120;
/// The longest displacement of the joint in one iteration, in metres. Over a longer one the linearisation is wrong.
const MAX_STEP: f64 = 0.04;
/// The damping λ of the least squares, in metres per radian: a bone's length times a few degrees, so that
/// a stretched finger does not oscillate.
const DAMPING: f64 = 0.008;
/// The fraction of the distance to its rest value that a variable moves in each iteration, within the null space.
const REST_GAIN: f64 = 0.1;
/// The accepted distance to the target, in metres: a tenth of the resolution of an 8-bit glove.
const TOLERANCE: f64 = 5e-5;

/// One variable of an inverse kinematics problem: an angle, or several angles that a shared sensor or tendon couples.
#[derive(Clone, Debug, PartialEq)]
pub struct IkVariable {
    /// The degrees of freedom that the variable drives, each with the map from the variable's value to radians.
    pub mappings: ArrayVec<(Dof, AffineMap), 4>,
    /// The lower and upper limit of the value.
    pub range: (f64, f64),
    /// The preferred value: the one taken if it does not matter for the target.
    pub rest: f64,
}

impl IkVariable {
    /// Creates a variable that is a single angle, in radians.
    pub fn from_dof(dof: Dof, range: (f64, f64), rest: f64) -> Self {
        Self {
            mappings: [(dof, AffineMap::IDENTITY)].into_iter().collect(),
            range,
            rest,
        }
    }

    /// Returns the rotation of the fastest angle, in radians, for a change of 1.
    fn scale(&self) -> f64 {
        self.mappings
            .iter()
            .map(|(_, map)| map.gain.abs())
            .fold(f64::MIN_POSITIVE, f64::max)
    }
}

/// The best solution found for a target.
#[derive(Clone, Debug, PartialEq)]
pub struct IkSolution {
    /// The value of each variable, within its range.
    pub values: ArrayVec<f64, MAX_IK_VARIABLES>,
    /// The remaining distance from the joint to the target, in metres; large if the target is out of reach.
    pub distance: f64,
}

/// Finds values of `variables` that move a joint, or the center of a fingertip, to `target` (world, metres).
///
/// Uses damped least squares with the variables clamped to their ranges, and pulls them towards their rest values in
/// the null space. Starts at `start`; angles that no variable drives come from `fixed`. Always returns the best
/// values found: check [`IkSolution::distance`].
///
/// # Panics
/// If there are more than [`MAX_IK_VARIABLES`] variables, or if the model does not have the joint.
pub fn solve_ik(
    model: &ArmModel,
    variables: &[IkVariable],
    fixed: &JointAngles,
    start: &[f64],
    joint: Joint,
    target: Vec3,
) -> IkSolution {
    let chain = Chain::to_joint(model, joint, variables, fixed);
    let problem = Problem {
        variables,
        scales: variables.iter().map(IkVariable::scale).collect(),
    };
    let mut poses = ArrayVec::new();
    let mut values: Values = start.iter().copied().collect();
    let mut best = IkSolution {
        values: values.clone(),
        distance: f64::INFINITY,
    };
    for _ in 0..MAX_ITERATIONS {
        let position = chain.forward(&values, &mut poses);
        let error = (target - position).as_dvec3();
        if error.length() < best.distance - TOLERANCE / 10.0 {
            best.distance = error.length();
            best.values.clone_from(&values);
        } else if best.distance < TOLERANCE {
            break;
        }
        let jacobian = chain.jacobian(position, &poses, &problem.scales);
        let error = error.clamp_length_max(MAX_STEP);
        if !problem.step(&jacobian, error, &mut values) {
            // All further iterations would be the same.
            break;
        }
    }
    best
}

/// Returns `fixed` with the angles that the variables drive replaced by those for the given values.
pub fn angles_from_variables(
    variables: &[IkVariable],
    values: &[f64],
    fixed: &JointAngles,
) -> JointAngles {
    let mut angles = *fixed;
    for (variable, value) in variables.iter().zip(values) {
        for (dof, map) in &variable.mappings {
            angles.set(*dof, map.apply(*value));
        }
    }
    angles
}

/// One number for each variable.
type Values = ArrayVec<f64, MAX_IK_VARIABLES>;

/// The displacement of the joint for each variable, in metres per radian of its fastest angle.
type Jacobian = ArrayVec<DVec3, MAX_IK_VARIABLES>;

/// The variables, and their scales.
struct Problem<'a> {
    variables: &'a [IkVariable],
    scales: Values,
}

impl Problem<'_> {
    /// Changes the values by one iteration. A variable that would leave its range stops at the limit, and the step is
    /// solved again for the others. Returns `true` if a value has changed.
    fn step(&self, jacobian: &Jacobian, error: DVec3, values: &mut Values) -> bool {
        let pulls = self.variables.iter().zip(&self.scales).zip(&*values);
        let pulls: Values = pulls
            .map(|((variable, scale), value)| REST_GAIN * (variable.rest - value) * scale)
            .collect();
        let mut free: ArrayVec<usize, MAX_IK_VARIABLES> = (0..self.variables.len()).collect();
        let mut has_changed = false;
        while !free.is_empty() {
            let weights = weights(jacobian, &pulls, &free, error);
            let goal = |index: usize, value: f64| {
                let change = jacobian[index].dot(weights) + pulls[index];
                value + change / self.scales[index]
            };
            let limited = free.iter().position(|&index| {
                let (low, high) = self.variables[index].range;
                !(low..=high).contains(&goal(index, values[index]))
            });
            let Some(position) = limited else {
                for &index in &free {
                    let old = values[index];
                    values[index] = goal(index, old);
                    has_changed |= old != values[index];
                }
                break;
            };
            let index = free.remove(position);
            let (low, high) = self.variables[index].range;
            let old = values[index];
            values[index] = goal(index, old).clamp(low, high);
            has_changed |= old != values[index];
        }
        has_changed
    }
}

/// Returns the vector w = (J Jᵀ + λ²)⁻¹ · (error − J · pull) of the damped least squares. With it, the change of a variable in radians,
/// Δ = J⁺ · error + (1 − J⁺ J) · pull with J⁺ = Jᵀ (J Jᵀ + λ²)⁻¹, is the dot product of its column with w, plus its pull.
fn weights(jacobian: &Jacobian, pulls: &Values, free: &[usize], error: DVec3) -> DVec3 {
    let mut square = DMat3::from_diagonal(DVec3::splat(DAMPING * DAMPING));
    let mut pulled = DVec3::ZERO;
    for &index in free {
        let column = jacobian[index];
        square += DMat3::from_cols(column * column.x, column * column.y, column * column.z);
        pulled += column * pulls[index];
    }
    square.inverse() * (error - pulled)
}

/// The links from the root to a joint. Other links do not move it.
struct Chain {
    /// The pose of the last link before the first one that a variable turns.
    base: Pose,
    /// The links after it.
    links: ArrayVec<ChainLink, MAX_LINKS>,
    /// The index of a variable, the index in `links` of a link that it turns, and the gain; by variable, and from the joint to the
    /// root.
    turns: Vec<(usize, usize, f64)>,
    /// The distance of the joint from the pivot of the last link, in metres: the length of the link to a fingertip, otherwise 0.
    length: f32,
}

/// A link of a chain.
struct ChainLink {
    link: PreparedLink<f32, 1>,
    axis: Vec3,
    angle: Angle,
}

/// The angle of a link.
enum Angle {
    /// The sine and cosine of half the angle.
    Fixed((f32, f32)),
    /// The value of a variable with this index, mapped to radians.
    Driven(usize, AffineMap),
}

impl ChainLink {
    fn new(link: &Link, variables: &[IkVariable], fixed: &JointAngles) -> Self {
        let mut mappings = variables.iter().enumerate().flat_map(|(index, variable)| {
            let mappings = variable.mappings.iter();
            mappings.map(move |(dof, map)| (*dof, index, *map))
        });
        // Of several, the last one counts.
        let driving = mappings.rfind(|(dof, ..)| link.dof == Some(*dof));
        let radians = link.dof.map_or(0.0, |dof| fixed.get(dof));
        Self {
            link: PreparedLink::new([Some(link)], |[number]| number),
            axis: link.axis,
            angle: driving.map_or_else(
                || Angle::Fixed(half_angle(radians)),
                |(_, index, map)| Angle::Driven(index, map),
            ),
        }
    }

    fn pose(&self, parent: &Pose, values: &[f64]) -> Pose {
        let sine_and_cosine = |_| match self.angle {
            Angle::Fixed(known) => Some(known),
            Angle::Driven(index, map) => Some(half_angle(map.apply(values[index]))),
        };
        let mut pose = *parent;
        self.link.forward(&mut pose, sine_and_cosine, |_, _| {});
        pose
    }
}

impl Chain {
    fn to_joint(
        model: &ArmModel,
        joint: Joint,
        variables: &[IkVariable],
        fixed: &JointAngles,
    ) -> Self {
        let is_tip = |link: &Link| link.fingertip.map(Joint::tip) == Some(joint);
        let mut links = model.links().iter();
        let last = links.position(|link| link.joint == Some(joint) || is_tip(link));
        let last = last.expect("the model has the joint");
        let parent = |index: &usize| model.links()[*index].parent;
        let mut all: ArrayVec<usize, MAX_LINKS> =
            std::iter::successors(Some(last), parent).collect();
        all.reverse();
        let mut chain = Self {
            base: model.world_from_root(),
            links: ArrayVec::new(),
            turns: Vec::with_capacity(all.len()),
            length: if is_tip(&model.links()[last]) {
                model.links()[last].length
            } else {
                0.0
            },
        };
        let mut dofs = ArrayVec::<Option<Dof>, MAX_LINKS>::new();
        for index in all {
            let link = &model.links()[index];
            let own = ChainLink::new(link, variables, fixed);
            if chain.links.is_empty() && matches!(own.angle, Angle::Fixed(_)) {
                chain.base = own.pose(&chain.base, &[]);
            } else {
                chain.links.push(own);
                dofs.push(link.dof);
            }
        }
        for (variable, driven) in variables.iter().enumerate() {
            for (link_index, dof) in dofs.iter().enumerate().rev() {
                let mut mappings = driven.mappings.iter();
                if let Some((_, map)) = mappings.find(|(own, _)| *dof == Some(*own)) {
                    chain.turns.push((variable, link_index, map.gain));
                }
            }
        }
        chain
    }

    /// Computes the poses of the links as [`ArmModel::link_poses`] does, and returns the position of the joint.
    fn forward(&self, values: &[f64], poses: &mut ArrayVec<Pose, MAX_LINKS>) -> Vec3 {
        poses.clear();
        let mut parent = self.base;
        for link in &self.links {
            parent = link.pose(&parent, values);
            poses.push(parent);
        }
        far_end(self.length, &parent).translation
    }

    /// Returns the displacement of the joint per radian of each variable's fastest angle.
    fn jacobian(&self, position: Vec3, poses: &[Pose], scales: &Values) -> Jacobian {
        let mut columns: Jacobian = scales.iter().map(|_| DVec3::ZERO).collect();
        for &(variable, link_index, gain) in &self.turns {
            let pose = &poses[link_index];
            let axis = pose.rotation * self.links[link_index].axis;
            let lever = position - pose.translation;
            columns[variable] += axis.cross(lever).as_dvec3() * gain;
        }
        for (column, scale) in columns.iter_mut().zip(scales) {
            *column /= *scale;
        }
        columns
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::{Estimate, JointLimits};
    use crate::hand::{Finger, Side};
    use crate::kinematics::BoneLengths;
    use crate::time::Timestamp;

    fn arm() -> (ArmModel, Vec<IkVariable>) {
        let bones = BoneLengths::from_hand_and_forearm(0.190, 0.255).unwrap();
        let limits = JointLimits::human();
        let dofs = [
            (Dof::ElbowFlexion, 0.6),
            (Dof::WristFlexion, 0.0),
            (Dof::WristDeviation, 0.0),
            (Dof::IndexMcpFlexion, 0.5),
            (Dof::IndexPipFlexion, 0.5),
        ];
        let variables = dofs.map(|(dof, rest)| IkVariable::from_dof(dof, limits.range(dof), rest));
        let model = ArmModel::anthropometric(Side::Right, &bones).unwrap();
        (model, variables.to_vec())
    }

    #[test]
    fn the_links_of_a_chain_are_where_those_of_the_whole_arm_are() {
        let (model, variables) = arm();
        let values = [0.7, -0.2, 0.1, 0.6, 0.9];
        let angles = angles_from_variables(&variables, &values, &JointAngles::default());
        let all = model.link_poses(&angles);
        for &finger in Finger::ALL {
            let chain = Chain::to_joint(
                &model,
                Joint::tip(finger),
                &variables,
                &JointAngles::default(),
            );
            let mut poses = ArrayVec::new();
            let fingertip = chain.forward(&values, &mut poses);
            let links = model.links();
            let last = links.iter().position(|link| link.fingertip == Some(finger));
            let mut next = last;
            for (number, pose) in poses.iter().rev().enumerate() {
                let link = next.expect("a chain is no longer than the arm");
                assert_eq!(*pose, all[link], "{finger} {number}");
                next = links[link].parent;
            }
            let last = last.expect("an arm has five fingers");
            let expected = far_end(links[last].length, &all[last]).translation;
            assert_eq!(fingertip, expected, "{finger}");
        }
    }

    #[test]
    fn every_position_away_from_the_joint_limits_is_reached() {
        let (model, variables) = arm();
        let fixed = JointAngles::default();
        let rest: Vec<f64> = variables.iter().map(|variable| variable.rest).collect();
        for number in 0..200 {
            let expected: Vec<f64> = variables
                .iter()
                .enumerate()
                .map(|(index, variable)| {
                    let fraction = (number as f64 * 0.618_034 * (index + 1) as f64).fract();
                    let (low, high) = variable.range;
                    low + (0.05 + 0.9 * fraction) * (high - low)
                })
                .collect();
            let angles = angles_from_variables(&variables, &expected, &fixed);
            let pose = model.forward(&Estimate::new(Timestamp(0), angles));
            let target = pose.fingertip(Finger::Index).unwrap();
            let found = solve_ik(&model, &variables, &fixed, &rest, Joint::IndexTip, target);
            assert!(found.distance < 1e-3, "{number}: {}", found.distance);
            for (value, variable) in found.values.iter().zip(&variables) {
                assert!((variable.range.0..=variable.range.1).contains(value));
            }
        }
    }

    #[test]
    fn a_knuckle_is_moved_by_the_arm_and_not_by_its_finger() {
        let (model, variables) = arm();
        let fixed = JointAngles::default();
        let rest: Vec<f64> = variables.iter().map(|variable| variable.rest).collect();
        let knuckle = Joint::IndexPhalanxProximal;
        let position = |values: &[f64]| {
            let angles = angles_from_variables(&variables, values, &fixed);
            let pose = model.forward(&Estimate::new(Timestamp(0), angles));
            pose.position(knuckle).expect("a knuckle")
        };
        let target = position(&[0.7, -0.2, 0.1, 0.5, 0.5]);
        let found = solve_ik(&model, &variables, &fixed, &rest, knuckle, target);
        assert!(found.distance < 1e-3, "{}", found.distance);
        assert!(position(&found.values).distance(target) < 1e-3);
        assert_eq!(found.values[3..], rest[3..]);
    }

    #[test]
    fn a_target_out_of_reach_returns_its_distance() {
        let (model, variables) = arm();
        let fixed = JointAngles::default();
        let rest: Vec<f64> = variables.iter().map(|variable| variable.rest).collect();
        let far = Vec3::new(0.0, 0.0, -5.0);
        let found = solve_ik(&model, &variables, &fixed, &rest, Joint::IndexTip, far);
        assert!(found.distance > 4.0 && found.distance.is_finite());
    }
}
