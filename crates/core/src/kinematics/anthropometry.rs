//! Anthropometry: bone lengths derived from hand and forearm length, and an arm model with these bones.

use std::ops::RangeInclusive;

use parry3d::math::Vec3;
use serde::{Deserialize, Serialize};

use super::arm_model::{ArmModel, ArmModelError};
use super::link::Link;
use crate::hand::{Dof, Finger, Joint, Side};

/// Hand breadth as a fraction of hand length: 84/183 mm and 75/166 mm (Buryanov & Kotiuk 2010).
const BREADTH: f64 = 0.456;
/// Upper arm length as a multiple of forearm length: 0.186 and 0.146 of the stature (Drillis & Contini 1966).
const UPPER_ARM: f64 = 0.186 / 0.146;
/// The ratios of forearm and hand length that are not a mistake: a third more or less than the average.
pub(crate) const FOREARM_PER_HAND: RangeInclusive<f64> = 0.9..=1.8;
/// Distance of the finger CMC joints from the wrist as a fraction of hand length (Buchholz 1992).
const CARPUS: f64 = 0.073;
/// The radius of a fingertip, in metres: the usual poke radius of XR hand interaction.
const TIP_RADIUS: f32 = 0.005;

/// The bone lengths of an arm and hand, in metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BoneLengths {
    /// Hand length: wrist crease to the end of the middle finger.
    pub hand: f64,
    /// Forearm length: elbow to wrist.
    pub forearm: f64,
    /// Upper arm length: shoulder to elbow.
    pub upper_arm: f64,
    /// Hand breadth across the knuckles.
    pub breadth: f64,
    /// Proximal, middle and distal phalanx of index, middle, ring and little finger.
    pub phalanges: [[f64; 3]; 4],
    /// Metacarpal, proximal and distal phalanx of the thumb.
    pub thumb: [f64; 3],
}

impl BoneLengths {
    /// Derives all bone lengths from hand and forearm length, in metres.
    ///
    /// Uses the ratios to hand length of Buchholz et al. 1992, with proximal phalanges after An 1979.
    ///
    /// # Errors
    /// Returns a message if a length is outside the human range, hand 0.1..=0.3 m, forearm 0.1..=0.5 m, or if no person has both, as
    /// when they are exchanged.
    pub fn from_hand_and_forearm(hand: f64, forearm: f64) -> Result<Self, String> {
        let bones = Self::in_any_proportion(hand, forearm)?;
        if FOREARM_PER_HAND.contains(&(forearm / hand)) {
            return Ok(bones);
        }
        let (low, high) = (
            FOREARM_PER_HAND.start() * hand,
            FOREARM_PER_HAND.end() * hand,
        );
        Err(format!(
            "no person has a hand of {:.0} mm and a forearm of {:.0} mm: with this hand it is {:.0} to {:.0} mm long; check that they are not exchanged",
            hand * 1e3,
            forearm * 1e3,
            low * 1e3,
            high * 1e3
        ))
    }

    /// Derives all bone lengths as [`from_hand_and_forearm`](Self::from_hand_and_forearm), without a check of their proportion.
    pub(crate) fn in_any_proportion(hand: f64, forearm: f64) -> Result<Self, String> {
        if !(0.1..=0.3).contains(&hand) {
            return Err(format!(
                "a hand is 100 to 300 mm long, not {} mm",
                hand * 1e3
            ));
        }
        if !(0.1..=0.5).contains(&forearm) {
            return Err(format!(
                "a forearm is 100 to 500 mm long, not {} mm",
                forearm * 1e3
            ));
        }
        let scaled = |ratios: [f64; 3]| ratios.map(|ratio| ratio * hand);
        Ok(Self {
            hand,
            forearm,
            upper_arm: UPPER_ARM * forearm,
            breadth: BREADTH * hand,
            phalanges: [
                scaled([0.245, 0.143, 0.097]),
                scaled([0.266, 0.170, 0.108]),
                scaled([0.244, 0.165, 0.107]),
                scaled([0.204, 0.117, 0.093]),
            ],
            thumb: scaled([0.251, 0.196, 0.158]),
        })
    }

