//! Which angles put a fingertip where it is wanted.

use arrayvec::ArrayVec;
use glam::{DMat3, DVec3};
use parry3d::math::{Pose, Vec3};

use super::arm_model::{ArmModel, MAX_LINKS, far_end};
use crate::estimate::{AffineMap, JointAngles};
use crate::hand::{Dof, Finger};

/// The most controls that one solution moves.
pub const MAX_IK_VARIABLES: usize = 16;

const ITERATIONS: usize = 120;
/// The longest way that the fingertip is asked to go in one step, in metres: further than that the
/// arm is no longer the straight line that a step takes it for.
const STRIDE: f64 = 0.04;
/// Damping λ of the least squares, in metres per radian: a bone's length times a few degrees, so that
/// a stretched finger does not thrash.
const DAMPING: f64 = 0.008;
/// The share of the way to its rest value that a control goes in each step, where that moves nothing.
const REST_PULL: f64 = 0.1;
/// Good enough, in metres: a tenth of what an 8-bit glove can tell.
const CLOSE_ENOUGH: f64 = 5e-5;

/// Something that can be turned: one angle, or several that a shared sensor or tendon couples.
#[derive(Clone, Debug, PartialEq)]
pub struct IkVariable {
    /// What it moves: each angle (radians) is a line of the control's value.
    pub mappings: ArrayVec<(Dof, AffineMap), 4>,
    /// The values that it can take, lowest first.
    pub range: (f64, f64),
    /// The value that it takes where nothing else is wanted of it.
    pub rest: f64,
}

impl IkVariable {
    /// A control that is one angle, in radians.
    pub fn from_dof(dof: Dof, range: (f64, f64), rest: f64) -> Self {
        let itself = AffineMap {
            gain: 1.0,
            offset: 0.0,
        };
        Self {
            mappings: [(dof, itself)].into_iter().collect(),
            range,
            rest,
        }
    }

    /// Radians that its fastest angle turns for a change of 1.
    fn scale(&self) -> f64 {
        self.mappings
            .iter()
            .map(|(_, line)| line.gain.abs())
            .fold(f64::MIN_POSITIVE, f64::max)
    }
}

/// What was found for a target.
#[derive(Clone, Debug, PartialEq)]
pub struct IkSolution {
    /// The value of each control, within its range.
    pub values: ArrayVec<f64, MAX_IK_VARIABLES>,
    /// How far the fingertip is from the target, in metres; large when it is out of reach.
    pub distance: f64,
}

/// Turns `controls` so that the centre of a fingertip comes to `target` (world, metres).
///
/// Damped least squares with the controls held within their ranges; among the ways to reach the
/// target, one near the controls' rest values. Begins at `start`; angles that no control moves are
/// those of `fixed`. Always gives the best it found: look at [`Solution::distance`].
///
/// # Panics
/// When there are more than [`MAX_CONTROLS`] controls, or the model lacks the finger.
pub fn solve_ik(
    model: &ArmModel,
    controls: &[IkVariable],
    fixed: &JointAngles,
    start: &[f64],
    finger: Finger,
    target: Vec3,
) -> IkSolution {
    let chain = Chain::to(model, finger);
    let mut values: ArrayVec<f64, MAX_IK_VARIABLES> = start.iter().copied().collect();
    let mut best = IkSolution {
        values: values.clone(),
        distance: f64::INFINITY,
    };
    for _ in 0..ITERATIONS {
        let angles = angles_from_variables(controls, &values, fixed);
        let poses = model.link_poses(&angles);
        let missing = (target - chain.tip(model, &poses)).as_dvec3();
        if missing.length() < best.distance - CLOSE_ENOUGH / 10.0 {
            best.distance = missing.length();
            best.values.clone_from(&values);
        } else if best.distance < CLOSE_ENOUGH {
            break;
        }
        let columns = chain.columns(model, &poses, controls);
        step(
            controls,
            &columns,
            missing.clamp_length_max(STRIDE),
            &mut values,
        );
    }
    best
}

/// The angles that the controls give with these values, over those of `fixed`.
pub fn angles_from_variables(
    controls: &[IkVariable],
    values: &[f64],
    fixed: &JointAngles,
) -> JointAngles {
    let mut angles = *fixed;
    for (control, value) in controls.iter().zip(values) {
        for (dof, line) in &control.mappings {
            angles.set(*dof, line.apply(*value));
        }
    }
    angles
}

/// One step: towards the target, and to rest where that does not move the fingertip.
fn step(controls: &[IkVariable], columns: &[DVec3], missing: DVec3, values: &mut [f64]) {
    let mut free: ArrayVec<bool, MAX_IK_VARIABLES> = controls.iter().map(|_| true).collect();
    // A control that would leave its range stands at the end, and the others do its share.
    for _ in 0..controls.len() {
        let active: ArrayVec<DVec3, MAX_IK_VARIABLES> = columns
            .iter()
            .zip(&free)
            .map(|(column, free)| if *free { *column } else { DVec3::ZERO })
            .collect();
        let wanted = changes(controls, &active, missing, values);
        let blocked = (0..controls.len()).find(|&place| {
            let (low, high) = controls[place].range;
            free[place] && !(low..=high).contains(&(values[place] + wanted[place]))
        });
        let Some(place) = blocked else {
            for ((value, change), free) in values.iter_mut().zip(&wanted).zip(&free) {
                *value += if *free { *change } else { 0.0 };
            }
            return;
        };
        let (low, high) = controls[place].range;
        values[place] = (values[place] + wanted[place]).clamp(low, high);
        free[place] = false;
    }
}

