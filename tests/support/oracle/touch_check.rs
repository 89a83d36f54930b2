//! Invariant I6 of touches: after a release of everything, touches have to begin again.

use ademan::contact::{Phase, TargetId};
use ademan::hand::{Finger, Side};
use ademan::pipeline::PipelineState;

use super::{Cause, Observation, Violation};

/// The touches that have begun and not ended, by hand and finger.
#[derive(Clone, Debug, Default)]
pub(super) struct TouchCheck {
    targets: [[Option<TargetId>; Finger::COUNT]; Side::COUNT],
    /// `true` if a step of the hand followed the last release of everything.
    is_seen: [bool; Side::COUNT],
}

impl TouchCheck {
    /// Checks the touches of one call; `before` is the state before it, and whether a pause was requested.
    pub(super) fn check(
        &mut self,
        observation: &Observation,
        before: (PipelineState, bool),
    ) -> Result<(), Violation> {
        let (before, was_paused) = before;
        let is_stalled = observation.state == PipelineState::Stalled;
        // A late reading stalls the pipeline before the pipeline processes it.
        if !was_paused && before != PipelineState::Stalled && is_stalled {
            *self = Self::default();
        }
        if let Some(step) = observation.output {
            for touch in step.touches {
                let (side, finger, target) = (touch.side, touch.finger, touch.target);
                let touched = &mut self.targets[side.index()][finger.index()];
                match touch.phase {
                    Phase::Touched if !self.is_seen[side.index()] => {
                        return Err(Violation::TouchInFirstStep(finger, side, target));
                    }
                    Phase::Touched => *touched = Some(target),
                    _ if *touched != Some(target) => {
                        return Err(Violation::TouchNeverBegan(finger, side, target));
                    }
                    Phase::Left | Phase::Cancelled => *touched = None,
                    _ => {}
                }
            }
            self.is_seen[step.pose.side.index()] = true;
        }
        let pauses = before == PipelineState::Running && observation.state == PipelineState::Paused;
        // A touch that ends a pause ends with the pause.
        let ends_pause = was_paused && observation.paused_by.is_none();
        if observation.cause == Cause::ReleaseAll || pauses || ends_pause {
            *self = Self::default();
        }
        Ok(())
    }
}
