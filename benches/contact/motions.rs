//! Motions of a hand above the board.

use ademan::hand::{Finger, Joint, Side};
use ademan::kinematics::HandPose;
use ademan::time::Timestamp;
use parry3d::math::{Pose, Vec3};

use super::boards::PITCH;

/// The poses of one pass, at 120 per second.
const POSES: usize = 1_200;

const TIP_RADIUS: f32 = 0.006;

/// The kinds of motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// The fingertips stay 10 mm above the board.
    Hover,
    /// Each finger taps five times per second, at another time than the others. Of 24 poses of a tap, 5 are behind the front.
    Tap,
    /// Every finger passes through the plane of the board at every pose.
    Cross,
}

impl Motion {
    /// All motions.
    pub const ALL: [Self; 3] = [Self::Hover, Self::Tap, Self::Cross];

    /// Returns the name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hover => "hover",
            Self::Tap => "tap",
            Self::Cross => "cross",
        }
    }

    /// Returns the poses of a hand that moves to and fro along a row, and less across it.
    pub fn poses(self) -> Vec<HandPose> {
        (0..POSES).map(|number| self.pose(number)).collect()
    }

    fn pose(self, number: usize) -> HandPose {
        let time = Timestamp(number as u64 * 8_333);
        let mut pose = HandPose::new(time, Side::Right, TIP_RADIUS);
        let phase = number as f32 * 0.01;
        for (index, &finger) in Finger::ALL.iter().enumerate() {
            let x = PITCH * (index as f32 - 2.0) + 0.02 * phase.sin();
            let z = 0.003 + 0.01 * (1.7 * phase).sin();
            let center = Vec3::new(x, TIP_RADIUS + self.height(index, number), z);
            pose.set(Joint::tip(finger), Pose::from_translation(center));
        }
        pose
    }

    /// Returns the height of a pad above the board, in metres.
    fn height(self, finger: usize, pose: usize) -> f32 {
        match self {
            Self::Hover => 0.010,
            Self::Tap => {
                let phase = (pose + 5 * finger) % 24;
                let angle = phase as f32 / 24.0 * std::f32::consts::TAU;
                0.010 - 0.014 * angle.sin().max(0.0)
            }
            Self::Cross if pose.is_multiple_of(2) => 0.010,
            Self::Cross => -0.005,
        }
    }
}
