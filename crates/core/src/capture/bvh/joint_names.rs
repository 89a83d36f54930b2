//! Names of arm and hand joints in motion capture files.
//!
//! | convention | arm | fingers |
//! |---|---|---|
//! | CMU | `LeftArm LeftForeArm LeftHand`, `lhumerus lradius lwrist` | `LeftHandIndex1 LThumb` |
//! | Mixamo | `mixamorig:LeftArm mixamorig:LeftForeArm mixamorig:LeftHand` | `mixamorig:LeftHandIndex1` … `4`, also `LeftInHandIndex` |
//! | Rokoko | `LeftArm LeftForeArm LeftHand`, `leftUpperArm leftLowerArm` | `LeftFinger2Metacarpal` … `Tip`, `leftIndexProximal` … |
//! | Xsens | `LeftShoulder LeftElbow LeftWrist`, `LeftUpperArm LeftForeArm LeftHand` | `LeftSecondMC LeftSecondPP LeftSecondMP LeftSecondDP` |
//! | Vicon | `LeftArm LeftForeArm LeftHand` | `LeftHandIndex1` … `4` below `LeftHandIndex` at the wrist |
//! | Rigify | `upper_arm.L forearm.L hand.L` | `thumb.01.L f_index.01.L` |
//! | MakeHuman | `upperarm01.L lowerarm01.L wrist.L`, `UpArm_L LoArm_L Hand_L`, `upperarm_l lowerarm_l hand_l` | `metacarpal1.L finger2-1.L`, `Index1_L`, `index_01_l`, `LeftHandFinger1` |
//!
//! Case, blanks, `_`, `-` and `.` do not matter, nor does a namespace before a colon. The side is `left` or `right` at the
//! start or end, or `l` or `r`. A name that starts with `__` is not a joint: MakeHuman adds such a node at the end of a bone if the
//! bone with the rest of the name does not start there.

use crate::hand::{Finger, Joint, Side};

/// A joint of an arm or hand that a name states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NamedJoint {
    /// The side of the body, if the name states one.
    pub side: Option<Side>,
    /// The joint.
    pub joint: Joint,
    /// `true` if another name of the skeleton can state the joint better: `LeftShoulder` is the collar bone beside a
    /// `LeftArm`, `LeftHandIndex` a place in the carpus beside a `LeftHandIndex1`, and `LeftHand` the palm beside a
    /// `LeftWrist`.
    pub is_vague: bool,
}

/// Returns the joint that a name states; `None` if it is not one of an arm or hand.
pub fn joint_of(name: &str) -> Option<NamedJoint> {
    let name = name.rsplit(':').next().unwrap_or(name);
    if name.starts_with("__") {
        return None;
    }
    let letters = name.chars().filter(|letter| letter.is_ascii_alphanumeric());
    let plain: String = letters.map(|letter| letter.to_ascii_lowercase()).collect();
    let candidates = sided(name, &plain).into_iter().flatten();
    candidates
        .map(|(side, part)| (Some(side), part))
        .chain([(None, plain.as_str())])
        .find_map(|(side, part)| {
            let (joint, is_vague) = arm_joint(part).or_else(|| finger_joint(part))?;
            Some(NamedJoint {
                side,
                joint,
                is_vague,
            })
        })
}

