//! The names of joints in plain words.

use super::texts::text;
use crate::hand::{Dof, Finger};

/// Returns the name of a joint for a person, such as `Index, middle joint`.
pub fn joint_name(dof: Dof) -> String {
    let part = text(part(dof));
    match dof.finger() {
        Some(finger) => format!("{}, {part}", text(finger_key(finger))),
        None => part.to_owned(),
    }
}

fn finger_key(finger: Finger) -> &'static str {
    match finger {
        Finger::Thumb => "finger-thumb",
        Finger::Index => "finger-index",
        Finger::Middle => "finger-middle",
        Finger::Ring => "finger-ring",
        Finger::Little => "finger-little",
    }
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
