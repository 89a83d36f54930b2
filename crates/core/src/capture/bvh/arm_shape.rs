//! The shape of an arm and hand that a capture shows: bones of constant length, at rest in the T pose.

use glam::{DMat3, DVec3};

use crate::capture::markers::{Bone, fit_bones, median};
use crate::hand::{Finger, Joint, JointPositions, Side};

/// Longest distance in metres from a fingertip to an earlier joint of its finger at which both count as one position.
const SAME_POSITION: f64 = 1e-3;

/// Smallest sine of the angle between two directions that determine a palm.
const MIN_SINE: f64 = 0.05;

/// An arm and hand whose bones do not change.
#[derive(Clone, Debug)]
pub struct ArmShape {
    side: Side,
    bones: Vec<ShapeBone>,
    /// Distance of the joint from its parent in metres, by bone.
    lengths: Vec<f64>,
}

/// A joint and its parent.
#[derive(Clone, Copy, Debug)]
struct ShapeBone {
    joint: Joint,
    parent: Option<Joint>,
    /// Position in the T pose from the first joint, in metres: X to the left of the person, Y up, Z to the front.
    rest: DVec3,
}

impl ArmShape {
    /// Measures the joints that most of the poses know, with medians. `None` if there is no such joint.
    ///
    /// Leaves out the joints between a fingertip and another joint of its finger at the same position: a source that sees only the
    /// knuckle does not know them.
    pub fn measure(poses: &[JointPositions], side: Side) -> Option<Self> {
        let mut joints = known_joints(poses);
        for &finger in Finger::ALL {
            let tip = Joint::tip(finger);
            let same = |joint: &Joint| {
                let distance = distance(poses, tip, *joint);
                *joint != tip && distance.is_some_and(|distance| distance < SAME_POSITION)
            };
            let chain = finger.joints();
            if let Some(knuckle) = chain
                .iter()
                .position(|joint| joints.contains(joint) && same(joint))
            {
                let between = &chain[knuckle + 1..chain.len() - 1];
                joints.retain(|joint| !between.contains(joint));
            }
        }
        let mut shape = Self {
            side,
            bones: Vec::new(),
            lengths: Vec::new(),
        };
        for &joint in &joints {
            let parent = parent_of(joint, &joints);
            let length = parent.and_then(|parent| distance(poses, joint, parent));
            shape.lengths.push(length.unwrap_or(0.0));
            shape.bones.push(ShapeBone {
                joint,
                parent,
                rest: DVec3::ZERO,
            });
        }
        shape.stand(poses);
        (!shape.bones.is_empty()).then_some(shape)
    }

    /// Places the bones in the T pose: the arm to its side, the palm down, the fingers straight and the thumb half-way to the
    /// front.
    fn stand(&mut self, poses: &[JointPositions]) {
        let outwards = match self.side {
            Side::Left => DVec3::X,
            Side::Right => DVec3::NEG_X,
        };
        let rest_from_palm = DMat3::from_cols(outwards, DVec3::Z, outwards.cross(DVec3::Z));
        let is_palm = |joint: Joint| joint.index() > Joint::Wrist.index();
        for index in 0..self.bones.len() {
            let ShapeBone { joint, parent, .. } = self.bones[index];
            let Some(parent) = parent else {
                continue;
            };
            let is_in_palm = is_palm(joint) && (!is_palm(parent) || is_metacarpal(parent));
            let places = poses
                .iter()
                .filter(|_| is_in_palm)
                .filter_map(|pose| in_palm(pose, parent, joint));
            let direction = match median_point(places.collect()) {
                Some(place) => rest_from_palm * place,
                None if is_thumb(joint) => outwards + DVec3::Z,
                None => outwards,
            };
            let start = self.rest(parent).unwrap_or_default();
            let bone = direction.normalize_or(outwards) * self.lengths[index];
            self.bones[index].rest = start + bone;
        }
    }

    /// Returns the side of the body.
    pub fn side(&self) -> Side {
        self.side
    }

