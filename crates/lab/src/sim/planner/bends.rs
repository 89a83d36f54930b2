//! Fingers that bend to press.

use std::time::Duration;

use super::{MOVE_PACKETS, PRESS_PACKETS, Planner};
use crate::contact::TargetId;
use crate::hand::Finger;
use crate::sim::action_error::ActionErrorKind;

/// Bend of a finger that presses, and of one that does not, as a fraction of its range.
const BENT: f64 = 0.85;
const STRAIGHT: f64 = 0.1;
/// Duration of a bend.
const BEND_TIME: Duration = Duration::from_millis(100);

impl Planner<'_> {
    /// Starts with straight fingers.
    pub(super) fn begin_straight(&mut self) {
        for (index, value) in self.values_at_bend(Finger::ALL, STRAIGHT) {
            self.state.values[index] = value;
        }
    }

    /// Bends the fingers of targets together and straightens them again.
    pub(super) fn play_chord(&mut self, targets: &[TargetId]) -> Result<(), ActionErrorKind> {
        self.lift();
        self.bend(targets)?;
        self.wait(self.press_time().max(PRESS_PACKETS * self.period));
        self.straighten();
        Ok(())
    }

    /// Bends the fingers of targets. They stay bent.
    pub(super) fn bend(&mut self, targets: &[TargetId]) -> Result<(), ActionErrorKind> {
        let fingers = targets.iter().map(|&target| {
            let finger = self.finger_of(target);
            finger.ok_or(ActionErrorKind::NotBent)
        });
        self.state.bent = fingers.collect::<Result<_, _>>()?;
        self.move_fingers(BENT);
        self.mark_last(true);
        Ok(())
    }

    /// Straightens the fingers that are bent to press.
    pub(super) fn straighten(&mut self) {
        if !self.state.bent.is_empty() {
            self.move_fingers(STRAIGHT);
            self.mark_last(false);
            self.state.bent.clear();
        }
    }

    /// Returns the finger that presses a target by bending.
    pub(super) fn finger_of(&self, target: TargetId) -> Option<Finger> {
        let (surface, _) = self.scene.target(target)?;
        surface.bent_by(target)
    }

    fn move_fingers(&mut self, bend: f64) {
        let channel_targets = self.values_at_bend(&self.state.bent, bend);
        let time = self.state.motor.paced(BEND_TIME);
        self.push_movement(channel_targets, None, time, MOVE_PACKETS);
    }

    fn values_at_bend(&self, fingers: &[Finger], bend: f64) -> Vec<(usize, f64)> {
        let values = fingers
            .iter()
            .map(|&finger| self.state.hand.values_at_bend(finger, bend));
        values.flatten().collect()
    }
}
