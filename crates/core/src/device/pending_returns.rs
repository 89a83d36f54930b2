//! Values that return to rest.

use super::DeviceOutput;
use super::value_output::ValueEmitter;
use crate::time::Timestamp;

/// The controls, by index, whose return to rest is not emitted yet because the event list was full.
#[derive(Clone, Debug)]
pub(super) struct PendingReturns(Vec<usize>);

impl PendingReturns {
    /// Creates an empty list with room for `count` controls, so that a step never allocates.
    pub(super) fn with_capacity(count: usize) -> Self {
        Self(Vec::with_capacity(count))
    }

    /// Returns a control to rest, in this step or in a later one.
    pub(super) fn start(
        &mut self,
        index: usize,
        emitter: &mut ValueEmitter,
        time: Timestamp,
        out: &mut DeviceOutput,
    ) {
        if !emitter.return_to_rest(time, out) && !self.0.contains(&index) {
            self.0.push(index);
        }
    }

    /// Returns all controls to rest; each is paired with its emitter.
    pub(super) fn start_all<T>(
        &mut self,
        controls: &mut [(T, ValueEmitter)],
        time: Timestamp,
        out: &mut DeviceOutput,
    ) {
        for (index, (_, emitter)) in controls.iter_mut().enumerate() {
            self.start(index, emitter, time, out);
        }
    }

    /// Cancels the return of a control that is held again.
    pub(super) fn cancel(&mut self, index: usize) {
        self.0.retain(|other| *other != index);
    }

    /// Retries the returns that did not fit; each control is paired with its emitter.
    pub(super) fn retry<T>(
        &mut self,
        controls: &mut [(T, ValueEmitter)],
        time: Timestamp,
        out: &mut DeviceOutput,
    ) {
        self.0
            .retain(|&index| !controls[index].1.return_to_rest(time, out));
    }
}
