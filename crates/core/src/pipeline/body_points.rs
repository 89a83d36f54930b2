//! Points of the body, from which boards and pointers with the anchors `shoulder`, `head` and `hip` are measured.

use super::hand_pipeline::HandPipeline;
use crate::hand::{BodyPoint, FingerSet};

impl HandPipeline {
    /// Sets the points of the body in the pose of the hand. A point that is not seen has no position; if the hand is lost, no point
    /// has one.
    pub(super) fn update_body_points(&mut self) {
        let estimate = &self.output.estimate;
        let is_lost = !estimate.is_placed || estimate.untrusted == FingerSet::ALL;
        for &point in BodyPoint::ALL {
            let position = self.estimator.body_point(point);
            let known = position.filter(|at| !is_lost && at.is_finite());
            self.output.pose.body.set(point, known);
        }
    }
}
