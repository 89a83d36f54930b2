//! The names of joints and fingers in plain words.

use super::texts::text;
use ademan_core::hand::{Dof, Finger, Side};

/// Returns the name of a joint for a person, such as `Index, middle joint`.
pub fn joint_name(dof: Dof) -> String {
    let part = text(part(dof));
    match dof.finger() {
        Some(finger) => format!("{}, {part}", finger_name(finger)),
        None => part.to_owned(),
    }
}

/// Returns the name of a finger for a person, such as `Index`.
pub fn finger_name(finger: Finger) -> &'static str {
    text(match finger {
        Finger::Thumb => "finger-thumb",
        Finger::Index => "finger-index",
        Finger::Middle => "finger-middle",
        Finger::Ring => "finger-ring",
        Finger::Little => "finger-little",
    })
}

/// Returns the name of a finger for a person who sees both hands, such as `Index, left`.
pub fn finger_of_side(side: Side, finger: Finger) -> String {
    let side = text(match side {
        Side::Left => "finger-of-left",
        Side::Right => "finger-of-right",
    });
    format!("{}, {side}", finger_name(finger))
}

/// Returns the key of the part of the arm, or of the joint of the finger.
fn part(dof: Dof) -> &'static str {
    match dof {
        Dof::ShoulderZ => "joint-shoulder-z",
        Dof::ShoulderY => "joint-shoulder-y",
        Dof::ShoulderX => "joint-shoulder-x",
        Dof::ElbowFlexion => "joint-elbow",
        Dof::ForearmSupination => "joint-forearm",
        Dof::ForearmSecondBone => "joint-second-bone",
        Dof::WristDeviation => "joint-wrist-sideways",
        Dof::WristFlexion => "joint-wrist-bend",
        Dof::ThumbCmcAbduction => "joint-base-sideways",
        Dof::ThumbCmcFlexion => "joint-base",
        Dof::ThumbMcpFlexion
        | Dof::IndexMcpFlexion
        | Dof::MiddleMcpFlexion
        | Dof::RingMcpFlexion
        | Dof::LittleMcpFlexion => "joint-knuckle",
        Dof::IndexMcpAbduction
        | Dof::MiddleMcpAbduction
        | Dof::RingMcpAbduction
        | Dof::LittleMcpAbduction => "joint-sideways",
        Dof::IndexPipFlexion
        | Dof::MiddlePipFlexion
        | Dof::RingPipFlexion
        | Dof::LittlePipFlexion => "joint-middle",
        Dof::ThumbIpFlexion
        | Dof::IndexDipFlexion
        | Dof::MiddleDipFlexion
        | Dof::RingDipFlexion
        | Dof::LittleDipFlexion => "joint-end",
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn every_joint_has_a_name_of_its_own() {
        let names: BTreeSet<String> = Dof::ALL.iter().map(|&dof| joint_name(dof)).collect();
        assert_eq!(names.len(), Dof::COUNT);
        assert_eq!(joint_name(Dof::IndexPipFlexion), "Index, middle joint");
    }
}
