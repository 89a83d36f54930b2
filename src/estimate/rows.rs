//! The rows of a channel map, made ready for every frame.

use std::time::Duration;

use super::calibration::AffineMap;
use super::channels::ChannelMap;
use super::limits::{JointLimits, JointRange};
use crate::capture::Channels;
use crate::hand::{Dof, FingerSet};
use crate::time::Timestamp;

/// One channel that tells one angle.
#[derive(Clone, Debug)]
pub(super) struct Row {
    pub(super) dof: Dof,
    pub(super) calibration: AffineMap,
    /// Where the angle has to be.
    pub(super) range: JointRange,
    /// The place of its wire.
    pub(super) health: usize,
    channel: usize,
}

impl Row {
    /// What its channel reads.
    pub(super) fn count(&self, channels: &Channels) -> f64 {
        f64::from(channels.counts[self.channel])
    }
}

/// A channel in use: whether it hangs at an end of its range, and which fingers hang with it.
#[derive(Clone, Debug)]
pub(super) struct Wire {
    channel: usize,
    pub(super) fingers: FingerSet,
    railed_since: Option<Timestamp>,
    /// Whether it has been at an end for too long to be believed.
    pub(super) is_dead: bool,
}

impl Wire {
    /// Takes note of what its channel reads; at an end for `limit` it is dead.
    pub(super) fn watch(&mut self, time: Timestamp, channels: &Channels, limit: Duration) {
        let count = channels.counts[self.channel];
        if count != 0 && count != channels.full_scale {
            self.railed_since = None;
            self.is_dead = false;
            return;
        }
        let since = *self.railed_since.get_or_insert(time);
        self.is_dead = time.since(since) >= limit;
    }
}

/// The rows of a map, in order, and the wires that they hang on.
pub(super) fn prepare(map: &ChannelMap, limits: Option<&JointLimits>) -> (Vec<Row>, Vec<Wire>) {
    let mut wires: Vec<Wire> = Vec::new();
    let mut wire_of = |channel: usize| {
        if let Some(place) = wires.iter().position(|wire| wire.channel == channel) {
            return place;
        }
        wires.push(Wire {
            channel,
            fingers: map.fingers_affected_by(channel),
            railed_since: None,
            is_dead: false,
        });
        wires.len() - 1
    };
    let rows = map.rows().iter().map(|row| Row {
        dof: row.dof,
        calibration: row.calibration,
        range: limits.map_or(JointRange::ANY, |limits| limits.joint(row.dof)),
        health: wire_of(row.channel),
        channel: row.channel,
    });
    (rows.collect(), wires)
}
