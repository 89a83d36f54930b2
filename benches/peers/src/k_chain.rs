//! Forward kinematics of the arm with the crate `k`.

use ademan::estimate::Estimate;
use ademan::hand::{Dof, Finger};
use ademan::kinematics::ArmModel;
use k::nalgebra::{Isometry3, Quaternion, Translation3, Unit, UnitQuaternion, Vector3};
use k::{Chain, JointType, Node, NodeBuilder};
use parry3d::math::Vec3;

use crate::forward_kinematics::Tips;

/// A chain with a joint for each link and a fixed one for each fingertip.
pub struct KChain {
    chain: Chain<f64>,
    /// The degrees of freedom, in the order of the chain's movable joints.
    dofs: Vec<Dof>,
    tips: Vec<Node<f64>>,
}

impl KChain {
    pub fn new(arm: &ArmModel) -> Self {
        let root = arm.world_from_root();
        let rotation = root.rotation.as_dquat();
        let rotation = Quaternion::new(rotation.w, rotation.x, rotation.y, rotation.z);
        let base = NodeBuilder::new()
            .name("base")
            .joint_type(JointType::Fixed)
            .origin(Isometry3::from_parts(
                translation(root.translation),
                UnitQuaternion::new_normalize(rotation),
            ))
            .into_node();
        let mut nodes: Vec<Node<f64>> = Vec::new();
        let mut tips = vec![None; Finger::COUNT];
        for link in arm.links() {
            let joint_type = match link.dof {
                Some(_) => JointType::Rotational {
                    axis: Unit::new_normalize(vector(link.axis)),
                },
                None => JointType::Fixed,
            };
            let node = fixed_or_turning(&link.name, joint_type, link.offset);
            node.set_parent(link.parent.map_or(&base, |parent| &nodes[parent]));
            if let Some(finger) = link.fingertip {
                let name = format!("tip of {}", link.name);
                let tip = fixed_or_turning(&name, JointType::Fixed, Vec3::X * link.length);
                tip.set_parent(&node);
                tips[finger.index()] = Some(tip);
            }
            nodes.push(node);
        }
        let chain = Chain::from_root(base);
        let dof_of = |name: &str| {
            let mut links = arm.links().iter();
            links
                .find(|link| link.name == name)
                .and_then(|link| link.dof)
        };
        let dofs = chain.iter_joints().filter(|joint| joint.is_movable());
        Self {
            dofs: dofs.filter_map(|joint| dof_of(&joint.name)).collect(),
            tips: tips.into_iter().flatten().collect(),
            chain,
        }
    }

    pub fn tips(&self, estimate: &Estimate) -> Tips {
        let angles = estimate.angles.radians();
        let mut positions = [0.0; Dof::COUNT];
        for (position, dof) in positions.iter_mut().zip(&self.dofs) {
            *position = angles[dof.index()];
        }
        self.chain
            .set_joint_positions_unchecked(&positions[..self.dofs.len()]);
        self.chain.update_transforms();
        std::array::from_fn(|finger| {
            let pose = self.tips[finger].world_transform();
            let position = pose
                .expect("the transforms are up to date")
                .translation
                .vector;
            Vec3::new(position.x as f32, position.y as f32, position.z as f32)
        })
    }
}

fn fixed_or_turning(name: &str, joint_type: JointType<f64>, offset: Vec3) -> Node<f64> {
    NodeBuilder::new()
        .name(name)
        .joint_type(joint_type)
        .translation(translation(offset))
        .into_node()
}

fn vector(vector: Vec3) -> Vector3<f64> {
    Vector3::new(vector.x.into(), vector.y.into(), vector.z.into())
}

fn translation(offset: Vec3) -> Translation3<f64> {
    vector(offset).into()
}
