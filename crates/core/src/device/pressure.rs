//! Pressure: the depth of a press on a key as a value, such as the position of a gas pedal.

use super::target_index::TargetIndex;
use super::value_output::{ValueEmitter, ValueOutput};
use super::{Capabilities, DeviceInput, DeviceOutput, VirtualDevice};
use crate::contact::{Phase, TargetId};
use crate::hand::{FINGERS_OF_BOTH_HANDS, Finger};
use crate::time::Timestamp;

/// The keys whose depth has an output.
///
/// The value of a key is the depth of the deepest finger on it, as a fraction of the travel, and 0 while no finger touches it. It
/// follows the finger at any depth, whether or not the key counts as pressed.
#[derive(Clone, Debug)]
pub struct Pressures {
    index: TargetIndex,
    keys: Vec<(ValueOutput, ValueEmitter)>,
    /// The index of the key under each finger, and the depth.
    fingers: [Option<(usize, f32)>; FINGERS_OF_BOTH_HANDS],
}

impl Pressures {
    /// Creates the keys with their targets, none touched.
    pub fn new(keys: impl IntoIterator<Item = (TargetId, ValueOutput)>) -> Self {
        let keys: Vec<_> = keys.into_iter().collect();
        let emitter = |&(target, output): &(TargetId, ValueOutput)| {
            let emitter = ValueEmitter::new(target, output, 0.0);
            (
                output,
                emitter.with_rest(Some(0.0)).with_axis_at_rest_for_zero(),
            )
        };
        Self {
            index: TargetIndex::new(keys.iter().map(|(target, _)| *target)),
            keys: keys.iter().map(emitter).collect(),
            fingers: [None; FINGERS_OF_BOTH_HANDS],
        }
    }

    /// Sets each value to the depth of its deepest finger. A value that does not fit into the event list is emitted by the next call.
    fn emit(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        for (index, (_, emitter)) in self.keys.iter_mut().enumerate() {
            let fingers = self.fingers.iter().flatten();
            let mut depths = fingers.filter(|(key, _)| *key == index);
            match depths.next() {
                Some(&(_, first)) => {
                    let depth = depths.fold(first, |deepest, (_, depth)| deepest.max(*depth));
                    emitter.set(depth, time, out);
                }
                None => _ = emitter.return_to_rest(time, out),
            }
        }
    }
}

impl VirtualDevice for Pressures {
    fn add_capabilities(&self, required: &mut Capabilities) {
        for (output, _) in &self.keys {
            output.add_capabilities(required);
        }
    }

    fn update(&mut self, input: &DeviceInput, out: &mut DeviceOutput) {
        for touch in input.touches {
            let finger =
                &mut self.fingers[touch.side.index() * Finger::COUNT + touch.finger.index()];
            let index = self.index.get(touch.target);
            match (touch.phase, index) {
                (Phase::Touched | Phase::Pressed, _) => {
                    *finger = index.map(|index| (index, touch.depth));
                }
                (Phase::Left | Phase::Cancelled, Some(index)) => {
                    *finger = finger.filter(|(key, _)| *key != index);
                }
                // A touch that began before the last release of everything does not count.
                (Phase::Moved | Phase::Released, Some(index)) if finger.is_some() => {
                    *finger = Some((index, touch.depth));
                }
                _ => {}
            }
        }
        self.emit(input.pose.time, out);
    }

    fn release_all(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        self.fingers = [None; FINGERS_OF_BOTH_HANDS];
        self.emit(time, out);
    }
}
