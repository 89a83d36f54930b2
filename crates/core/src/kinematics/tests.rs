//! Comparison of forward kinematics with the poses of the links computed one by one.

use parry3d::math::Vec3;

use super::link::far_end;
use super::prepared_arm::PreparedArm;
use super::{ArmModel, BoneLengths, HandPose, Link};
use crate::estimate::{Estimate, JointAngles};
use crate::hand::{Dof, Finger, Joint, Side};
use crate::time::Timestamp;

/// Returns the poses of the joints as `link_poses` gives them.
fn expected(arm: &ArmModel, angles: &JointAngles) -> HandPose {
    let mut hand = HandPose::new(Timestamp(0), arm.side(), 0.0);
    for (link, pose) in arm.links().iter().zip(arm.link_poses(angles)) {
        if let Some(joint) = link.joint {
            hand.set(joint, pose);
        }
        if let Some(finger) = link.fingertip {
            hand.set(Joint::tip(finger), far_end(link.length, &pose));
        }
    }
    hand
}

fn check(arm: &ArmModel, has_lanes: bool) {
    assert_eq!(PreparedArm::new(arm.links()).has_lanes(), has_lanes);
    let mut random = fastrand::Rng::with_seed(1);
    for round in 0..500 {
        let mut angles = JointAngles::default();
        for &dof in Dof::ALL {
            if random.u32(..8) > 0 {
                angles.set(dof, (random.f64() - 0.5) * 7.0);
            }
        }
        let hand = arm.forward(&Estimate::new(Timestamp(0), angles));
        let (found, expected) = (hand.known(), expected(arm, &angles));
        let pairs: Vec<_> = found.zip(expected.known()).collect();
        assert_eq!(pairs.len(), expected.known().count());
        for ((joint, computed), (same, pose)) in pairs {
            assert_eq!((joint, computed), (same, pose), "round {round}");
        }
    }
}

#[test]
fn poses_are_equal_to_those_of_the_links_one_by_one() {
    let bones = BoneLengths::from_hand_and_forearm(0.19, 0.255).unwrap();
    let turned = |arm: &ArmModel, edit: fn(&mut Link)| {
        let mut links = arm.links().to_vec();
        links.iter_mut().for_each(edit);
        ArmModel::new(arm.side(), links, arm.world_from_root(), 0.005).unwrap()
    };
    for &side in Side::ALL {
        let arm = ArmModel::anthropometric(side, &bones).unwrap();
        check(&arm, true);
        let tilted = turned(&arm, |link| link.offset += Vec3::new(0.01, -0.02, 0.003));
        check(&tilted, true);
        let rolled = turned(&arm, |link| {
            if link.name.ends_with("dip-flexion") {
                link.axis = Vec3::NEG_X;
            }
        });
        check(&rolled, true);
        // The fingers turn about axes of different directions.
        let oblique = turned(&arm, |link| {
            if link.dof == Some(Dof::RingPipFlexion) {
                link.axis = Vec3::new(0.6, 0.0, 0.8);
            }
        });
        check(&oblique, true);
        let other_axis = turned(&arm, |link| {
            if link.dof == Some(Dof::IndexDipFlexion) {
                link.axis = Vec3::X;
            }
        });
        check(&other_axis, true);
        let no_wrist = turned(&arm, |link| {
            link.joint = link.joint.filter(|joint| *joint != Joint::Wrist);
        });
        check(&no_wrist, false);
        let three = turned(&arm, |link| {
            link.fingertip = link.fingertip.filter(|finger| *finger != Finger::Little);
        });
        check(&three, false);
    }
}
