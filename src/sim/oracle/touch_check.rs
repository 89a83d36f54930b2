//! What fingertips touch, since everything was let go of last.

use super::{Cause, Observation, Violation};
use crate::contact::{Phase, TargetId};
use crate::hand::{Finger, Side};
use crate::snapshot::PipelineState;

/// The touches that have begun and not ended, by hand and finger.
#[derive(Clone, Debug, Default)]
pub(super) struct TouchCheck {
    latched: [[Option<TargetId>; Finger::COUNT]; Side::COUNT],
    /// Whether a frame of the hand was seen since.
    is_seen: [bool; Side::COUNT],
}

impl TouchCheck {
    /// Takes the next step; `before` is the state before it, and whether somebody had asked for a pause.
    pub(super) fn check(
        &mut self,
        step: &Observation,
        before: (PipelineState, bool),
    ) -> Result<(), Violation> {
        let (before, was_paused) = before;
        let stalled =
            !was_paused && before != PipelineState::Stalled && step.state == PipelineState::Stalled;
        // A reading that comes too late is seen after everything was let go of.
        if stalled {
            *self = Self::default();
        }
        if let Some(frame) = step.output {
            for touch in frame.touches {
                let (side, finger, target) = (touch.side, touch.finger, touch.target);
                let latched = &mut self.latched[side.index()][finger.index()];
                match touch.phase {
                    Phase::Touched if !self.is_seen[side.index()] => {
                        return Err(Violation::TouchInFirstStep(finger, side, target));
                    }
                    Phase::Touched => *latched = Some(target),
                    _ if *latched != Some(target) => {
                        return Err(Violation::TouchNeverBegan(finger, side, target));
                    }
                    Phase::Left | Phase::Cancelled => *latched = None,
                    _ => {}
                }
            }
            self.is_seen[frame.pose.side.index()] = true;
        }
        let paused = before == PipelineState::Running && step.state == PipelineState::Paused;
        // A touch that ends a pause ends with it.
        let ended_pause = was_paused && !step.is_paused;
        if step.cause == Cause::ReleaseAll || paused || ended_pause {
            *self = Self::default();
        }
        Ok(())
    }
}
