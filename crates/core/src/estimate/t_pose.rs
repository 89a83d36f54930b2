//! Joint rotations of a body of twelve points, measured from the T pose.
//!
//! Body axes in the T pose: X to the left of the body, Y up, Z forwards. The rotation of a joint takes the direction that its
//! bone has in the T pose onto the observed one, in the frame of its parent. One direction does not show a twist about
//! the bone, so the rotations are without twist; in the T pose all of them are 0.

use glam::{DMat3, DVec3};

use crate::capture::markers::{Bone, fit_bones};
use crate::geometry::{EulerOrder, rotation_between, unit};
use crate::names::named_enum;

named_enum! {
    /// A point of the body.
    pub enum BodyPoint ("point of the body") {
        /// The left hip.
        LeftHip = "left-hip",
        /// The right hip.
        RightHip = "right-hip",
        /// The left knee.
        LeftKnee = "left-knee",
        /// The right knee.
        RightKnee = "right-knee",
        /// The left foot.
        LeftFoot = "left-foot",
        /// The right foot.
        RightFoot = "right-foot",
        /// The left shoulder.
        LeftShoulder = "left-shoulder",
        /// The right shoulder.
        RightShoulder = "right-shoulder",
        /// The left elbow.
        LeftElbow = "left-elbow",
        /// The right elbow.
        RightElbow = "right-elbow",
        /// The left wrist.
        LeftWrist = "left-wrist",
        /// The right wrist.
        RightWrist = "right-wrist",
    }
}

named_enum! {
    /// A joint of the body. A parent precedes its children.
    pub enum BodyJoint ("joint of the body") {
        /// The root: the hips.
        Hips = "hips",
        /// The spine, from the hips to the neck.
        Spine = "spine",
        /// The neck, with the line of the shoulders.
        Neck = "neck",
        /// The left shoulder, with the upper arm.
        LeftShoulder = "left-shoulder",
        /// The left elbow, with the forearm.
        LeftElbow = "left-elbow",
        /// The right shoulder, with the upper arm.
        RightShoulder = "right-shoulder",
        /// The right elbow, with the forearm.
        RightElbow = "right-elbow",
        /// The left hip, with the thigh.
        LeftHip = "left-hip",
        /// The left knee, with the lower leg.
        LeftKnee = "left-knee",
        /// The right hip, with the thigh.
        RightHip = "right-hip",
        /// The right knee, with the lower leg.
        RightKnee = "right-knee",
    }
}

/// The positions of the points of a body, in any unit and right-handed frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyPoints {
    /// The positions, in the order of [`BodyPoint::ALL`].
    pub positions: [DVec3; BodyPoint::COUNT],
}

/// The rotations of the joints of a body from the T pose, each in the frame of its parent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyRotations {
    /// Parent from joint, in the order of [`BodyJoint::ALL`].
    local: [DMat3; BodyJoint::COUNT],
}

/// The reason why the joints of a body have no rotations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BodyError {
    /// A coordinate is NaN or infinite.
    #[error("a coordinate is not a finite number")]
    NotFinite,
    /// The hips coincide, or their line is parallel to the spine.
    #[error("hips and neck span no plane")]
    NoTrunk,
    /// The ends of the bone of a joint coincide.
    #[error("the bone of `{0}` has no length")]
    NoBone(BodyJoint),
}

/// The smallest sine of the angle between the line of the hips and the spine.
const MIN_SINE: f64 = 1e-6;

/// The smallest length, as a fraction of the size of the body, that has a direction.
const MIN_RELATIVE_LENGTH: f64 = 1e-9;

impl BodyPoints {
    /// Returns the position of a point.
    pub fn get(&self, point: BodyPoint) -> DVec3 {
        self.positions[point.index()]
    }

    /// Returns the rotations of the joints from the T pose.
    pub fn rotations(&self) -> Result<BodyRotations, BodyError> {
        if !self.positions.iter().all(|position| position.is_finite()) {
            return Err(BodyError::NotFinite);
        }
        let smallest = MIN_RELATIVE_LENGTH * self.extent();
        let root = self.root(smallest)?;
        let mut local = [DMat3::IDENTITY; BodyJoint::COUNT];
        let mut world = [DMat3::IDENTITY; BodyJoint::COUNT];
        local[0] = root;
        world[0] = root;
        for &joint in &BodyJoint::ALL[1..] {
            let world_from_parent = world[parent(joint).index()];
            let bone = self.bone(joint);
            let observed = world_from_parent.transpose() * bone;
            let rotation = rotation_between(t_pose_direction(joint), observed)
                .filter(|_| bone.length() > smallest)
                .ok_or(BodyError::NoBone(joint))?;
            local[joint.index()] = rotation;
            world[joint.index()] = world_from_parent * rotation;
        }
        Ok(BodyRotations { local })
    }

