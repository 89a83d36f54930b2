//! The way of a hand to a target after the boards have moved under it.

use parry3d::math::Vec3;

use super::watch::Watch;
use super::{MOVE_PACKETS, Planner};
use crate::sim::action_error::ActionErrorKind;
use crate::sim::movement::TipPath;

/// Heights of the ways that are tried, in metres above the start and above the end.
const HEIGHTS: [f32; 4] = [0.02, 0.05, 0.09, 0.14];

impl Planner<'_> {
    /// Moves the fingertip to `goal` (world, metres) along the first way on which no finger touches anything: up along `normal`,
    /// across, and down.
    pub(super) fn go_around(&mut self, goal: Vec3, normal: Vec3) -> Result<(), ActionErrorKind> {
        let (state, count) = (self.state.clone(), self.movements.len());
        let outer = self.watch.take();
        let mut found = Err(ActionErrorKind::NoWay);
        for height in HEIGHTS {
            self.watch = Some(Watch::start(&self.state, self.scene));
            self.move_over(goal, normal * height);
            let watch = self.watch.take();
            if watch.is_some_and(|watch| watch.first_touch().is_none()) {
                self.state.is_displaced = false;
                self.state.is_raised = false;
                found = Ok(());
                break;
            }
            self.state = state.clone();
            self.movements.truncate(count);
        }
        // From here on the press is watched.
        self.watch = outer.map(|_| Watch::start(&self.state, self.scene));
        found
    }

    fn move_over(&mut self, goal: Vec3, rise: Vec3) {
        for tip in [self.tip() + rise, goal + rise, goal] {
            let time = self.travel_time(tip);
            self.move_tip(TipPath::To(tip), time, MOVE_PACKETS);
        }
    }

    /// Raises the fingertip a little, if nothing is in its way.
    pub(super) fn rise(&mut self) {
        let goal = self.tip() + Vec3::Y * HEIGHTS[0];
        // A hand below a board stays there until its next target.
        let _ = self.go_around(goal, Vec3::Y);
        self.state.is_displaced = true;
        self.state.is_raised = true;
    }
}
