//! The shape of a forearm with its palm, and of fingers, from the joints of a hand.

use parry3d::math::Vec3;

use super::skin::Section;
use ademan_core::hand::{Finger, Joint};
use ademan_core::kinematics::HandPose;

/// Half breadth of a palm at the knuckles beyond the joints of the index and the little finger, in metres.
const KNUCKLE_FLESH: f32 = 0.011;

/// Half breadth of a palm without fingers, in metres.
const PALM_HALF_BREADTH: f32 = 0.040;

/// Sections of a forearm: position from the elbow (0) to the wrist (1), half breadth and half thickness in metres.
const FOREARM: [(f32, f32, f32); 6] = [
    (0.0, 0.038, 0.036),
    (0.15, 0.042, 0.040),
    (0.4, 0.042, 0.038),
    (0.7, 0.034, 0.029),
    (0.9, 0.029, 0.022),
    (1.0, 0.028, 0.020),
];

/// Sections of a palm: position from the wrist (0) to the knuckles (1), breadth as a fraction of that at the knuckles, and half
/// thickness in metres.
const PALM: [(f32, f32, f32); 6] = [
    (0.12, 0.74, 0.019),
    (0.3, 0.84, 0.0185),
    (0.55, 0.96, 0.0165),
    (0.8, 1.0, 0.014),
    (0.98, 0.98, 0.012),
    (1.1, 0.9, 0.008),
];

/// Sections between two given ones.
const SUBDIVISIONS: usize = 5;

/// Rounds in which each section of an arm approaches its neighbors, which rounds the wrist.
const SMOOTHING_ROUNDS: usize = 12;

/// Start of the skin of a finger, inside the palm: position between the knuckle (0) and the other end of its bone (1).
const FINGER_START: f32 = 0.4;

/// Radius at the start of a finger, as a multiple of that at its base.
const START_RADIUS: f32 = 0.9;

/// Start of the skin of a thumb, inside the palm: position between its base (0) and the wrist (1).
const THUMB_START: f32 = 0.6;

/// Sections of the round end of a finger.
const END_SECTIONS: usize = 6;

/// Radii of a finger at its joints, the base first, as multiples of the radius of its tip.
const FINGER_RADII: [f32; 4] = [1.42, 1.28, 1.14, 1.0];

/// Radii of a thumb at its joints, the base first, as multiples of the radius of its tip.
const THUMB_RADII: [f32; 4] = [1.75, 1.45, 1.22, 1.0];

/// The radius of the tip of a middle finger, in metres, where the fingertip sphere of the arm is smaller.
const TIP_RADIUS: f32 = 0.0068;

/// Returns the sections from the elbow over the wrist to the knuckles, as far as the joints are known.
pub(super) fn arm_sections(pose: &HandPose) -> Vec<Section> {
    let Some(wrist) = pose.position(Joint::Wrist) else {
        return Vec::new();
    };
    let lateral = lateral(pose);
    let mut sections = Vec::new();
    if let Some(elbow) = pose.position(Joint::Elbow) {
        for (t, breadth, thickness) in FOREARM {
            let center = elbow.lerp(wrist, t);
            sections.push(section(
                center,
                wrist - elbow,
                lateral,
                [breadth, thickness],
            ));
        }
        let start: Section = sections[0];
        let end = (elbow - wrist).normalize_or_zero() * 0.02;
        sections.insert(0, start.scaled(0.6, end));
        sections.insert(0, start.scaled(0.02, end * 1.3));
    }
    if let Some((knuckles, half_breadth)) = knuckles(pose) {
        let along = knuckles - wrist;
        for (t, breadth, thickness) in PALM {
            let sizes = [half_breadth.length() * breadth, thickness];
            let straight = section(wrist + along * t, along, lateral, sizes);
            // The row of the knuckles is oblique.
            let oblique = half_breadth.normalize_or(lateral) * sizes[0];
            sections.push(Section {
                across: straight.across.lerp(oblique, t.min(1.0)),
                ..straight
            });
        }
    }
    let mut sections = smoothed(subdivided(&sections));
    if let Some(end) = sections.last().copied() {
        sections.push(end.scaled(0.02, Vec3::ZERO));
    }
    sections
}

