//! Values that come to rest.

use super::DeviceOutput;
use super::value_output::Driver;
use crate::time::Timestamp;

/// Those that have not come to rest yet, because there was no room to tell of it: places in a list.
#[derive(Clone, Debug)]
pub(super) struct Resting(Vec<usize>);

impl Resting {
    /// None of `count`.
    pub(super) fn of(count: usize) -> Self {
        // Room for all, so that a frame never allocates.
        Self(Vec::with_capacity(count))
    }

    /// Lets one of the drivers come to rest, in this frame or a later one.
    pub(super) fn begin(
        &mut self,
        place: usize,
        driver: &mut Driver,
        time: Timestamp,
        out: &mut DeviceOutput,
    ) {
        if !driver.rest(time, out) && !self.0.contains(&place) {
            self.0.push(place);
        }
    }

    /// Somebody holds it again.
    pub(super) fn end(&mut self, place: usize) {
        self.0.retain(|other| *other != place);
    }

    /// Goes on with those that had no room; each control of the list has its driver beside it.
    pub(super) fn go_on<T>(
        &mut self,
        list: &mut [(T, Driver)],
        time: Timestamp,
        out: &mut DeviceOutput,
    ) {
        self.0.retain(|&place| !list[place].1.rest(time, out));
    }
}
