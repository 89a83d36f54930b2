//! The feedback of one hand, derived from the steps of a session.

use super::thread::FeedbackState;
use crate::capture::feedback::{FeedbackFormat, Pulse};
use crate::capture::{Haptics, Reading};
use ademan_core::contact::{Phase, Touch};
use ademan_core::hand::{Finger, Side};
use ademan_core::pipeline::PipelineState;
use ademan_core::snapshot::StepView;

/// Curl beyond the curl of the press at which a finger is held: a servo that holds it at once could pull it off its key, and
/// it would press again and again.
const CURL_MARGIN: f32 = 0.05;

/// The feedback of one hand.
pub(super) struct HandFeedback {
    side: Side,
    haptics: Haptics,
    format: &'static FeedbackFormat,
    state: FeedbackState,
    /// The profile whose targets are touched.
    profile: usize,
}

impl HandFeedback {
    /// Creates the feedback of a hand that touches nothing.
    pub fn new(side: Side, haptics: Haptics, format: &'static FeedbackFormat) -> Self {
        Self {
            side,
            haptics,
            format,
            state: FeedbackState::default(),
            profile: 0,
        }
    }

    /// Returns the present feedback.
    pub fn state(&self) -> FeedbackState {
        self.state
    }

    /// Updates the feedback. Returns `true` if it has changed.
    pub fn update(&mut self, step: &StepView) -> bool {
        let before = self.state;
        let is_new_profile = std::mem::replace(&mut self.profile, step.profile) != step.profile;
        // Only an accepted reading of a running session shows that a key is still pressed: a pause, a stall, a loss, a new
        // layout and the end have no pose.
        let is_tracked = step.state == PipelineState::Running
            && step.pose.is_some()
            && !step.lost_hands[self.side.index()];
        if !is_tracked || is_new_profile {
            self.state.release();
        }
        if is_tracked && let Some(reading) = step.reading {
            for touch in step.touches {
                self.apply(touch, reading);
            }
        }
        self.state != before
    }

    fn apply(&mut self, touch: &Touch, reading: &Reading) {
        if touch.side != self.side {
            return;
        }
        match touch.phase {
            Phase::Touched => self.start_pulse(Pulse::Touch),
            Phase::Pressed => {
                self.start_pulse(Pulse::Press);
                self.state.forces[touch.finger.index()] = self.force(touch.finger, reading);
            }
            Phase::Moved => {}
            Phase::Released | Phase::Left | Phase::Cancelled => {
                self.state.release_finger(touch.finger);
            }
        }
    }

    fn start_pulse(&mut self, pulse: Pulse) {
        if self.haptics.has_pulses() {
            self.state.start_pulse(pulse);
        }
    }

    /// Returns the force that holds a finger where it is now; 0 if its curl is not measured.
    fn force(&self, finger: Finger, reading: &Reading) -> f32 {
        let curl = if self.haptics.has_force() {
            (self.format.curl)(&reading.sample, finger)
        } else {
            None
        };
        curl.map_or(0.0, |curl| (1.0 - curl - CURL_MARGIN).max(0.0))
    }
}
