//! Steps whose time a page measures.

use ademan_core::capture::Reading;
use ademan_core::device::Events;
use ademan_core::layout::Person;
use ademan_core::pipeline::{LayoutInstance, Pipeline};
use ademan_core::time::Timestamp;
use ademan_lab::sim::HandTask;

use crate::hand::{Hand, PERIOD, SimulatedPerson};
use crate::session::{PageSession, START, new_pipeline};

/// The steps of a person who types, to measure their speed: nothing of them is shown.
pub struct Rehearsal {
    pipeline: Pipeline,
    readings: Vec<Reading>,
    time: Timestamp,
}

/// The text that the rehearsed person types: keys that every keyboard for one hand or both has.
const REHEARSED: &str = "asdf jkl";

/// Most readings of a rehearsal.
const MAX_REHEARSED: usize = 400;

impl PageSession {
    /// Prepares a rehearsal on the layout in use.
    pub fn rehearsal(&self) -> Rehearsal {
        let task = HandTask::text(REHEARSED.to_owned());
        let arms = [self.right.clone()];
        let person = SimulatedPerson::new(task, &self.layout, &arms, &Person::default());
        let mut readings = Vec::new();
        if let Ok(person) = person {
            let mut hand = Hand::Simulated(Box::new(person));
            while readings.len() < MAX_REHEARSED && !hand.advance(START, &mut readings) {}
        }
        if readings.is_empty() {
            let (side, sample) = &self.idle[0];
            readings.push(Reading::new(START, Some(*side), sample.clone()));
        }
        Rehearsal {
            pipeline: new_pipeline(
                &self.right,
                &self.left,
                LayoutInstance::from_layout(&self.layout),
            ),
            readings,
            time: START,
        }
    }
}

impl Rehearsal {
    /// Makes all steps once. Returns their number.
    pub fn run(&mut self) -> usize {
        let mut events = Events::new();
        for reading in &mut self.readings {
            self.time = self.time + PERIOD;
            reading.time = self.time;
            events.clear();
            // A reading that is rejected is a step, too.
            let _ = self.pipeline.step(reading, &mut events);
        }
        self.readings.len()
    }
}
