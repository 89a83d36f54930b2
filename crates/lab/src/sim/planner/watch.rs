//! Contacts of a planned hand, as the contact stage sees them.

use std::time::Duration;

use arrayvec::ArrayVec;

use super::HandState;
use crate::contact::surface::Scene;
use crate::contact::{ContactTracker, Phase, Touch, Touches};
use crate::sim::movement::ActiveMovement;
use crate::time::Timestamp;

/// Postures of a movement that are looked at.
const SAMPLES: u32 = 12;

/// Most contacts that are kept.
const MAX_CONTACTS: usize = 16;

/// The contacts of a hand since a posture.
pub(super) struct Watch {
    tracker: ContactTracker,
    /// The time of the last posture; a stroke depends on the speed of the fingertip.
    time: Timestamp,
    contacts: ArrayVec<Touch, MAX_CONTACTS>,
}

impl Watch {
    /// Starts in the posture of `state`.
    pub(super) fn start(state: &HandState, scene: &Scene) -> Self {
        let mut watch = Self {
            tracker: ContactTracker::new(scene),
            time: Timestamp::default(),
            contacts: ArrayVec::new(),
        };
        watch.look(state, &state.values, scene);
        watch
    }

    /// Follows a movement that began in the posture `values` and takes `duration`.
    pub(super) fn follow(
        &mut self,
        (active, duration): (&ActiveMovement, Duration),
        mut values: Vec<f64>,
        state: &HandState,
        scene: &Scene,
    ) {
        let start = self.time;
        for sample in 1..=SAMPLES {
            active.step(sample as f32 / SAMPLES as f32, &state.hand, &mut values);
            self.time = start + duration * sample / SAMPLES;
            self.look(state, &values, scene);
        }
    }

    fn look(&mut self, state: &HandState, values: &[f64], scene: &Scene) {
        let mut pose = state.hand.pose(values);
        pose.time = self.time;
        let mut touches = Touches::new();
        self.tracker.update(scene, &pose, &mut touches);
        for touch in touches {
            // Further contacts do not make the way any better.
            let _ = self.contacts.try_push(touch);
        }
    }

    /// Returns the first contact with a front.
    pub(super) fn first_touch(&self) -> Option<Touch> {
        let mut contacts = self.contacts.iter();
        contacts
            .find(|touch| touch.phase == Phase::Touched)
            .copied()
    }

    /// Iterates over the presses.
    pub(super) fn presses(&self) -> impl Iterator<Item = &Touch> {
        let contacts = self.contacts.iter();
        contacts.filter(|touch| touch.phase == Phase::Pressed)
    }
}