/// Returns the sides that a name may state, each with the plain name without it.
fn sided<'a>(name: &str, plain: &'a str) -> [Option<(Side, &'a str)>; 6] {
    let end = name.as_bytes().last_chunk::<2>();
    let has_short_end = end.is_some_and(|[before, _]| !before.is_ascii_alphanumeric());
    let short_end = |letter: char, side| {
        if has_short_end {
            plain.strip_suffix(letter).map(|rest| (side, rest))
        } else {
            None
        }
    };
    let long = |text: &str, side| {
        let rest = plain.strip_prefix(text).or(plain.strip_suffix(text));
        rest.map(|rest| (side, rest))
    };
    let short = |letter: char, side| plain.strip_prefix(letter).map(|rest| (side, rest));
    [
        long("left", Side::Left),
        long("right", Side::Right),
        short_end('l', Side::Left),
        short_end('r', Side::Right),
        short('l', Side::Left),
        short('r', Side::Right),
    ]
}

/// Returns the joint of an arm, and whether its name is vague.
fn arm_joint(part: &str) -> Option<(Joint, bool)> {
    match part {
        "arm" | "upperarm" | "upperarm01" | "uparm" | "shldr" | "humerus" => {
            Some((Joint::Shoulder, false))
        }
        "shoulder" => Some((Joint::Shoulder, true)),
        "forearm" | "lowerarm" | "lowerarm01" | "lowarm" | "loarm" | "elbow" | "radius" => {
            Some((Joint::Elbow, false))
        }
        "wrist" | "carpus" => Some((Joint::Wrist, false)),
        "hand" => Some((Joint::Wrist, true)),
        _ => None,
    }
}

/// Returns the joint of a finger, and whether its name is vague.
fn finger_joint(part: &str) -> Option<(Joint, bool)> {
    let by_palm = [
        // MakeHuman counts the metacarpals from the index finger on.
        ("metacarpal1", Joint::IndexMetacarpal),
        ("metacarpal2", Joint::MiddleMetacarpal),
        ("metacarpal3", Joint::RingMetacarpal),
        ("metacarpal4", Joint::LittleMetacarpal),
    ];
    // MakeHuman has a skeleton with one chain for all fingers beside the thumb. Elsewhere it may be a thumb itself.
    if part == "handfinger1" {
        return Some((Joint::IndexPhalanxProximal, true));
    }
    if let Some((_, joint)) = by_palm.iter().find(|(name, _)| *name == part) {
        return Some((*joint, false));
    }
    let (part, is_in_hand) = match part.strip_prefix("inhand") {
        Some(rest) => (rest, true),
        None => (part.strip_prefix("hand").unwrap_or(part), false),
    };
    // Rigify begins the names of all fingers but the thumb with an F.
    let of_rigify = || finger_of(part.strip_prefix('f')?);
    let (finger, segment, style) = finger_of(part).or_else(of_rigify)?;
    let segment = match (is_in_hand, segment) {
        (true, "") => "metacarpal",
        (true, _) => return None,
        (false, segment) => segment.strip_prefix('0').unwrap_or(segment),
    };
    let index = segment_index(finger, segment, style)?;
    Some((*finger.joints().get(index)?, segment.is_empty()))
}

/// The names that a convention gives the segments of the thumb.
#[derive(Clone, Copy, PartialEq)]
enum ThumbStyle {
    /// Proximal, medial and distal: the first is the metacarpal.
    FromProximal,
    /// Metacarpal, proximal and distal.
    FromMetacarpal,
}

/// Returns the finger at the start of a name, and the rest of the name.
fn finger_of(part: &str) -> Option<(Finger, &str, ThumbStyle)> {
    let by_name = [
        ("thumb", Finger::Thumb),
        ("index", Finger::Index),
        ("middle", Finger::Middle),
        ("ring", Finger::Ring),
        ("pinky", Finger::Little),
        ("little", Finger::Little),
    ];
    for (name, finger) in by_name {
        let Some(rest) = part.strip_prefix(name) else {
            continue;
        };
        let rest = rest.strip_prefix("finger").unwrap_or(rest);
        return Some(match rest.strip_prefix("phalanx") {
            Some(rest) => (finger, rest, ThumbStyle::FromMetacarpal),
            None => (finger, rest, ThumbStyle::FromProximal),
        });
    }
    let by_number = [
        ("finger1", "first"),
        ("finger2", "second"),
        ("finger3", "third"),
        ("finger4", "fourth"),
        ("finger5", "fifth"),
    ];
    Finger::ALL
        .iter()
        .zip(by_number)
        .find_map(|(&finger, (number, ordinal))| {
            let rest = part.strip_prefix(number).or(part.strip_prefix(ordinal))?;
            Some((finger, rest, ThumbStyle::FromMetacarpal))
        })
}

/// Returns the index in [`Finger::joints`] of the joint at the near end of a segment.
fn segment_index(finger: Finger, segment: &str, style: ThumbStyle) -> Option<usize> {
    let is_thumb = finger == Finger::Thumb;
    let first = if is_thumb { 0 } else { 1 };
    match segment {
        "metacarpal" | "mc" => Some(0),
        "" | "1" => Some(first),
        "2" => Some(first + 1),
        "3" => Some(first + 2),
        "4" | "tip" => Some(first + 3),
        "proximal" | "pp" if is_thumb && style == ThumbStyle::FromProximal => Some(0),
        "proximal" | "pp" => Some(1),
        "medial" | "middle" | "intermediate" | "mp" => Some(first + 1),
        "distal" | "dp" => Some(first + 2),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the side and the joint of a name, as text.
    fn read(name: &str) -> String {
        let Some(named) = joint_of(name) else {
            return "none".to_owned();
        };
        let side = named.side.map_or("any", Side::name);
        format!("{side} {}", named.joint)
    }

    #[test]
    fn names_of_all_conventions_are_read() {
        for (name, joint) in [
            // CMU
            ("LeftArm", "left shoulder"),
            ("LeftForeArm", "left elbow"),
            ("LeftHand", "left wrist"),
            ("LeftHandIndex1", "left index-finger-phalanx-proximal"),
            ("LThumb", "left thumb-metacarpal"),
            ("lhumerus", "left shoulder"),
            ("rradius", "right elbow"),
            ("rwrist", "right wrist"),
            ("LeftFingerBase", "none"),
            // Mixamo
            ("mixamorig:RightForeArm", "right elbow"),
            ("mixamorig:RightHandThumb1", "right thumb-metacarpal"),
            ("mixamorig:RightHandThumb4", "right thumb-tip"),
            (
                "mixamorig:RightHandPinky2",
                "right pinky-finger-phalanx-intermediate",
            ),
            ("mixamorig:RightHandPinky4", "right pinky-finger-tip"),
            ("RightInHandRing", "right ring-finger-metacarpal"),
            // Rokoko
            ("LeftFinger1Metacarpal", "left thumb-metacarpal"),
            ("LeftFinger1Proximal", "left thumb-phalanx-proximal"),
            (
                "LeftFinger2Medial",
                "left index-finger-phalanx-intermediate",
            ),
            ("LeftFinger5Tip", "left pinky-finger-tip"),
            ("leftLowerArm", "left elbow"),
            ("leftThumbProximal", "left thumb-metacarpal"),
            ("leftThumbMedial", "left thumb-phalanx-proximal"),
            ("leftLittleDistal", "left pinky-finger-phalanx-distal"),
            // Xsens
            ("RightElbow", "right elbow"),
            ("RightWrist", "right wrist"),
            ("RightUpperArm", "right shoulder"),
            ("RightFirstPP", "right thumb-phalanx-proximal"),
            ("RightSecondMC", "right index-finger-metacarpal"),
            ("RightFourthMP", "right ring-finger-phalanx-intermediate"),
            // Rigify
            ("upper_arm.L", "left shoulder"),
            ("thumb.01.R", "right thumb-metacarpal"),
            ("f_index.01.L", "left index-finger-phalanx-proximal"),
            ("f_middle.03.R", "right middle-finger-phalanx-distal"),
            ("f_pinky.02.L", "left pinky-finger-phalanx-intermediate"),
            ("f_index.01_master.L", "none"),
            // Others
            ("lowerarm01.R", "right elbow"),
            ("finger2-1.L", "left index-finger-phalanx-proximal"),
            ("hand_l", "left wrist"),
            ("UpArm_R", "right shoulder"),
            ("LoArm_R", "right elbow"),
            ("metacarpal1.R", "right index-finger-metacarpal"),
            ("metacarpal4.L", "left pinky-finger-metacarpal"),
            ("Index1_R", "right index-finger-phalanx-proximal"),
            ("__Index1_R", "none"),
            ("index_01_l", "left index-finger-phalanx-proximal"),
            ("thumb_03_r", "right thumb-phalanx-distal"),
            ("RightHandFinger1", "right index-finger-phalanx-proximal"),
            ("metatarsal1.R", "none"),
            ("metacarpal5.R", "none"),
            ("thumb-phalanx-proximal", "any thumb-phalanx-proximal"),
            ("pinky-finger-tip", "any pinky-finger-tip"),
            ("wrist", "any wrist"),
            ("ring1", "any ring-finger-phalanx-proximal"),
            ("Hips", "none"),
            ("LeftUpLeg", "none"),
            ("RightToeBase", "none"),
            ("Spine", "none"),
            ("l", "none"),
            ("", "none"),
        ] {
            assert_eq!(read(name), joint, "{name}");
        }
        for (vague, better) in [
            ("RightShoulder", "RightArm"),
            ("RightHand", "RightWrist"),
            ("RightHandIndex", "RightHandIndex1"),
            ("RThumb", "RThumb1"),
        ] {
            let [vague, better] = [vague, better].map(|name| joint_of(name).unwrap());
            assert_eq!(vague.joint, better.joint);
            assert!(vague.is_vague && !better.is_vague, "{}", better.joint);
        }
    }
}
