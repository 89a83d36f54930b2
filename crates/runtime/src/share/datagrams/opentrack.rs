//! Datagrams for opentrack: the movement of the first hand since its first pose.

use glam::EulerRot;

use crate::capture::protocol::opentrack::{self, PACKET_BYTES};
use ademan_core::hand::{Joint, Side};
use ademan_core::kinematics::HandPose;
use parry3d::math::Pose;

/// The encoder of the poses of one hand.
pub(super) struct OpentrackEncoder {
    side: Side,
    /// The first pose of the wrist.
    first: Option<Pose>,
}

impl OpentrackEncoder {
    /// Creates an encoder of the poses of the hand of a side.
    pub fn new(side: Side) -> Self {
        Self { side, first: None }
    }

    /// Returns the datagram of a pose; `None` for the other hand, and for an arm without a wrist.
    pub fn encode(&mut self, pose: &HandPose) -> Option<[u8; PACKET_BYTES]> {
        let wrist = pose.get(Joint::Wrist).filter(|_| pose.side == self.side)?;
        let first = self.first.get_or_insert(*wrist);
        let movement = (wrist.translation - first.translation).as_dvec3() * 100.0;
        let rotation = (wrist.rotation * first.rotation.inverse()).as_dquat();
        let (yaw, pitch, roll) = rotation.to_euler(EulerRot::YXZ);
        let [x, y, z] = movement.to_array();
        let [yaw, pitch, roll] = [yaw, pitch, roll].map(f64::to_degrees);
        Some(opentrack::encode(&[x, y, z, yaw, pitch, roll]))
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::FRAC_PI_2;

    use glam::{Quat, Vec3};

    use super::*;
    use ademan_core::time::Timestamp;

    fn numbers(datagram: &[u8; PACKET_BYTES]) -> [f64; 6] {
        let numbers = datagram.as_chunks().0;
        std::array::from_fn(|index| f64::from_le_bytes(numbers[index]).round())
    }

    #[test]
    fn the_first_hand_is_sent_as_its_movement_since_the_first_pose() {
        let mut encoder = OpentrackEncoder::new(Side::Right);
        let mut encode = |side, position: Vec3, rotation: Quat| {
            let mut pose = HandPose::new(Timestamp(0), side, 0.008);
            pose.set(Joint::Wrist, Pose::from_parts(position, rotation));
            encoder.encode(&pose).map(|datagram| numbers(&datagram))
        };
        let start = Quat::from_rotation_x(1.0);
        assert_eq!(encode(Side::Left, Vec3::ONE, start), None);
        assert_eq!(encode(Side::Right, Vec3::ONE, start), Some([0.0; 6]));
        let moved = Vec3::ONE + Vec3::new(0.1, 0.2, -0.3);
        let turned = Quat::from_rotation_y(FRAC_PI_2) * start;
        let expected = [10.0, 20.0, -30.0, 90.0, 0.0, 0.0];
        assert_eq!(encode(Side::Right, moved, turned), Some(expected));
    }
}