    /// Returns the positions of the CMC and MCP joint of a finger, along the hand and towards the thumb side, in metres.
    fn cmc_and_mcp(&self, finger: Finger) -> ([f64; 2], [f64; 2]) {
        let at = |along: f64, across: f64| [along * self.hand, across * self.breadth];
        match finger {
            Finger::Thumb => (at(CARPUS, 0.196), at(CARPUS, 0.196)),
            Finger::Index => (at(CARPUS, 0.126), at(0.447, 0.252)),
            Finger::Middle => (at(CARPUS, 0.0), at(0.446, 0.0)),
            Finger::Ring => (at(CARPUS, -0.129), at(0.409, -0.206)),
            Finger::Little => (at(CARPUS, -0.223), at(0.368, -0.402)),
        }
    }
}

impl ArmModel {
    /// Creates an arm with these bones and the joints of WebXR, with the shoulder at the world's origin and
    /// the palm down (see [`palm_down_pose`](Self::palm_down_pose)).
    ///
    /// In the zero pose, the fingers point along +X and the palm faces +Y; flexion turns about +Z. A left arm is the
    /// mirror image.
    pub fn anthropometric(side: Side, bones: &BoneLengths) -> Result<Self, ArmModelError> {
        let mut tree = LinkTree {
            thumb_side: match side {
                Side::Right => 1.0,
                Side::Left => -1.0,
            },
            links: Vec::new(),
        };
        let palm = tree.arm(bones);
        for &finger in Finger::ALL {
            tree.finger(palm, finger, bones);
        }
        Self::new(side, tree.links, Self::palm_down_pose(), TIP_RADIUS)
    }
}

struct LinkTree {
    thumb_side: f32,
    links: Vec<Link>,
}

impl LinkTree {
    /// Adds a link at (along, across) in its parent's frame and returns its index.
    fn add(&mut self, parent: Option<usize>, at: [f64; 2], axis: Vec3, dof: Option<Dof>) -> usize {
        let name = dof.map_or_else(
            || format!("fixed-{}", self.links.len()),
            |dof| dof.to_string(),
        );
        self.links.push(Link {
            name,
            parent,
            offset: Vec3::new(at[0] as f32, 0.0, at[1] as f32 * self.thumb_side),
            axis,
            dof,
            length: 0.0,
            joint: None,
            fingertip: None,
        });
        self.links.len() - 1
    }

    fn arm(&mut self, bones: &BoneLengths) -> usize {
        let (x, y, z) = (
            Vec3::X * self.thumb_side,
            Vec3::Y * self.thumb_side,
            Vec3::Z,
        );
        let root = self.add(None, [0.0, 0.0], z, Some(Dof::ShoulderZ));
        self.links[root].joint = Some(Joint::Shoulder);
        let shoulder = self.add(Some(root), [0.0, 0.0], y, Some(Dof::ShoulderY));
        let upper_arm = self.add(Some(shoulder), [0.0, 0.0], x, Some(Dof::ShoulderX));
        let elbow_at = [bones.upper_arm, 0.0];
        let elbow = self.add(Some(upper_arm), elbow_at, y, Some(Dof::ElbowFlexion));
        self.links[elbow].joint = Some(Joint::Elbow);
        let forearm = self.add(Some(elbow), [0.0, 0.0], x, Some(Dof::ForearmSupination));
        let wrist_at = [bones.forearm, 0.0];
        let wrist = self.add(Some(forearm), wrist_at, y, Some(Dof::WristDeviation));
        let palm = self.add(Some(wrist), [0.0, 0.0], z, Some(Dof::WristFlexion));
        self.links[palm].joint = Some(Joint::Wrist);
        palm
    }

