//! Points of the body, from which boards and pointers with the anchors `shoulder`, `head` and `hip` are measured.

use super::hand_pipeline::HandPipeline;
use crate::hand::BodyPoint;

impl HandPipeline {
    /// Sets the points of the body in the pose of the hand. A point that is not seen has no position; if the hand is lost, no point
    /// has one.
    pub(super) fn update_body_points(&mut self) {
        let is_shown = self.output.estimate.shows_hand();
        for &point in BodyPoint::ALL {
            let position = self.estimator.body_point(point);
            let known = position.filter(|at| is_shown && at.is_finite());
            self.output.pose.body.set(point, known);
        }
    }
}
