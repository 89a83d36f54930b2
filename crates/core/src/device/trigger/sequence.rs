//! Triggers in an order, as one trigger.

use std::time::Duration;

use arrayvec::ArrayVec;

use super::{HandTrigger, Measure, Trigger};
use crate::contact::TargetId;
use crate::hand::Side;
use crate::time::Timestamp;

/// The maximum number of steps of a sequence.
pub const MAX_STEPS: usize = 4;

/// The steps of a sequence of triggers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steps {
    /// The targets of the triggers, in their order, before the first `None`.
    pub targets: [Option<TargetId>; MAX_STEPS],
    /// The longest time from the end of a step to the beginning of the next.
    pub within: Duration,
}

/// A sequence of one hand. It is on while its last step is.
#[derive(Clone, Debug)]
pub(super) struct HandSequence {
    pub(super) trigger: HandTrigger,
    /// The indices of the steps among the triggers that are not sequences; empty if one is missing.
    steps: ArrayVec<usize, MAX_STEPS>,
    within: Duration,
    /// The number of steps that were done in their order.
    done: usize,
    /// The time at which the last step that was done was on last.
    last: Timestamp,
    /// The steps that were on, as bits.
    were_on: u8,
}

impl HandSequence {
    /// Creates the sequence of a trigger; `None` if it is none, or if it is the sequence of the other hand, too.
    pub(super) fn new(trigger: &HandTrigger, triggers: &[HandTrigger]) -> Option<Self> {
        let Measure::Sequence(steps) = trigger.trigger.measure else {
            return None;
        };
        let targets = steps.targets.iter().map_while(|target| *target);
        let index_of = |target: TargetId| {
            triggers.iter().position(|it| {
                it.trigger.target == target && (it.side == trigger.side || it.is_shared)
            })
        };
        let indices: Option<ArrayVec<usize, MAX_STEPS>> = targets.map(index_of).collect();
        let indices = indices.unwrap_or_default();
        let Trigger { side, held, .. } = trigger.trigger;
        // Both hands would do the steps of the body at once, and act twice. Each hand holds buttons of its own.
        let is_shared = side.is_none()
            && held.is_none()
            && indices.iter().all(|&index| triggers[index].is_shared);
        if is_shared && trigger.side != Side::ALL[0] {
            return None;
        }
        Some(Self {
            trigger: HandTrigger {
                is_shared,
                ..trigger.clone()
            },
            steps: indices,
            within: steps.within,
            done: 0,
            last: Timestamp(0),
            were_on: 0,
        })
    }

    /// Gives a sequence of the body to the hand that shows its first step.
    pub(super) fn update_side(&mut self, triggers: &[HandTrigger]) {
        let trigger = &mut self.trigger;
        if let Some(&first) = self.steps.first()
            && trigger.is_shared
            && trigger.switch.is_unknown()
        {
            trigger.side = triggers[first].side;
        }
    }

    /// Returns the fraction of steps that were done, or `None` if a step is not known: then it begins again.
    pub(super) fn measurement(&mut self, triggers: &[HandTrigger], time: Timestamp) -> Option<f32> {
        let mut are_on = 0_u8;
        let mut is_known = !self.steps.is_empty();
        for (bit, &index) in self.steps.iter().enumerate() {
            let switch = &triggers[index].switch;
            are_on |= u8::from(switch.is_on()) << bit;
            is_known &= !switch.is_unknown();
        }
        let begin = are_on & !self.were_on;
        self.were_on = are_on;
        if !is_known {
            self.reset();
            return None;
        }
        let is_set = |bits: u8, step: usize| bits & (1 << step) != 0;
        if self.done > 0 {
            let is_complete = self.done == self.steps.len();
            if is_set(are_on, self.done - 1) {
                self.last = time;
            } else if is_complete || time.since(self.last) > self.within {
                self.done = 0;
            }
        }
        if self.done < self.steps.len() && is_set(begin, self.done) {
            self.done += 1;
            self.last = time;
        } else if begin != 0 {
            // Another step than the next one.
            self.done = usize::from(is_set(begin, 0));
            self.last = time;
        }
        Some(self.done as f32 / self.steps.len() as f32)
    }

    /// Forgets the steps that were done.
    pub(super) fn reset(&mut self) {
        self.done = 0;
    }
}