    /// Returns the joints from the shoulder on, each after its parent.
    pub fn joints(&self) -> impl Iterator<Item = (Joint, Option<Joint>)> + '_ {
        self.bones.iter().map(|bone| (bone.joint, bone.parent))
    }

    /// Returns the length of the bone that ends at a joint, in metres.
    pub fn length(&self, joint: Joint) -> Option<f64> {
        let index = self.bones.iter().position(|bone| bone.joint == joint)?;
        self.bones[index].parent.map(|_| self.lengths[index])
    }

    /// Returns the position of a joint in the T pose from the first joint, in metres: X to the left of the person, Y up, Z to the
    /// front.
    pub fn rest(&self, joint: Joint) -> Option<DVec3> {
        let bone = self.bones.iter().find(|bone| bone.joint == joint)?;
        Some(bone.rest)
    }

    /// Returns the joints of the shape, moved as little as possible so that the bones have their lengths.
    pub fn fit(&self, pose: &JointPositions) -> JointPositions {
        let known: Vec<(Joint, DVec3)> = self
            .bones
            .iter()
            .filter_map(|bone| Some((bone.joint, pose.get(bone.joint)?)))
            .collect();
        let index = |joint: Joint| known.iter().position(|(other, _)| *other == joint);
        let bones: Vec<Bone> = self
            .bones
            .iter()
            .zip(&self.lengths)
            .filter_map(|(bone, &length)| {
                Some(Bone {
                    from: index(bone.parent?)?,
                    to: index(bone.joint)?,
                    length,
                })
            })
            .collect();
        let mut points: Vec<DVec3> = known.iter().map(|(_, point)| *point).collect();
        fit_bones(&mut points, &bones);
        let mut fitted = JointPositions::default();
        for ((joint, _), point) in known.iter().zip(points) {
            fitted.set(*joint, point);
        }
        fitted
    }
}

/// Returns the joints that at least half of the poses know, from the shoulder on.
fn known_joints(poses: &[JointPositions]) -> Vec<Joint> {
    let is_known = |joint: &&Joint| {
        let count = poses
            .iter()
            .filter(|pose| pose.get(**joint).is_some())
            .count();
        count > 0 && 2 * count >= poses.len()
    };
    Joint::ALL.iter().filter(is_known).copied().collect()
}

/// Returns the nearest known joint from a joint towards the shoulder.
pub fn parent_of(joint: Joint, known: &[Joint]) -> Option<Joint> {
    let arm = [Joint::Shoulder, Joint::Elbow, Joint::Wrist];
    let finger = Finger::ALL.iter().map(|finger| finger.joints());
    let before = finger.into_iter().find_map(|chain| {
        let index = chain.iter().position(|other| *other == joint)?;
        Some(&chain[..index])
    });
    let on_arm = match arm.iter().position(|other| *other == joint) {
        Some(index) => &arm[..index],
        None => &arm[..],
    };
    let way = on_arm.iter().chain(before.unwrap_or_default());
    way.rev().find(|other| known.contains(other)).copied()
}

/// Returns the median distance of two joints in metres, over the poses that measure both.
fn distance(poses: &[JointPositions], one: Joint, other: Joint) -> Option<f64> {
    let measured = |pose: &JointPositions, joint: Joint| {
        let position = pose.get(joint)?;
        (position.is_finite() && !pose.is_predicted(joint)).then_some(position)
    };
    let distances = poses
        .iter()
        .filter_map(|pose| Some(measured(pose, one)?.distance(measured(pose, other)?)));
    median(&mut distances.collect::<Vec<_>>())
}

fn is_thumb(joint: Joint) -> bool {
    Finger::Thumb.joints().contains(&joint)
}

/// Returns `true` if a joint is the base of a metacarpal that moves little in the palm.
fn is_metacarpal(joint: Joint) -> bool {
    let others = Finger::ALL
        .iter()
        .filter(|&&finger| finger != Finger::Thumb);
    others.into_iter().any(|finger| finger.joints()[0] == joint)
}