/// Returns the middle of the knuckles and the vector from there to the thumb side of the palm.
fn knuckles(pose: &HandPose) -> Option<(Vec3, Vec3)> {
    let knuckle = |finger: Finger| pose.position(finger.joints()[1]);
    let fingers = Finger::ALL.iter().filter(|it| **it != Finger::Thumb);
    let known: Vec<Vec3> = fingers.filter_map(|&finger| knuckle(finger)).collect();
    let (first, last) = (*known.first()?, *known.last()?);
    let half = (first - last) / 2.0;
    let lateral = lateral(pose);
    let half_breadth = match known.len() {
        4 => half + half.normalize_or(lateral) * KNUCKLE_FLESH,
        _ => lateral * PALM_HALF_BREADTH,
    };
    let middle = known.iter().sum::<Vec3>() / known.len() as f32;
    Some((middle, half_breadth))
}

/// Returns the direction to the thumb side of the hand.
fn lateral(pose: &HandPose) -> Vec3 {
    let index = pose.position(Joint::IndexPhalanxProximal);
    let little = pose.position(Finger::Little.joints()[1]);
    if let (Some(index), Some(little)) = (index, little) {
        return (index - little).normalize_or(Vec3::X);
    }
    let wrist = pose.get(Joint::Wrist);
    wrist.map_or(Vec3::X, |wrist| wrist.rotation * Vec3::X)
}

/// Returns the sections of a finger from its knuckle, or of the thumb from its base, to the end.
pub(super) fn finger_sections(pose: &HandPose, finger: Finger) -> Vec<Section> {
    let skip = usize::from(finger != Finger::Thumb);
    let joints = finger.joints()[skip..].iter();
    let points: Vec<Vec3> = joints.filter_map(|&joint| pose.position(joint)).collect();
    let [first, .., before_last, last] = points[..] else {
        return Vec::new();
    };
    let lateral = lateral(pose);
    let radii = &if finger == Finger::Thumb {
        THUMB_RADII
    } else {
        FINGER_RADII
    };
    let radii = &radii[radii.len().saturating_sub(points.len())..];
    let tip_radius = TIP_RADIUS.max(pose.tip_radius) * tip_ratio(finger);
    // It starts inside the palm, in the direction of the bone before it.
    let (joint, start) = match finger {
        Finger::Thumb => (Joint::Wrist, THUMB_START),
        _ => (finger.joints()[0], FINGER_START),
    };
    let inside = pose.position(joint).map(|inside| (inside, start));
    let mut sections = Vec::new();
    for (index, (&point, ratio)) in points.iter().zip(radii).enumerate() {
        let next = points
            .get(index + 1)
            .map(|next| (*next - point).normalize_or_zero());
        let before = match index {
            0 => inside.map(|(inside, _)| inside),
            _ => Some(points[index - 1]),
        };
        let before = before.map(|before| (point - before).normalize_or_zero());
        let along = next.unwrap_or(Vec3::ZERO) + before.unwrap_or(Vec3::ZERO);
        sections.push(section(point, along, lateral, [tip_radius * ratio; 2]));
    }
    if let Some((inside, share)) = inside {
        let along = first - inside;
        let sizes = [tip_radius * radii[0] * START_RADIUS; 2];
        let mut cap = section(first - along * share, along, lateral, sizes);
        cap.opacity = 0.0;
        sections.insert(0, cap);
    }
    let mut sections = subdivided(&sections);
    let end = *sections.last().expect("a finger has two joints");
    let along = (last - before_last).normalize_or_zero() * tip_radius;
    for step in 1..=END_SECTIONS {
        let angle = step as f32 / END_SECTIONS as f32 * std::f32::consts::FRAC_PI_2;
        sections.push(end.scaled(angle.cos().max(0.02), along * angle.sin()));
    }
    sections
}

