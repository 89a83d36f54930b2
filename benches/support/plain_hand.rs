//! Forward kinematics of a hand as any program would write it: the reference for the times of this crate.

use ademan::hand::{Dof, Finger, JointAngles};
use ademan::kinematics::ArmModel;
use parry3d::math::{Rotation, Vec3};

/// A hand without its arm: the joints of the wrist and the fingers, each after its parent.
pub struct PlainHand {
    joints: Vec<PlainJoint>,
}

struct PlainJoint {
    parent: Option<usize>,
    offset: Vec3,
    axis: Vec3,
    dof: Dof,
    tip: Option<Vec3>,
}

impl PlainHand {
    /// Creates the hand of an arm that has its 21 joints.
    pub fn new(arm: &ArmModel) -> Self {
        let mut joints: Vec<PlainJoint> = Vec::new();
        // The link in the tree, its offset from the joint before it, and that joint.
        let mut places: Vec<(Option<usize>, Vec3)> = Vec::new();
        for link in arm.links() {
            let (parent, base) = link.parent.map_or((None, Vec3::ZERO), |at| places[at]);
            let offset = base + link.offset;
            let is_hand = |dof: &Dof| dof.finger().is_some() || *dof == Dof::WristFlexion;
            let place = match link.dof.filter(is_hand) {
                None => (parent, if parent.is_none() { Vec3::ZERO } else { offset }),
                Some(dof) => {
                    joints.push(PlainJoint {
                        parent,
                        offset,
                        axis: link.axis,
                        dof,
                        tip: link.fingertip.map(|_| Vec3::X * link.length),
                    });
                    (Some(joints.len() - 1), Vec3::ZERO)
                }
            };
            places.push(place);
        }
        assert_eq!(joints.len(), 21);
        Self { joints }
    }

    /// Returns the positions of the fingertips in the frame of the wrist, in metres.
    pub fn fingertips(&self, angles: &JointAngles) -> [Vec3; Finger::COUNT] {
        let mut poses = [(Rotation::IDENTITY, Vec3::ZERO); 21];
        let mut tips = [Vec3::ZERO; Finger::COUNT];
        let mut next_tip = 0;
        for (index, joint) in self.joints.iter().enumerate() {
            let (rotation, position) = joint.parent.map_or(poses[0], |parent| poses[parent]);
            let angle = angles.get(joint.dof) as f32;
            let position = position + rotation * joint.offset;
            let rotation = rotation * Rotation::from_axis_angle(joint.axis, angle);
            poses[index] = (rotation, position);
            if let Some(tip) = joint.tip {
                tips[next_tip] = position + rotation * tip;
                next_tip += 1;
            }
        }
        tips
    }
}