    /// Returns the middle of the hips, where the [root](BodyJoint::Hips) is.
    pub fn root_position(&self) -> DVec3 {
        self.get(BodyPoint::LeftHip)
            .midpoint(self.get(BodyPoint::RightHip))
    }

    /// Returns the lengths of the bones in the order of [`BodyJoint::ALL`]; for the root, the distance between the hips.
    pub fn lengths(&self) -> [f64; BodyJoint::COUNT] {
        let mut lengths = [0.0; BodyJoint::COUNT];
        for &joint in BodyJoint::ALL {
            lengths[joint.index()] = self.bone(joint).length();
        }
        let hips = self.get(BodyPoint::LeftHip) - self.get(BodyPoint::RightHip);
        lengths[BodyJoint::Hips.index()] = hips.length();
        lengths
    }

    /// Returns the points, moved as little as possible so that hips, shoulders and limbs have these lengths, in the order of
    /// [`BodyJoint::ALL`]. The spine, between no two points, keeps its own.
    pub fn fitted(&self, lengths: &[f64; BodyJoint::COUNT]) -> Self {
        use BodyPoint as P;
        let bone = |from: P, to: P, joint: BodyJoint| Bone {
            from: from.index(),
            to: to.index(),
            length: lengths[joint.index()],
        };
        let mut bones = vec![
            bone(P::LeftHip, P::RightHip, BodyJoint::Hips),
            bone(P::LeftShoulder, P::RightShoulder, BodyJoint::Neck),
        ];
        for (_, joints, points) in LIMBS {
            bones.push(bone(points[0], points[1], joints[0]));
            bones.push(bone(points[1], points[2], joints[1]));
        }
        let mut fitted = *self;
        fit_bones(&mut fitted.positions, &bones);
        fitted
    }

    /// Returns the rotation of the hips: X along their line, Y towards the neck.
    fn root(&self, smallest: f64) -> Result<DMat3, BodyError> {
        let across = self.get(BodyPoint::LeftHip) - self.get(BodyPoint::RightHip);
        let up = self.bone(BodyJoint::Spine);
        if across.length() <= smallest {
            return Err(BodyError::NoTrunk);
        }
        if up.length() <= smallest {
            return Err(BodyError::NoBone(BodyJoint::Spine));
        }
        let x = unit(across).ok_or(BodyError::NoTrunk)?;
        let spine = unit(up).ok_or(BodyError::NoTrunk)?;
        let upright = spine - x * spine.dot(x);
        if upright.length() < MIN_SINE {
            return Err(BodyError::NoTrunk);
        }
        let y = upright.normalize();
        Ok(DMat3::from_cols(x, y, x.cross(y)))
    }

    /// Returns the vector along the bone of a joint, away from the root.
    fn bone(&self, joint: BodyJoint) -> DVec3 {
        use BodyPoint as P;
        let along = |from: P, to: P| self.get(to) - self.get(from);
        let neck = || {
            self.get(P::LeftShoulder)
                .midpoint(self.get(P::RightShoulder))
        };
        match joint {
            BodyJoint::Hips | BodyJoint::Spine => neck() - self.root_position(),
            BodyJoint::Neck => along(P::RightShoulder, P::LeftShoulder),
            BodyJoint::LeftShoulder => along(P::LeftShoulder, P::LeftElbow),
            BodyJoint::LeftElbow => along(P::LeftElbow, P::LeftWrist),
            BodyJoint::RightShoulder => along(P::RightShoulder, P::RightElbow),
            BodyJoint::RightElbow => along(P::RightElbow, P::RightWrist),
            BodyJoint::LeftHip => along(P::LeftHip, P::LeftKnee),
            BodyJoint::LeftKnee => along(P::LeftKnee, P::LeftFoot),
            BodyJoint::RightHip => along(P::RightHip, P::RightKnee),
            BodyJoint::RightKnee => along(P::RightKnee, P::RightFoot),
        }
    }

    /// Returns the largest distance of a point from the left hip.
    fn extent(&self) -> f64 {
        let origin = self.get(BodyPoint::LeftHip);
        let positions = self.positions.iter();
        positions.fold(0.0, |extent, position| {
            extent.max(position.distance(origin))
        })
    }
}

