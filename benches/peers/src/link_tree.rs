//! Forward kinematics as one writes it with glam: quaternions and positions from parent to child, in `f32`.

use ademan::estimate::Estimate;
use ademan::hand::{Dof, Finger};
use ademan::kinematics::{ArmModel, MAX_LINKS};
use glam::{Quat, Vec3};

use crate::forward_kinematics::Tips;

/// A tree of links.
pub struct LinkTree {
    root: (Quat, Vec3),
    links: Vec<Link>,
}

struct Link {
    parent: Option<usize>,
    offset: Vec3,
    joint: Option<(Vec3, Dof)>,
    tip: Option<(usize, f32)>,
}

impl LinkTree {
    pub fn new(arm: &ArmModel) -> Self {
        let root = arm.world_from_root();
        let links = arm.links().iter().map(|link| Link {
            parent: link.parent,
            offset: link.offset,
            joint: link.dof.map(|dof| (link.axis, dof)),
            tip: link.fingertip.map(|finger| (finger.index(), link.length)),
        });
        Self {
            root: (root.rotation, root.translation),
            links: links.collect(),
        }
    }

    pub fn tips(&self, estimate: &Estimate) -> Tips {
        let angles = estimate.angles.radians();
        let mut poses = [(Quat::IDENTITY, Vec3::ZERO); MAX_LINKS];
        let mut tips = [Vec3::ZERO; Finger::COUNT];
        for (index, link) in self.links.iter().enumerate() {
            let (rotation, position) = link.parent.map_or(self.root, |parent| poses[parent]);
            let position = position + rotation * link.offset;
            let rotation = match link.joint {
                Some((axis, dof)) => {
                    rotation * Quat::from_axis_angle(axis, angles[dof.index()] as f32)
                }
                None => rotation,
            };
            poses[index] = (rotation, position);
            if let Some((finger, length)) = link.tip {
                tips[finger] = position + rotation * (Vec3::X * length);
            }
        }
        tips
    }
}
