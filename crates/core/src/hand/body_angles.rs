//! Angles of the head, the feet and the knees.

use crate::names::named_enum;

named_enum! {
    /// An angle of the body beside the arms, in radians. The angles of the head are relative to the trunk.
    pub enum BodyAngle ("angle of the body") {
        /// The turn of the head: positive to the wearer's right.
        HeadYaw = "head-yaw",
        /// The nod of the head: positive up. About 0 looking straight ahead.
        HeadPitch = "head-pitch",
        /// The tilt of the head: positive towards the right shoulder.
        HeadRoll = "head-roll",
        /// The left foot: positive with the toes towards the shin; 0 at a right angle between foot and shank.
        LeftFootPitch = "left-foot-pitch",
        /// The right foot.
        RightFootPitch = "right-foot-pitch",
        /// The left knee: 0 for a straight leg, positive bent.
        LeftKneeFlexion = "left-knee-flexion",
        /// The right knee.
        RightKneeFlexion = "right-knee-flexion",
    }
}

impl BodyAngle {
    /// Returns `true` if the angle is one of the head, which moves to both sides of 0.
    pub const fn is_of_head(self) -> bool {
        matches!(self, Self::HeadYaw | Self::HeadPitch | Self::HeadRoll)
    }
}
