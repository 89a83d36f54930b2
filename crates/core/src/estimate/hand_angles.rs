//! Joint angles from the positions of joints.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::DVec3;

use crate::hand::{Dof, Finger, Joint, JointAngles, JointPositions, Side};

/// Smallest sine of an angle between two directions that determine a plane.
const MIN_SINE: f64 = 0.05;

/// Weight of a bend across the palm in the direction in which a thumb flexes; a bend towards the palm has weight 1.
const THUMB_ACROSS: f64 = 2.0;

/// Smallest cosine of the angle between the axis of a bend and the flexion axis at which all of the bend is flexion. Below it the
/// bone goes sideways, and flexion and extension pass into each other.
const MIN_COSINE: f64 = 0.2;

/// Returns the angles between the bones whose joints are known, in radians.
///
/// Directions of the palm: along it from the wrist to the knuckle of the middle finger, across it from the knuckle of the
/// little finger to the knuckle of the index finger. Supination is 0 if the palm faces away from the direction in which the
/// elbow bends, as on a table, and unknown while the arm is straight. If the two sides of the wrist are known, they are used instead
/// of the palm. Shoulder angles describe the upper arm in the world, 0 if it points straight forward. The angle of a hinge joint (any
/// joint beyond the knuckle of a finger or the base of the thumb) is the angle between its two bones, for any direction of its axis;
/// the palm decides only the sign of flexion.
pub fn hand_angles(positions: &JointPositions, side: Side) -> JointAngles {
    let sign = sign(side);
    let mut angles = JointAngles::default();
    let bones = Bones { positions };
    let upper_arm = bones.direction(Joint::Shoulder, Joint::Elbow);
    let forearm = bones.direction(Joint::Elbow, Joint::Wrist);
    if let Some(direction) = upper_arm {
        let [x, y, z] = [-direction.z, -direction.y, -direction.x];
        angles.set(Dof::ShoulderZ, y.atan2(x));
        angles.set(Dof::ShoulderY, sign * (-z).clamp(-1.0, 1.0).asin());
    }
    if let (Some(upper_arm), Some(forearm)) = (upper_arm, forearm) {
        let bend = upper_arm.cross(forearm).length();
        angles.set(Dof::ElbowFlexion, bend.atan2(upper_arm.dot(forearm)));
    }
    let roll = forearm.and_then(|forearm| wrist_side(positions, forearm, sign));
    if let (Some(forearm), Some(upper_arm), Some(palm_side)) = (forearm, upper_arm, roll) {
        set_supination(&mut angles, palm_side, forearm, upper_arm, sign);
    }
    let Some(palm) = Palm::new(&bones, side) else {
        return angles;
    };
    if let Some(forearm) = forearm {
        let flexion = set_wrist(&mut angles, &palm, forearm);
        if let (None, Some(upper_arm)) = (roll, upper_arm) {
            let palm_side = palm.side_of_forearm(flexion);
            set_supination(&mut angles, palm_side, forearm, upper_arm, palm.sign);
        }
    }
    for &finger in Finger::ALL {
        set_finger(&mut angles, &palm, &bones, finger);
    }
    angles
}

/// Returns the direction from the elbow to the wrist and the side of the forearm to which the palm faces, both of length 1, if
/// forearm and palm are known.
pub fn forearm_sides(positions: &JointPositions, side: Side) -> Option<[DVec3; 2]> {
    let bones = Bones { positions };
    let forearm = bones.direction(Joint::Elbow, Joint::Wrist)?;
    let palm_side = match wrist_side(positions, forearm, sign(side)) {
        Some(palm_side) => palm_side,
        None => {
            let palm = Palm::new(&bones, side)?;
            palm.side_of_forearm(palm.wrist_flexion(forearm))
        }
    };
    let palm_side = palm_side.reject_from_normalized(forearm).try_normalize()?;
    Some([forearm, palm_side])
}

/// The directions between joints.
struct Bones<'a> {
    positions: &'a JointPositions,
}

impl Bones<'_> {
    /// Returns the unit direction from one joint to another, if both are known and apart.
    fn direction(&self, from: Joint, to: Joint) -> Option<DVec3> {
        let difference = self.positions.get(to)? - self.positions.get(from)?;
        difference.try_normalize()
    }
}

/// The frame of a palm: X along it, Y out of it towards the palm side, Z towards the thumb of a right hand and the
/// little finger of a left one.
struct Palm {
    x: DVec3,
    y: DVec3,
    z: DVec3,
    /// 1 for a right hand, −1 for a left one.
    sign: f64,
}

impl Palm {
    fn new(bones: &Bones, side: Side) -> Option<Self> {
        let sign = sign(side);
        let get = |joint| bones.positions.get(joint);
        let index = get(Joint::IndexPhalanxProximal)?;
        let little = get(Joint::LittlePhalanxProximal).or(get(Joint::RingPhalanxProximal))?;
        let middle = get(Joint::MiddlePhalanxProximal).unwrap_or((index + little) / 2.0);
        let x = (middle - get(Joint::Wrist)?).try_normalize()?;
        let across = (index - little).try_normalize()? * sign;
        let y = across.cross(x);
        let y = (y.length() >= MIN_SINE).then(|| y.normalize())?;
        Some(Self {
            x,
            y,
            z: x.cross(y),
            sign,
        })
    }

