//! Inverse kinematics: the angles that move a fingertip to a target.

use arrayvec::ArrayVec;
use glam::{DMat3, DVec3};
use parry3d::math::{Pose, Vec3};

use super::arm_model::ArmModel;
use super::link::{MAX_LINKS, far_end};
use crate::estimate::{AffineMap, JointAngles};
use crate::hand::{Dof, Finger};

/// The most variables of one problem.
pub const MAX_IK_VARIABLES: usize = 16;

const MAX_ITERATIONS: usize = 120;
/// The longest displacement of the fingertip in one iteration, in metres. Over a longer one the linearisation is wrong.
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
    /// The remaining distance from the fingertip to the target, in metres; large if the target is out of reach.
    pub distance: f64,
}

/// Finds values of `variables` that move the center of a fingertip to `target` (world, metres).
///
/// Uses damped least squares with the variables clamped to their ranges, and pulls them towards their rest values in
/// the null space. Starts at `start`; angles that no variable drives are those of `fixed`. Always returns the best
/// values found: check [`IkSolution::distance`].
///
/// # Panics
/// If there are more than [`MAX_IK_VARIABLES`] variables, or if the model does not have the finger.
pub fn solve_ik(
    model: &ArmModel,
    variables: &[IkVariable],
    fixed: &JointAngles,
    start: &[f64],
    finger: Finger,
    target: Vec3,
) -> IkSolution {
    let chain = Chain::to_fingertip(model, finger);
    let mut values: ArrayVec<f64, MAX_IK_VARIABLES> = start.iter().copied().collect();
    let mut best = IkSolution {
        values: values.clone(),
        distance: f64::INFINITY,
    };
    for _ in 0..MAX_ITERATIONS {
        let angles = angles_from_variables(variables, &values, fixed);
        let poses = model.link_poses(&angles);
        let error = (target - chain.fingertip(model, &poses)).as_dvec3();
        if error.length() < best.distance - TOLERANCE / 10.0 {
            best.distance = error.length();
            best.values.clone_from(&values);
        } else if best.distance < TOLERANCE {
            break;
        }
        let jacobian = chain.jacobian(model, &poses, variables);
        step(
            variables,
            &jacobian,
            error.clamp_length_max(MAX_STEP),
            &mut values,
        );
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

/// Changes the values by one iteration. A variable that would leave its range stops at the limit, and the step is
/// solved again for the others.
fn step(variables: &[IkVariable], jacobian: &[DVec3], error: DVec3, values: &mut [f64]) {
    let mut free: ArrayVec<bool, MAX_IK_VARIABLES> = variables.iter().map(|_| true).collect();
    for _ in 0..variables.len() {
        let active: ArrayVec<DVec3, MAX_IK_VARIABLES> = jacobian
            .iter()
            .zip(&free)
            .map(|(column, free)| if *free { *column } else { DVec3::ZERO })
            .collect();
        let changes = changes(variables, &active, error, values);
        let limited = (0..variables.len()).find(|&index| {
            let (low, high) = variables[index].range;
            free[index] && !(low..=high).contains(&(values[index] + changes[index]))
        });
        let Some(index) = limited else {
            for ((value, change), free) in values.iter_mut().zip(&changes).zip(&free) {
                *value += if *free { *change } else { 0.0 };
            }
            return;
        };
        let (low, high) = variables[index].range;
        values[index] = (values[index] + changes[index]).clamp(low, high);
        free[index] = false;
    }
}

/// Solves Δ = J⁺ · error + (1 − J⁺ J) · pull, with J⁺ = Jᵀ (J Jᵀ + λ²)⁻¹, in radians of each variable.
fn changes(
    variables: &[IkVariable],
    jacobian: &[DVec3],
    error: DVec3,
    values: &[f64],
) -> ArrayVec<f64, MAX_IK_VARIABLES> {
    let mut square = DMat3::from_diagonal(DVec3::splat(DAMPING * DAMPING));
    for column in jacobian {
        square += DMat3::from_cols(*column * column.x, *column * column.y, *column * column.z);
    }
    let inverse = square.inverse();
    let pulls: ArrayVec<f64, MAX_IK_VARIABLES> = variables
        .iter()
        .zip(values)
        .map(|(variable, value)| REST_GAIN * (variable.rest - value) * variable.scale())
        .collect();
    let pulled: DVec3 = jacobian
        .iter()
        .zip(&pulls)
        .map(|(column, pull)| *column * *pull)
        .sum();
    let weights = inverse * (error - pulled);
    jacobian
        .iter()
        .zip(&pulls)
        .zip(variables)
        .map(|((column, pull), variable)| (column.dot(weights) + pull) / variable.scale())
        .collect()
}

/// The links from a fingertip to the root.
struct Chain {
    links: ArrayVec<usize, MAX_LINKS>,
}

impl Chain {
    fn to_fingertip(model: &ArmModel, finger: Finger) -> Self {
        let last = model
            .links()
            .iter()
            .position(|link| link.fingertip == Some(finger));
        let mut links = ArrayVec::new();
        let mut next = Some(last.expect("the model has the finger"));
        while let Some(index) = next {
            links.push(index);
            next = model.links()[index].parent;
        }
        Self { links }
    }

    fn fingertip(&self, model: &ArmModel, poses: &[Pose]) -> Vec3 {
        let last = self.links[0];
        far_end(model.links()[last].length, &poses[last]).translation
    }

    /// Returns the displacement of the fingertip per radian of each variable's fastest angle.
    fn jacobian(
        &self,
        model: &ArmModel,
        poses: &[Pose],
        variables: &[IkVariable],
    ) -> ArrayVec<DVec3, MAX_IK_VARIABLES> {
        let fingertip = self.fingertip(model, poses);
        variables
            .iter()
            .map(|variable| {
                let columns = self.links.iter().map(|&index| {
                    let link = &model.links()[index];
                    let Some((_, map)) = variable
                        .mappings
                        .iter()
                        .find(|(dof, _)| link.dof == Some(*dof))
                    else {
                        return DVec3::ZERO;
                    };
                    let axis = poses[index].rotation * link.axis;
                    let lever = fingertip - poses[index].translation;
                    axis.cross(lever).as_dvec3() * map.gain
                });
                columns.sum::<DVec3>() / variable.scale()
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::{Estimate, JointLimits};
    use crate::hand::Side;
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
            let found = solve_ik(&model, &variables, &fixed, &rest, Finger::Index, target);
            assert!(found.distance < 1e-3, "{number}: {}", found.distance);
            for (value, variable) in found.values.iter().zip(&variables) {
                assert!((variable.range.0..=variable.range.1).contains(value));
            }
        }
    }

    #[test]
    fn a_target_out_of_reach_returns_its_distance() {
        let (model, variables) = arm();
        let fixed = JointAngles::default();
        let rest: Vec<f64> = variables.iter().map(|variable| variable.rest).collect();
        let far = Vec3::new(0.0, 0.0, -5.0);
        let found = solve_ik(&model, &variables, &fixed, &rest, Finger::Index, far);
        assert!(found.distance > 4.0 && found.distance.is_finite());
    }
}