/// Δ = J⁺ · missing + (1 − J⁺ J) · pull, with J⁺ = Jᵀ (J Jᵀ + λ²)⁻¹, in radians of each control.
fn changes(
    controls: &[IkVariable],
    columns: &[DVec3],
    missing: DVec3,
    values: &[f64],
) -> ArrayVec<f64, MAX_IK_VARIABLES> {
    let mut square = DMat3::from_diagonal(DVec3::splat(DAMPING * DAMPING));
    for column in columns {
        square += DMat3::from_cols(*column * column.x, *column * column.y, *column * column.z);
    }
    let inverse = square.inverse();
    let pulls: ArrayVec<f64, MAX_IK_VARIABLES> = controls
        .iter()
        .zip(values)
        .map(|(control, value)| REST_PULL * (control.rest - value) * control.scale())
        .collect();
    let pulled: DVec3 = columns
        .iter()
        .zip(&pulls)
        .map(|(column, pull)| *column * *pull)
        .sum();
    let weights = inverse * (missing - pulled);
    columns
        .iter()
        .zip(&pulls)
        .zip(controls)
        .map(|((column, pull), control)| (column.dot(weights) + pull) / control.scale())
        .collect()
}

/// The links between the shoulder and one fingertip.
struct Chain {
    links: ArrayVec<usize, MAX_LINKS>,
}

impl Chain {
    fn to(model: &ArmModel, finger: Finger) -> Self {
        let last = model
            .links()
            .iter()
            .position(|link| link.fingertip == Some(finger));
        let mut links = ArrayVec::new();
        let mut next = Some(last.expect("the model has the finger"));
        while let Some(place) = next {
            links.push(place);
            next = model.links()[place].parent;
        }
        Self { links }
    }

    fn tip(&self, model: &ArmModel, poses: &[Pose]) -> Vec3 {
        let last = self.links[0];
        far_end(&model.links()[last], &poses[last]).translation
    }

    /// How far the fingertip goes for each radian of each control's fastest angle.
    fn columns(
        &self,
        model: &ArmModel,
        poses: &[Pose],
        controls: &[IkVariable],
    ) -> ArrayVec<DVec3, MAX_IK_VARIABLES> {
        let tip = self.tip(model, poses);
        controls
            .iter()
            .map(|control| {
                let moved = self.links.iter().map(|&place| {
                    let link = &model.links()[place];
                    let Some((_, line)) = control
                        .mappings
                        .iter()
                        .find(|(dof, _)| link.dof == Some(*dof))
                    else {
                        return DVec3::ZERO;
                    };
                    let axis = poses[place].rotation * link.axis;
                    let arm = tip - poses[place].translation;
                    axis.cross(arm).as_dvec3() * line.gain
                });
                moved.sum::<DVec3>() / control.scale()
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::JointLimits;
    use crate::hand::Side;
    use crate::kinematics::BoneLengths;
    use crate::time::Timestamp;

    fn arm() -> (ArmModel, Vec<IkVariable>) {
        let bones = BoneLengths::from_hand_and_forearm(0.190, 0.255).unwrap();
        let limits = JointLimits::human();
        let moved = [
            (Dof::ElbowFlexion, 0.6),
            (Dof::WristFlexion, 0.0),
            (Dof::WristDeviation, 0.0),
            (Dof::IndexMcpFlexion, 0.5),
            (Dof::IndexPipFlexion, 0.5),
        ];
        let controls = moved.map(|(dof, rest)| IkVariable::from_dof(dof, limits.range(dof), rest));
        let model = ArmModel::anthropometric(Side::Right, &bones).unwrap();
        (model, controls.to_vec())
    }

    #[test]
    fn every_place_away_from_the_ends_of_the_joints_is_reached() {
        let (model, controls) = arm();
        let fixed = JointAngles::new(Timestamp(0));
        let rest: Vec<f64> = controls.iter().map(|control| control.rest).collect();
        for number in 0..200 {
            let wanted: Vec<f64> = controls
                .iter()
                .enumerate()
                .map(|(place, control)| {
                    let share = (number as f64 * 0.618_034 * (place + 1) as f64).fract();
                    let (low, high) = control.range;
                    low + (0.05 + 0.9 * share) * (high - low)
                })
                .collect();
            let pose = model.forward(&angles_from_variables(&controls, &wanted, &fixed));
            let target = pose.fingertip(Finger::Index).unwrap();
            let found = solve_ik(&model, &controls, &fixed, &rest, Finger::Index, target);
            assert!(found.distance < 1e-3, "{number}: {}", found.distance);
            for (value, control) in found.values.iter().zip(&controls) {
                assert!((control.range.0..=control.range.1).contains(value));
            }
        }
    }

    #[test]
    fn what_is_out_of_reach_says_how_far() {
        let (model, controls) = arm();
        let fixed = JointAngles::new(Timestamp(0));
        let rest: Vec<f64> = controls.iter().map(|control| control.rest).collect();
        let far = Vec3::new(0.0, 0.0, -5.0);
        let found = solve_ik(&model, &controls, &fixed, &rest, Finger::Index, far);
        assert!(found.distance > 4.0 && found.distance.is_finite());
    }
}
