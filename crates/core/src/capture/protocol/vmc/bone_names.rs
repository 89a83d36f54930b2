//! The names of bones in VMC: the names of Unity's humanoid, and the spellings of VRM.

use crate::hand::{ArmBone, Finger, Side};

/// A bone by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NamedBone {
    /// A bone of an arm.
    Arm(Side, ArmBone),
    /// The metacarpal of a thumb, as VRM 1.0 names it: its `ThumbProximal` is then the second bone.
    ThumbMetacarpal(Side),
    /// A bone of the trunk, by its index in [`TRUNK`].
    Trunk(usize),
    /// A shoulder.
    Shoulder(Side),
    /// A bone of the rest of the body.
    Body,
}

/// Bones from the root to the shoulders. A parent precedes its child.
pub(super) const TRUNK: [&str; 4] = ["Hips", "Spine", "Chest", "UpperChest"];

/// Bones that carry no arm, without their sides.
const BODY: [&str; 12] = [
    "Neck", "Head", "Jaw", "Eye", "UpperLeg", "LowerLeg", "Foot", "Toes", "ToeBase", "LastBone",
    "Root", "Origin",
];

/// The bones of an arm except the fingers, without their sides.
const ARM: [(&str, ArmBone); 3] = [
    ("UpperArm", ArmBone::UpperArm),
    ("LowerArm", ArmBone::LowerArm),
    ("Hand", ArmBone::Hand),
];

/// Returns the bone of a name; case does not matter. `None` if there is no such bone.
pub(super) fn bone_of(name: &[u8]) -> Option<NamedBone> {
    let (side, part) = match (strip(name, "Left"), strip(name, "Right")) {
        (Some(part), _) => (Some(Side::Left), part),
        (_, Some(part)) => (Some(Side::Right), part),
        _ => (None, name),
    };
    let is_part = |bone: &str| part.eq_ignore_ascii_case(bone.as_bytes());
    if BODY.iter().any(|bone| is_part(bone)) {
        return Some(NamedBone::Body);
    }
    if let Some(index) = TRUNK.iter().position(|bone| is_part(bone)) {
        return Some(NamedBone::Trunk(index));
    }
    let side = side?;
    if is_part("Shoulder") {
        return Some(NamedBone::Shoulder(side));
    }
    if let Some((_, bone)) = ARM.iter().find(|(spelling, _)| is_part(spelling)) {
        return Some(NamedBone::Arm(side, *bone));
    }
    let (finger, segment) = finger_of(part)?;
    if finger == Finger::Thumb && segment.eq_ignore_ascii_case(b"Metacarpal") {
        return Some(NamedBone::ThumbMetacarpal(side));
    }
    let segments = ["Proximal", "Intermediate", "Distal"];
    let index = segments
        .iter()
        .position(|spelling| segment.eq_ignore_ascii_case(spelling.as_bytes()))?;
    Some(NamedBone::Arm(side, ArmBone::of_finger(finger, index)?))
}

fn finger_of(part: &[u8]) -> Option<(Finger, &[u8])> {
    [
        ("Thumb", Finger::Thumb),
        ("Index", Finger::Index),
        ("Middle", Finger::Middle),
        ("Ring", Finger::Ring),
        ("Little", Finger::Little),
        ("Pinky", Finger::Little),
    ]
    .into_iter()
    .find_map(|(name, finger)| Some((finger, strip(part, name)?)))
}

/// Returns a name without its start, if it has that start.
fn strip<'a>(name: &'a [u8], start: &str) -> Option<&'a [u8]> {
    let (first, rest) = name.split_at_checked(start.len())?;
    first.eq_ignore_ascii_case(start.as_bytes()).then_some(rest)
}

/// Returns the name of a bone without its side.
pub(super) fn name_of(bone: ArmBone) -> String {
    let finger = match bone.finger() {
        Some(Finger::Thumb) => "Thumb",
        Some(Finger::Index) => "Index",
        Some(Finger::Middle) => "Middle",
        Some(Finger::Ring) => "Ring",
        Some(Finger::Little) => "Little",
        None => {
            let names = ARM.iter().find(|(_, arm_bone)| *arm_bone == bone);
            return names.map_or("", |(name, _)| name).to_owned();
        }
    };
    let index = (bone.index() - ArmBone::ThumbFirst.index()) % ArmBone::PER_FINGER;
    format!("{finger}{}", ["Proximal", "Intermediate", "Distal"][index])
}
