//! The angles of a person's joints in the calibration poses.

use crate::calibrate::CalibrationPose as Pose;
use crate::hand::{Dof, Finger, JointAngles};
use crate::sim::noise::gaussian;

/// The angles of one person in all poses, in radians.
#[derive(Clone, Debug)]
pub(super) struct Habits {
    angles: Vec<JointAngles>,
}

impl Habits {
    /// Draws a person.
    ///
    /// Means and standard deviations of wrist and forearm come from Boone & Azen 1979 (extension 75 ± 6.4°, flexion 76 ± 6.3°, radial
    /// 21 ± 4.0°, ulnar 36 ± 3.8°, pronation and supination together 158 ± 6.4°); fingers close to the means of the American
    /// Academy of Orthopaedic Surgeons with deviations of the same size. A table holds a joint to 2° to 3°.
    pub(super) fn new(random: &mut fastrand::Rng) -> Self {
        // The DIP joint follows the PIP joint by two thirds, differently in each person.
        let coupling = 0.7 + 0.05 * gaussian(random);
        let mut draw = |pose: Pose| {
            let mut angles = JointAngles::default();
            for &dof in Dof::ALL {
                let (mean, deviation) = degrees(pose, dof);
                let degrees = mean + deviation * gaussian(random);
                angles.set(dof, degrees.to_radians());
            }
            for finger in [Finger::Index, Finger::Middle, Finger::Ring, Finger::Little] {
                let of_finger = |index: usize| {
                    let dofs = Dof::ALL.iter().filter(|dof| dof.finger() == Some(finger));
                    *dofs
                        .copied()
                        .collect::<Vec<_>>()
                        .get(index)
                        .expect("four angles")
                };
                angles.set(of_finger(3), coupling * angles.get(of_finger(2)));
            }
            angles
        };
        Self {
            angles: Pose::ALL.iter().map(|&pose| draw(pose)).collect(),
        }
    }

    /// Returns the angles in a pose.
    pub(super) fn angles(&self, pose: Pose) -> JointAngles {
        self.angles[pose.index()]
    }

    /// Returns the range of a joint over the poses that move it.
    pub(super) fn range(&self, dof: Dof) -> (f64, f64) {
        let (first, second) = match dof {
            Dof::ElbowFlexion => (Pose::ElbowStraight, Pose::ElbowBent),
            Dof::ForearmSupination | Dof::ForearmSecondBone => (Pose::PalmDown, Pose::PalmUp),
            Dof::WristFlexion => (Pose::WristUp, Pose::WristDown),
            Dof::WristDeviation => (Pose::WristIn, Pose::WristOut),
            dof if is_abduction(dof) => (Pose::Flat, Pose::Spread),
            _ => (Pose::Flat, Pose::Fist),
        };
        let angle = |pose: Pose| self.angles[pose.index()].get(dof);
        (angle(first), angle(second))
    }
}

fn is_abduction(dof: Dof) -> bool {
    dof.finger().is_some() && dof.index().is_multiple_of(4)
}

/// Returns the mean and the standard deviation of an angle between people, in degrees.
fn degrees(pose: Pose, dof: Dof) -> (f64, f64) {
    match dof.finger() {
        None => arm_degrees(pose, dof),
        Some(Finger::Thumb) => thumb_degrees(pose, dof),
        Some(finger) => finger_degrees(pose, finger, dof),
    }
}

fn arm_degrees(pose: Pose, dof: Dof) -> (f64, f64) {
    match (dof, pose) {
        (Dof::ShoulderX | Dof::ShoulderY | Dof::ShoulderZ | Dof::ForearmSecondBone, _) => {
            (0.0, 0.0)
        }
        (Dof::ElbowFlexion, Pose::ElbowStraight) => (1.5, 2.5),
        (Dof::ElbowFlexion, Pose::ElbowBent) => (90.0, 4.0),
        (Dof::ElbowFlexion, _) => (60.0, 12.0),
        (Dof::ForearmSupination, Pose::PalmUp) => (158.0, 6.4),
        (Dof::ForearmSupination, Pose::Flat | Pose::Spread | Pose::PalmDown) => (0.0, 3.0),
        (Dof::ForearmSupination, _) => (6.0, 8.0),
        (Dof::WristFlexion, Pose::WristUp) => (-75.0, 6.4),
        (Dof::WristFlexion, Pose::WristDown) => (76.0, 6.3),
        (Dof::WristDeviation, Pose::WristIn) => (-21.0, 4.0),
        (Dof::WristDeviation, Pose::WristOut) => (36.0, 3.8),
        (_, Pose::Flat | Pose::Spread | Pose::PalmDown) => (0.0, 2.5),
        (Dof::WristFlexion, Pose::WristIn | Pose::WristOut) => (0.0, 2.5),
        _ => (0.0, 6.0),
    }
}

fn thumb_degrees(pose: Pose, dof: Dof) -> (f64, f64) {
    let is_bent = matches!(pose, Pose::Fist | Pose::ThumbBent);
    match (dof, pose) {
        (_, Pose::Flat) => (0.0, 3.0),
        (Dof::ThumbCmcAbduction, Pose::Spread) => (-52.0, 6.0),
        (_, Pose::Spread) => (0.0, 3.0),
        (Dof::ThumbCmcAbduction, Pose::Pinch) => (-22.0, 7.0),
        (_, Pose::Pinch) => (24.0, 7.0),
        (Dof::ThumbCmcAbduction, _) if is_bent => (0.0, 8.0),
        (Dof::ThumbCmcFlexion, _) if is_bent => (36.0, 5.0),
        (Dof::ThumbMcpFlexion, _) if is_bent => (52.0, 5.0),
        (Dof::ThumbIpFlexion, _) if is_bent => (72.0, 6.0),
        (Dof::ThumbCmcAbduction, _) => (-8.0, 6.0),
        _ => (3.0, 4.0),
    }
}

fn finger_degrees(pose: Pose, finger: Finger, dof: Dof) -> (f64, f64) {
    let is_bent = pose == Pose::Fist || pose.bent_finger() == Some(finger);
    let joint = dof.index() % 4;
    match (joint, pose) {
        (0, Pose::Spread) => match finger {
            Finger::Index => (-18.0, 4.0),
            Finger::Ring => (9.0, 3.0),
            Finger::Little => (20.0, 4.0),
            Finger::Thumb | Finger::Middle => (0.0, 2.0),
        },
        (0, Pose::Flat) => (0.0, 2.0),
        (0, _) => (0.0, 4.0),
        (1, _) if is_bent => (88.0, 5.0),
        (2, _) if is_bent => (102.0, 5.0),
        (1 | 2, Pose::Pinch) if finger == Finger::Index => (48.0, 7.0),
        (_, Pose::Flat | Pose::Spread | Pose::WristIn | Pose::WristOut | Pose::PalmDown) => {
            (0.0, 2.0)
        }
        (1 | 2, Pose::Rest) => (32.0, 8.0),
        (_, Pose::Pinch) => (8.0, 6.0),
        (_, pose) if pose.bent_finger().is_some() => (10.0, 6.0),
        _ => (5.0, 4.0),
    }
}
