//! The posture from which a hand starts: clear of all targets.

use std::time::Duration;

use super::{CLEAR_TIME, Planner};
use crate::contact::ContactTracker;
use crate::contact::surface::Surface;
use crate::sim::action::{HandAction, TargetPoint};
use crate::sim::effector::Effector;

/// Time for which the open hand is held still at the start: after output is armed, the pipeline watches it for a second.
const START_TIME: Duration = Duration::from_millis(1600);

impl Planner<'_> {
    /// Starts above the first target of the actions, so that the hand is clear of all targets.
    pub(super) fn begin(&mut self, actions: &[HandAction]) {
        if actions.is_empty() {
            self.begin_idle();
            return;
        }
        if self.scene.starts_at_hand() {
            self.begin_open();
        } else if self.scene.has_bend_targets() {
            self.begin_straight();
        } else if let Some(point) = actions.iter().find_map(HandAction::target_point) {
            self.start_at(point);
        }
        self.state.home = self.tip();
        self.wait(CLEAR_TIME);
    }

    /// Starts a hand that presses nothing at rest, or above the target that it would touch there.
    fn begin_idle(&mut self) {
        if !self.scene.has_bend_targets()
            && let Some(point) = self.point_in_the_way()
        {
            self.start_at(point);
            self.state.home = self.tip();
        }
    }

    /// Returns the center of the target nearest to the fingertip if the posture is not clear of all targets: output is armed only
    /// while a hand is clear.
    fn point_in_the_way(&self) -> Option<TargetPoint> {
        let pose = self.state.hand.pose(&self.state.values);
        if ContactTracker::new(self.scene).is_clear(self.scene, &pose) {
            return None;
        }
        let tip = self.tip();
        let targets = self.scene.surfaces().iter().flat_map(Surface::targets);
        let hovers = targets.filter_map(|(id, _)| {
            let (point, target) = (TargetPoint::center(id), self.reach_target(id).ok()?);
            let hover = target.tip_position(point, target.hover_height);
            Some((point, hover.distance(tip)))
        });
        let nearest = hovers.min_by(|one, other| one.1.total_cmp(&other.1));
        nearest.map(|(point, _)| point)
    }

    /// Starts with an open hand that is held still until the boards are placed.
    fn begin_open(&mut self) {
        self.state.values = self.state.hand.open_values();
        self.wait(START_TIME);
    }

    /// Starts above a point, or with the fingers extended if another finger than the index finger presses it.
    fn start_at(&mut self, point: TargetPoint) {
        let best = self.effectors(point.target).first().copied();
        let target = self.reach_target(point.target);
        let state = &mut self.state;
        if let (Some(effector), Ok(target)) = (best.filter(|&it| it != Effector::INDEX), &target)
            && state.changes_fingers_on_the_way(effector)
        {
            state.values = state.values_above(effector, point, target);
            state.effector = effector;
            return;
        }
        if let Some(effector) = best.filter(|&best| best != Effector::INDEX) {
            state.effector = effector;
            let posture = state
                .hand
                .pointing_posture(effector, &state.rest, &state.values);
            for (index, value) in posture {
                state.values[index] = value;
            }
            return;
        }
        // An unreachable target is reported by its own action.
        if let Ok(target) = target {
            let hover = target.tip_position(point, target.hover_height);
            self.state.hand.reach(hover, &mut self.state.values, &[]);
            self.starts_above = true;
        }
    }
}