    fn finger(&mut self, palm: usize, finger: Finger, bones: &BoneLengths) {
        let (cmc, mcp) = bones.cmc_and_mcp(finger);
        let dof = |name: &str| -> Dof {
            let full = format!("{finger}-{name}");
            full.parse()
                .expect("every finger has these degrees of freedom")
        };
        let [joints @ .., _] = finger.joints() else {
            unreachable!("every finger has a tip");
        };
        let (root, lengths, names) = if finger == Finger::Thumb {
            let root = self.add(
                Some(palm),
                cmc,
                Vec3::Y * self.thumb_side,
                Some(dof("cmc-abduction")),
            );
            let names = ["cmc-flexion", "mcp-flexion", "ip-flexion"];
            (root, bones.thumb, names)
        } else {
            let metacarpal = self.add(Some(palm), cmc, Vec3::Z, None);
            self.links[metacarpal].joint = Some(joints[0]);
            let along = [mcp[0] - cmc[0], mcp[1] - cmc[1]];
            let axis = Vec3::Y * self.thumb_side;
            let root = self.add(Some(metacarpal), along, axis, Some(dof("mcp-abduction")));
            let names = ["mcp-flexion", "pip-flexion", "dip-flexion"];
            (root, bones.phalanges[finger.index() - 1], names)
        };
        let moving = &joints[joints.len() - 3..];
        let (mut parent, mut at) = (root, 0.0);
        for ((name, length), joint) in names.iter().zip(lengths).zip(moving) {
            parent = self.add(Some(parent), [at, 0.0], Vec3::Z, Some(dof(name)));
            self.links[parent].length = length as f32;
            self.links[parent].joint = Some(*joint);
            at = length;
        }
        self.links[parent].fingertip = Some(finger);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::{Estimate, JointAngles};
    use crate::time::Timestamp;

    fn zero_pose(side: Side) -> crate::kinematics::HandPose {
        let bones = BoneLengths::from_hand_and_forearm(0.190, 0.255).unwrap();
        let model = ArmModel::anthropometric(side, &bones).unwrap();
        model.forward(&Estimate::new(Timestamp(0), JointAngles::default()))
    }

    #[test]
    fn the_pose_has_25_hand_joints_and_the_middle_fingertip_is_one_hand_length_away() {
        let pose = zero_pose(Side::Right);
        let hand_joints = pose
            .known()
            .filter(|(joint, _)| joint.index() >= Joint::Wrist.index());
        assert_eq!(hand_joints.count(), 25);
        let wrist = pose.position(Joint::Wrist).unwrap();
        let tip = pose.fingertip(Finger::Middle).unwrap();
        let distance = wrist.distance(tip);
        assert!((distance - 0.190).abs() < 0.003, "{distance}");
    }

    #[test]
    fn phalanges_agree_with_the_radiographic_means_within_4_5_mm() {
        // Buryanov & Kotiuk 2010, means of 66 adults; their hands were about 175 mm long.
        let bones = BoneLengths::from_hand_and_forearm(0.175, 0.24).unwrap();
        let radiographic = [
            [39.8, 22.4, 15.8 + 3.8],
            [44.6, 26.3, 17.4 + 4.0],
            [41.4, 25.7, 17.3 + 4.0],
            [32.7, 18.1, 16.0 + 3.7],
        ];
        for (ours, theirs) in bones.phalanges.iter().zip(radiographic) {
            for (our, their) in ours.iter().zip(theirs) {
                assert!((our * 1e3 - their).abs() < 4.5, "{our} {their}");
            }
        }
    }

    #[test]
    fn the_left_arm_is_the_mirror_image_of_the_right() {
        let (left, right) = (zero_pose(Side::Left), zero_pose(Side::Right));
        for (joint, pose) in right.known() {
            let other = left.position(joint).unwrap();
            let mirrored = Vec3::new(-pose.translation.x, pose.translation.y, pose.translation.z);
            assert!(other.distance(mirrored) < 1e-6, "{joint}");
        }
        assert!(right.fingertip(Finger::Thumb).unwrap().x < 0.0);
    }

    #[test]
    fn lengths_outside_the_human_range_are_rejected() {
        assert!(BoneLengths::from_hand_and_forearm(1.9, 0.255).is_err());
        assert!(BoneLengths::from_hand_and_forearm(f64::NAN, 0.255).is_err());
        assert!(
            BoneLengths::from_hand_and_forearm(0.19, 2.55)
                .unwrap_err()
                .contains("2550 mm")
        );
    }

    #[test]
    fn exchanged_lengths_are_rejected() {
        let exchanged = BoneLengths::from_hand_and_forearm(0.262, 0.189).unwrap_err();
        assert!(exchanged.contains("236 to 472 mm"), "{exchanged}");
        assert!(BoneLengths::from_hand_and_forearm(0.189, 0.262).is_ok());
    }
}
