//! Bone lengths from two measures of a person, and the arm model that they make.

use parry3d::math::Vec3;

use super::arm_model::{ArmModel, ArmModelError, Link};
use crate::hand::{Dof, Finger, Joint, Side};

/// Hand breadth as a share of hand length: 84/183 mm and 75/166 mm (Buryanov & Kotiuk 2010).
const BREADTH: f64 = 0.456;
/// Upper arm as a share of the forearm: 0.186 and 0.146 of the stature (Drillis & Contini 1966).
const UPPER_ARM: f64 = 0.186 / 0.146;
/// Distance of the finger CMC joints from the wrist as a share of hand length (Buchholz 1992).
const CARPUS: f64 = 0.073;
/// The pad of a fingertip, in metres: the poke radius that the field uses.
const TIP_RADIUS: f32 = 0.005;

/// The lengths of an arm's and a hand's bones, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoneLengths {
    /// Wrist crease to the end of the middle finger.
    pub hand: f64,
    /// Elbow to wrist.
    pub forearm: f64,
    /// Shoulder to elbow.
    pub upper_arm: f64,
    /// Across the knuckles.
    pub breadth: f64,
    /// Proximal, middle and distal phalanx of index, middle, ring and little finger.
    pub phalanges: [[f64; 3]; 4],
    /// Metacarpal, proximal and distal phalanx of the thumb.
    pub thumb: [f64; 3],
}

impl BoneLengths {
    /// The bones of a person whose hand and forearm are this long, in metres.
    ///
    /// Ratios to hand length of Buchholz et al. 1992, proximal phalanges after An 1979.
    ///
    /// # Errors
    /// A text, when a length is not that of a person: hand 0.1..=0.3 m, forearm 0.1..=0.5 m.
    pub fn from_hand_and_forearm(hand: f64, forearm: f64) -> Result<Self, String> {
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
        let scaled = |shares: [f64; 3]| shares.map(|share| share * hand);
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

    /// CMC and MCP joint of a finger: along the hand and towards the thumb side, in metres.
    fn knuckle(&self, finger: Finger) -> ([f64; 2], [f64; 2]) {
        let place = |along: f64, across: f64| [along * self.hand, across * self.breadth];
        match finger {
            Finger::Thumb => (place(CARPUS, 0.196), place(CARPUS, 0.196)),
            Finger::Index => (place(CARPUS, 0.126), place(0.447, 0.252)),
            Finger::Middle => (place(CARPUS, 0.0), place(0.446, 0.0)),
            Finger::Ring => (place(CARPUS, -0.129), place(0.409, -0.206)),
            Finger::Little => (place(CARPUS, -0.223), place(0.368, -0.402)),
        }
    }
}

impl ArmModel {
    /// An arm with these bones, its joints named after WebXR, its shoulder at the world's origin,
    /// mounted [palm down](Self::palm_down).
    ///
    /// The axes are those of the hierarchical arm: fingers along +X, palm side +Y, flexion about
    /// +Z. On a left arm everything sideways is mirrored.
    pub fn anthropometric(side: Side, bones: &BoneLengths) -> Result<Self, ArmModelError> {
        let mut tree = Tree {
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

struct Tree {
    thumb_side: f32,
    links: Vec<Link>,
}

impl Tree {
    /// Adds a link at (along, across) of its parent and returns its place.
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
        let (cmc, mcp) = bones.knuckle(finger);
        let bend = |name: &str| -> Dof {
            let full = format!("{finger}-{name}");
            full.parse().expect("every finger has these angles")
        };
        let joints = joints_of(finger);
        let (root, lengths, names) = if finger == Finger::Thumb {
            let root = self.add(
                Some(palm),
                cmc,
                Vec3::Y * self.thumb_side,
                Some(bend("cmc-abduction")),
            );
            let names = ["cmc-flexion", "mcp-flexion", "ip-flexion"];
            (root, bones.thumb, names)
        } else {
            let metacarpal = self.add(Some(palm), cmc, Vec3::Z, None);
            self.links[metacarpal].joint = Some(joints[0]);
            let along = [mcp[0] - cmc[0], mcp[1] - cmc[1]];
            let axis = Vec3::Y * self.thumb_side;
            let root = self.add(Some(metacarpal), along, axis, Some(bend("mcp-abduction")));
            let names = ["mcp-flexion", "pip-flexion", "dip-flexion"];
            (root, bones.phalanges[finger.index() - 1], names)
        };
        let moving = &joints[joints.len() - 3..];
        let (mut parent, mut at) = (root, 0.0);
        for ((name, length), joint) in names.iter().zip(lengths).zip(moving) {
            parent = self.add(Some(parent), [at, 0.0], Vec3::Z, Some(bend(name)));
            self.links[parent].length = length as f32;
            self.links[parent].joint = Some(*joint);
            at = length;
        }
        self.links[parent].fingertip = Some(finger);
    }
}

/// The joints of a finger from the wrist outwards, without its tip.
fn joints_of(finger: Finger) -> &'static [Joint] {
    let tip = Joint::tip(finger).index();
    let count = if finger == Finger::Thumb { 3 } else { 4 };
    &Joint::ALL[tip - count..tip]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::JointAngles;
    use crate::time::Timestamp;

    fn flat(side: Side) -> crate::kinematics::HandPose {
        let bones = BoneLengths::from_hand_and_forearm(0.190, 0.255).unwrap();
        let model = ArmModel::anthropometric(side, &bones).unwrap();
        model.forward(&JointAngles::new(Timestamp(0)))
    }

    #[test]
    fn all_25_hand_joints_are_there_and_the_middle_finger_ends_the_hand() {
        let pose = flat(Side::Right);
        let of_hand = pose
            .known()
            .filter(|(joint, _)| joint.index() >= Joint::Wrist.index());
        assert_eq!(of_hand.count(), 25);
        let wrist = pose.position(Joint::Wrist).unwrap();
        let tip = pose.fingertip(Finger::Middle).unwrap();
        let reach = wrist.distance(tip);
        assert!((reach - 0.190).abs() < 0.003, "{reach}");
    }

    #[test]
    fn phalanges_agree_with_the_radiographic_means_to_3_mm() {
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
        let (left, right) = (flat(Side::Left), flat(Side::Right));
        for (joint, pose) in right.known() {
            let other = left.position(joint).unwrap();
            let mirrored = Vec3::new(-pose.translation.x, pose.translation.y, pose.translation.z);
            assert!(other.distance(mirrored) < 1e-6, "{joint}");
        }
        assert!(right.fingertip(Finger::Thumb).unwrap().x < 0.0);
    }

    #[test]
    fn lengths_that_no_person_has_are_refused() {
        assert!(BoneLengths::from_hand_and_forearm(1.9, 0.255).is_err());
        assert!(BoneLengths::from_hand_and_forearm(f64::NAN, 0.255).is_err());
        assert!(
            BoneLengths::from_hand_and_forearm(0.19, 2.55)
                .unwrap_err()
                .contains("2550 mm")
        );
    }
}