impl BodyRotations {
    /// Creates the rotations of the joints, each in the frame of its parent, in the order of [`BodyJoint::ALL`].
    pub const fn new(local: [DMat3; BodyJoint::COUNT]) -> Self {
        Self { local }
    }

    /// Returns the positions of a body with these rotations, the [root](BodyPoints::root_position) and the
    /// [lengths](BodyPoints::lengths) of its bones: the inverse of [`BodyPoints::rotations`].
    pub fn points(&self, root: DVec3, lengths: &[f64; BodyJoint::COUNT]) -> BodyPoints {
        let mut world = self.local;
        for &joint in &BodyJoint::ALL[1..] {
            world[joint.index()] = world[parent(joint).index()] * self.local[joint.index()];
        }
        let bone = |joint: BodyJoint| {
            world[joint.index()] * t_pose_direction(joint) * lengths[joint.index()]
        };
        let mut positions = [DVec3::ZERO; BodyPoint::COUNT];
        let mut set = |point: BodyPoint, position: DVec3| positions[point.index()] = position;
        let hips = world[0] * DVec3::X * lengths[0] / 2.0;
        let shoulders = bone(BodyJoint::Neck) / 2.0;
        let neck = root + bone(BodyJoint::Spine);
        for (first, joints, points) in LIMBS {
            let is_left = points[0].name().starts_with("left");
            let (middle, half) = match first {
                BodyJoint::Hips => (root, hips),
                _ => (neck, shoulders),
            };
            let start = if is_left {
                middle + half
            } else {
                middle - half
            };
            let joint = start + bone(joints[0]);
            set(points[0], start);
            set(points[1], joint);
            set(points[2], joint + bone(joints[1]));
        }
        BodyPoints { positions }
    }

    /// Returns the rotation of a joint in the frame of its parent.
    pub fn get(&self, joint: BodyJoint) -> &DMat3 {
        &self.local[joint.index()]
    }

    /// Returns the angles of a joint in the order ZXY, in radians.
    pub fn zxy(&self, joint: BodyJoint) -> [f64; 3] {
        let rotation = &self.local[joint.index()];
        let angles = EulerOrder::Zxy.angles(rotation);
        angles.expect("rotations of finite points are finite")
    }
}

/// The limbs: the joint that they hang from, their joints, and their points from the trunk to the end.
const LIMBS: [(BodyJoint, [BodyJoint; 2], [BodyPoint; 3]); 4] = {
    use {BodyJoint as J, BodyPoint as P};
    [
        (
            J::Neck,
            [J::LeftShoulder, J::LeftElbow],
            [P::LeftShoulder, P::LeftElbow, P::LeftWrist],
        ),
        (
            J::Neck,
            [J::RightShoulder, J::RightElbow],
            [P::RightShoulder, P::RightElbow, P::RightWrist],
        ),
        (
            J::Hips,
            [J::LeftHip, J::LeftKnee],
            [P::LeftHip, P::LeftKnee, P::LeftFoot],
        ),
        (
            J::Hips,
            [J::RightHip, J::RightKnee],
            [P::RightHip, P::RightKnee, P::RightFoot],
        ),
    ]
};

const fn parent(joint: BodyJoint) -> BodyJoint {
    match joint {
        BodyJoint::Hips | BodyJoint::Spine | BodyJoint::LeftHip | BodyJoint::RightHip => {
            BodyJoint::Hips
        }
        BodyJoint::Neck => BodyJoint::Spine,
        BodyJoint::LeftShoulder | BodyJoint::RightShoulder => BodyJoint::Neck,
        BodyJoint::LeftElbow => BodyJoint::LeftShoulder,
        BodyJoint::RightElbow => BodyJoint::RightShoulder,
        BodyJoint::LeftKnee => BodyJoint::LeftHip,
        BodyJoint::RightKnee => BodyJoint::RightHip,
    }
}