/// Returns the displacement between two joints in the frame of the palm: X along it, Y to the side of the thumb.
fn in_palm(pose: &JointPositions, from: Joint, to: Joint) -> Option<DVec3> {
    let index = pose.get(Joint::IndexPhalanxProximal)?;
    let little = pose
        .get(Joint::LittlePhalanxProximal)
        .or(pose.get(Joint::RingPhalanxProximal))?;
    let middle = pose
        .get(Joint::MiddlePhalanxProximal)
        .unwrap_or((index + little) / 2.0);
    let x = (middle - pose.get(Joint::Wrist)?).try_normalize()?;
    let across = (index - little).try_normalize()?;
    let y = across.reject_from_normalized(x);
    if y.length() < MIN_SINE {
        return None;
    }
    let y = y.normalize();
    let way = pose.get(to)? - pose.get(from)?;
    // The world has X to the right and Z to the back, and so is turned, not mirrored, against the file.
    Some(DVec3::new(way.dot(x), way.dot(y), way.dot(x.cross(y))))
}

fn median_point(points: Vec<DVec3>) -> Option<DVec3> {
    let median_of =
        |axis: usize| median(&mut points.iter().map(|point| point[axis]).collect::<Vec<_>>());
    Some(DVec3::new(median_of(0)?, median_of(1)?, median_of(2)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Poses of an arm whose forearm swings, with noise of a millimetre, and some poses that are far off.
    fn swinging(random: &mut fastrand::Rng) -> Vec<JointPositions> {
        let mut noise = || DVec3::from_array([0; 3].map(|_| 2e-3 * (random.f64() - 0.5)));
        let pose = |number: u32| {
            let (sine, cosine) = (0.05 * f64::from(number)).sin_cos();
            let forearm = DVec3::new(0.0, -sine, -cosine);
            let elbow = DVec3::new(0.2, -0.3, 0.0);
            let wrist = elbow + 0.26 * forearm;
            let mut pose = JointPositions::default();
            pose.set(Joint::Shoulder, DVec3::new(0.2, 0.0, 0.0) + noise());
            pose.set(Joint::Elbow, elbow + noise());
            // Every tenth pose is bad, and so is the first one.
            let error = if number.is_multiple_of(10) {
                0.2 * forearm
            } else {
                DVec3::ZERO
            };
            pose.set(Joint::Wrist, wrist - error + noise());
            pose.set(
                Joint::IndexPhalanxProximal,
                wrist + 0.09 * forearm + noise(),
            );
            pose.set(Joint::IndexPhalanxDistal, wrist + DVec3::X * 0.1);
            pose.set(
                Joint::IndexTip,
                pose.get(Joint::IndexPhalanxProximal).unwrap(),
            );
            pose
        };
        (0..300).map(pose).collect()
    }

    #[test]
    fn bones_keep_the_median_length_although_the_first_pose_is_bad() {
        let poses = swinging(&mut fastrand::Rng::with_seed(6));
        let shape = ArmShape::measure(&poses, Side::Right).unwrap();
        let forearm = shape.length(Joint::Wrist).unwrap();
        assert!((forearm - 0.26).abs() < 3e-4, "{forearm}");
        for (index, pose) in poses.iter().enumerate() {
            let fitted = shape.fit(pose);
            let get = |joint| fitted.get(joint).unwrap();
            for (joint, parent) in shape.joints() {
                let Some(parent) = parent else { continue };
                let length = get(joint).distance(get(parent));
                let expected = shape.length(joint).unwrap();
                assert!(
                    (length - expected).abs() < 1e-9,
                    "{index}: {joint} {length}"
                );
            }
            if !index.is_multiple_of(10) {
                let moved = get(Joint::Wrist).distance(pose.get(Joint::Wrist).unwrap());
                assert!(moved < 2e-3, "{index}: {moved}");
            }
        }
    }

    #[test]
    fn a_finger_of_which_only_the_knuckle_is_seen_has_no_bone_that_folds_back() {
        let poses = swinging(&mut fastrand::Rng::with_seed(6));
        let shape = ArmShape::measure(&poses, Side::Right).unwrap();
        let index: Vec<_> = shape.joints().skip(3).collect();
        let knuckle = Joint::IndexPhalanxProximal;
        assert_eq!(
            index,
            [
                (knuckle, Some(Joint::Wrist)),
                (Joint::IndexTip, Some(knuckle))
            ]
        );
        assert_eq!(shape.length(Joint::IndexTip), Some(0.0));
    }
}