    /// Returns the flexion of the wrist against the direction of a forearm, in radians.
    fn wrist_flexion(&self, forearm: DVec3) -> f64 {
        (-forearm.dot(self.y)).atan2(forearm.dot(self.x))
    }

    /// Returns the side of the forearm to which the palm faces at a flexion of the wrist in radians.
    fn side_of_forearm(&self, wrist_flexion: f64) -> DVec3 {
        self.x * wrist_flexion.sin() + self.y * wrist_flexion.cos()
    }

    fn components(&self, direction: DVec3) -> DVec3 {
        DVec3::new(
            direction.dot(self.x),
            direction.dot(self.y),
            direction.dot(self.z),
        )
    }
}

/// Returns 1 for a right arm, −1 for a left one.
pub(super) fn sign(side: Side) -> f64 {
    match side {
        Side::Right => 1.0,
        Side::Left => -1.0,
    }
}

/// Sets the angles of the wrist and returns its flexion: the palm is turned against the forearm by the supination about X, the
/// deviation about Y, then the flexion about Z.
fn set_wrist(angles: &mut JointAngles, palm: &Palm, forearm: DVec3) -> f64 {
    let flexion = palm.wrist_flexion(forearm);
    angles.set(Dof::WristFlexion, flexion);
    let deviation = palm.sign * forearm.dot(palm.z).clamp(-1.0, 1.0).asin();
    angles.set(Dof::WristDeviation, deviation);
    flexion
}

/// Returns the side of the forearm to which the palm faces, from the two sides of the wrist.
fn wrist_side(positions: &JointPositions, forearm: DVec3, sign: f64) -> Option<DVec3> {
    let across = positions.wrist_axis()?.try_normalize()?;
    let palm_side = sign * across.cross(forearm);
    (palm_side.length() >= MIN_SINE).then(|| palm_side.normalize())
}

/// Sets the roll of the forearm, unless the arm is straight.
fn set_supination(
    angles: &mut JointAngles,
    palm_side: DVec3,
    forearm: DVec3,
    upper_arm: DVec3,
    sign: f64,
) {
    let bend = upper_arm.cross(forearm);
    if bend.length() < MIN_SINE {
        return;
    }
    // The side of the forearm to which the elbow bends.
    let bend_side = bend.normalize().cross(forearm);
    let across = bend_side.cross(forearm);
    // From facing away from the bend, over the thumb side up, to facing it.
    let away = -palm_side.dot(bend_side);
    let supination = sign * palm_side.dot(across);
    let radians = as_supination(supination.atan2(away));
    angles.set(Dof::ForearmSupination, radians);
}

/// Returns an angle of −π to π around the middle of the range of a forearm, from −π/2 to 3π/2: beyond a palm that faces up, a forearm is
/// at the upper end of its range.
pub(super) fn as_supination(radians: f64) -> f64 {
    if radians < -FRAC_PI_2 {
        radians + TAU
    } else {
        radians
    }
}

/// Sets the angles of a finger: abduction about the palm's Y and flexion of the first bone, then the flexion of the hinge joints.
fn set_finger(angles: &mut JointAngles, palm: &Palm, bones: &Bones, finger: Finger) {
    let tip = Joint::tip(finger).index();
    let joints = &Joint::ALL[tip - 3..=tip];
    let directions = [0, 1, 2].map(|bone| bones.direction(joints[bone], joints[bone + 1]));
    let dofs: [Dof; 4] = std::array::from_fn(|index| Dof::ALL[8 + 4 * finger.index() + index]);
    let Some(along) = directions[0] else {
        return;
    };
    let first = palm.components(along);
    let in_palm = first.x.hypot(first.z);
    // A finger that is bent by more than a right angle points backwards.
    let forward = 1_f64.copysign(first.x);
    let spread = if in_palm < MIN_SINE {
        0.0
    } else {
        (-first.z * forward).atan2(first.x * forward)
    };
    angles.set(dofs[0], palm.sign * spread);
    angles.set(dofs[1], first.y.atan2(in_palm * forward));
    let axis = palm.x * spread.sin() + palm.z * spread.cos();
    let flexion = match finger {
        // A thumb bends across the palm rather than towards it.
        Finger::Thumb => axis + THUMB_ACROSS * palm.sign * axis.cross(along),
        _ => axis,
    };
    for (bone, dof) in dofs[2..].iter().enumerate() {
        if let (Some(before), Some(after)) = (directions[bone], directions[bone + 1]) {
            angles.set(*dof, hinge_angle(before, after, flexion));
        }
    }
}

/// Returns the angle between two bones of length 1, positive if they turn about `flexion`, negative if against it.
fn hinge_angle(before: DVec3, after: DVec3, flexion: DVec3) -> f64 {
    let bend = before.cross(after);
    let angle = bend.length().atan2(before.dot(after));
    let cosine = bend.normalize_or_zero().dot(flexion.normalize_or_zero());
    angle * (cosine / MIN_COSINE).clamp(-1.0, 1.0)
}
