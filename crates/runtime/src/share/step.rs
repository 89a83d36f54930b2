//! One step of a session, on its way to the thread of the hub.

use std::sync::Arc;

use ademan_core::estimate::JointAngles;
use ademan_core::kinematics::HandPose;
use ademan_core::layout::Layout;
use ademan_core::objects::SceneState;
use ademan_core::snapshot::Snapshot;
use ademan_core::time::Timestamp;

/// The shared part of one step.
#[derive(Clone, Debug)]
pub(super) struct SharedStep {
    /// The results of all stages.
    pub snapshot: Snapshot,
    /// The active layout, if it is known.
    pub layout: Option<Arc<Layout>>,
    /// The rest of what a viewer draws.
    pub scene: SceneState,
    /// The time since the start of the hub. The time of the reading is not a clock if a simulated hand is late.
    pub shared_at: Timestamp,
}

impl SharedStep {
    /// Returns the angles and the pose of the hand; `None` if the step has no accepted reading.
    pub fn hand(&self) -> Option<(&JointAngles, &HandPose)> {
        Some((self.snapshot.angles.as_ref()?, self.snapshot.pose.as_ref()?))
    }
}