/// Returns the radius of a fingertip as a fraction of the middle fingertip's.
fn tip_ratio(finger: Finger) -> f32 {
    match finger {
        Finger::Thumb => 1.2,
        Finger::Little => 0.86,
        Finger::Index | Finger::Ring => 0.96,
        Finger::Middle => 1.0,
    }
}

/// Returns an ellipse across a direction.
fn section(center: Vec3, along: Vec3, lateral: Vec3, [breadth, thickness]: [f32; 2]) -> Section {
    let along = along.normalize_or(Vec3::NEG_Z);
    let across = lateral - along * lateral.dot(along);
    let across = across.normalize_or(along.any_orthonormal_vector());
    Section {
        center,
        across: across * breadth,
        up: along.cross(across) * thickness,
        opacity: 1.0,
    }
}

/// Returns the sections with others between each two.
fn subdivided(sections: &[Section]) -> Vec<Section> {
    let mut all = Vec::with_capacity(sections.len() * (SUBDIVISIONS + 1));
    for pair in sections.windows(2) {
        for step in 0..=SUBDIVISIONS {
            all.push(pair[0].mix(&pair[1], step as f32 / (SUBDIVISIONS + 1) as f32));
        }
    }
    all.extend(sections.last());
    all
}

/// Returns the sections with rounded bends. The ends stay.
fn smoothed(mut sections: Vec<Section>) -> Vec<Section> {
    for _ in 0..SMOOTHING_ROUNDS {
        let old = sections.clone();
        for (index, around) in old.windows(3).enumerate() {
            sections[index + 1] = around[1].mix(&around[0].mix(&around[2], 0.5), 0.5);
        }
    }
    sections
}

#[cfg(test)]
mod tests {
    use super::*;
    use ademan_core::estimate::{Estimate, JointAngles};
    use ademan_core::hand::Side;
    use ademan_core::kinematics::{ArmModel, BoneLengths};
    use ademan_core::time::Timestamp;

    fn flat_hand() -> HandPose {
        let bones = BoneLengths::from_hand_and_forearm(0.19, 0.26).unwrap();
        let arm = ArmModel::anthropometric(Side::Right, &bones).unwrap();
        arm.forward(&Estimate::new(Timestamp(0), JointAngles::default()))
    }

    #[test]
    fn a_finger_is_thinner_at_its_end_than_at_its_base() {
        let pose = flat_hand();
        for &finger in Finger::ALL {
            let sections = finger_sections(&pose, finger);
            let radius = |index: usize| sections[index].across.length();
            let tip = sections.len() - 1 - END_SECTIONS;
            assert!(radius(0) > radius(tip), "{finger:?}");
            assert!(radius(tip) > radius(sections.len() - 1), "{finger:?}");
        }
    }

    #[test]
    fn a_palm_is_as_broad_as_its_knuckles_and_flat() {
        let pose = flat_hand();
        let sections = arm_sections(&pose);
        let broadest = sections.iter().map(|it| it.across.length());
        let broadest = broadest.fold(0.0, f32::max);
        assert!((0.030..0.055).contains(&broadest), "{broadest}");
        let knuckles = &sections[sections.len() - 6];
        assert!(knuckles.up.length() < 0.5 * knuckles.across.length());
    }

    #[test]
    fn a_finger_fades_in_over_the_palm_and_is_opaque_from_its_knuckle() {
        let pose = flat_hand();
        for &finger in Finger::ALL {
            let sections = finger_sections(&pose, finger);
            assert_eq!(sections[0].opacity, 0.0, "{finger:?}");
            let rest = &sections[SUBDIVISIONS + 1..];
            assert!(rest.iter().all(|it| it.opacity == 1.0), "{finger:?}");
        }
    }

    #[test]
    fn a_hand_without_joints_has_no_skin() {
        let pose = HandPose::new(Timestamp(0), Side::Right, 0.005);
        assert!(arm_sections(&pose).is_empty());
        assert!(finger_sections(&pose, Finger::Index).is_empty());
    }
}