/// Returns the direction of the bone of a joint in the T pose.
const fn t_pose_direction(joint: BodyJoint) -> DVec3 {
    match joint {
        BodyJoint::Hips | BodyJoint::Spine => DVec3::Y,
        BodyJoint::Neck | BodyJoint::LeftShoulder | BodyJoint::LeftElbow => DVec3::X,
        BodyJoint::RightShoulder | BodyJoint::RightElbow => DVec3::NEG_X,
        BodyJoint::LeftHip | BodyJoint::LeftKnee | BodyJoint::RightHip | BodyJoint::RightKnee => {
            DVec3::NEG_Y
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A body in the T pose.
    fn t_pose() -> BodyPoints {
        let half = |point: BodyPoint| match point {
            BodyPoint::LeftHip | BodyPoint::RightHip => DVec3::new(0.1, 1.0, 0.0),
            BodyPoint::LeftKnee | BodyPoint::RightKnee => DVec3::new(0.1, 0.55, 0.0),
            BodyPoint::LeftFoot | BodyPoint::RightFoot => DVec3::new(0.1, 0.1, 0.0),
            BodyPoint::LeftShoulder | BodyPoint::RightShoulder => DVec3::new(0.2, 1.5, 0.0),
            BodyPoint::LeftElbow | BodyPoint::RightElbow => DVec3::new(0.5, 1.5, 0.0),
            BodyPoint::LeftWrist | BodyPoint::RightWrist => DVec3::new(0.75, 1.5, 0.0),
        };
        let mut positions = [DVec3::ZERO; BodyPoint::COUNT];
        for &point in BodyPoint::ALL {
            let position = half(point);
            let is_left = point.name().starts_with("left");
            let x = if is_left { position.x } else { -position.x };
            positions[point.index()] = position.with_x(x);
        }
        BodyPoints { positions }
    }

    fn random_body(random: &mut fastrand::Rng) -> BodyPoints {
        let position = |_| DVec3::from_array(std::array::from_fn(|_| random.f64()));
        BodyPoints {
            positions: [(); BodyPoint::COUNT].map(position),
        }
    }

    #[test]
    fn all_angles_of_the_t_pose_are_zero() {
        let rotations = t_pose().rotations().expect("a body");
        for &joint in BodyJoint::ALL {
            let angles = rotations.zxy(joint);
            assert!(angles.iter().all(|angle| angle.abs() < 1e-12), "{joint}");
        }
    }

    #[test]
    fn the_rotations_give_the_directions_of_all_bones_again() {
        let mut random = fastrand::Rng::with_seed(5);
        for _ in 0..200 {
            let body = random_body(&mut random);
            let rotations = body.rotations().expect("a body");
            let mut world = [DMat3::IDENTITY; BodyJoint::COUNT];
            for &joint in BodyJoint::ALL {
                let above = match joint {
                    BodyJoint::Hips => DMat3::IDENTITY,
                    _ => world[parent(joint).index()],
                };
                world[joint.index()] = above * *rotations.get(joint);
                if joint != BodyJoint::Hips {
                    let bone = world[joint.index()] * t_pose_direction(joint);
                    let error = bone.distance(body.bone(joint).normalize());
                    assert!(error < 1e-9, "{joint}: {error:e}");
                }
            }
        }
    }

    #[test]
    fn rotations_and_lengths_give_the_positions_again() {
        let mut random = fastrand::Rng::with_seed(6);
        for _ in 0..200 {
            let body = random_body(&mut random);
            let rotations = body.rotations().expect("a body");
            let again = rotations.points(body.root_position(), &body.lengths());
            for &point in BodyPoint::ALL {
                let error = again.get(point).distance(body.get(point));
                assert!(error < 1e-9, "{point}: {error:e}");
            }
        }
    }

    #[test]
    fn a_body_without_a_direction_is_refused_by_name() {
        let with = |point: BodyPoint, position: DVec3| {
            let mut body = t_pose();
            body.positions[point.index()] = position;
            body.rotations().unwrap_err()
        };
        let at = |point| t_pose().get(point);
        let no_hips = with(BodyPoint::LeftHip, at(BodyPoint::RightHip));
        assert_eq!(no_hips, BodyError::NoTrunk);
        let no_shoulders = with(BodyPoint::LeftShoulder, at(BodyPoint::RightShoulder));
        assert_eq!(no_shoulders, BodyError::NoBone(BodyJoint::Neck));
        let no_forearm = with(BodyPoint::LeftWrist, at(BodyPoint::LeftElbow));
        assert_eq!(no_forearm, BodyError::NoBone(BodyJoint::LeftElbow));
        let nan = with(BodyPoint::RightFoot, DVec3::NAN);
        assert_eq!(nan, BodyError::NotFinite);
        let mut lying = t_pose();
        for (shoulder, x) in [
            (BodyPoint::LeftShoulder, 0.6),
            (BodyPoint::RightShoulder, 0.4),
        ] {
            lying.positions[shoulder.index()] = DVec3::new(x, 1.0, 0.0);
        }
        assert_eq!(
            lying.rotations(),
            Err(BodyError::NoTrunk),
            "hips along the spine"
        );
    }
}
