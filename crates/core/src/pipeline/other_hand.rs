//! The wrist of the other hand, from which boards and pointers with the anchor `other` are measured.

use parry3d::math::Vec3;

use super::Pipeline;
use super::hand_pipeline::HandPipeline;
use crate::capture::Sample;
use crate::device::Events;
use crate::estimate::{Estimate, LastSeen};
use crate::hand::{Joint, JointPositions};

/// The relation of a hand to the room, in which both hands are measured.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RoomState {
    /// `true` if the source measures positions in the room. Positions of a body have their origin at the shoulder of each arm, and a glove
    /// measures none.
    is_measured: bool,
    /// The last reading that showed the wrist. The wrist stands still while it is late.
    wrist: LastSeen,
    /// The number of times the wrist was seen after a gap; wraps around.
    gaps: u32,
    /// The gaps of the other hand when its wrist was used last.
    other_gaps: u32,
    /// The number of jumps of the hand to another position; wraps around.
    jumps: u32,
    /// The jumps of the other hand when its wrist was used last.
    other_jumps: u32,
}

impl RoomState {
    /// Records the time of a reading, if it shows the wrist.
    fn see_wrist(&mut self, positions: &JointPositions, estimate: &Estimate) {
        if positions.get(Joint::Wrist).is_some() {
            let is_after_gap = estimate.is_after_gap || self.wrist.is_late(estimate.time);
            self.gaps = self.gaps.wrapping_add(is_after_gap.into());
            self.wrist.see(estimate.time);
        }
    }
}

impl HandPipeline {
    /// Updates the relation to the room with an accepted reading.
    pub(super) fn note_room(&mut self, sample: &Sample) {
        match sample {
            Sample::Joints { positions } => {
                self.room.is_measured = true;
                self.room.see_wrist(positions, &self.output.estimate);
            }
            Sample::Body(_) => self.room.is_measured = false,
            _ => {}
        }
        let has_jumped = self.output.estimate.jumped;
        self.room.jumps = self.room.jumps.wrapping_add(has_jumped.into());
    }

    /// Returns the measured wrist in the room; `None` for a hand that is lost.
    fn wrist_in_room(&self) -> Option<Vec3> {
        let estimate = &self.output.estimate;
        let is_used = self.room.is_measured && self.last_accepted.is_some() && !self.is_suspended;
        let wrist = estimate.measured.get(Joint::Wrist);
        wrist.filter(|wrist| is_used && estimate.shows_hand() && wrist.is_finite())
    }
}

impl Pipeline {
    /// Sets the wrist of the other hand in the pose of a hand, if the layout needs it. After a jump of the other hand the wrist is
    /// unknown for one step, because the movement was not seen.
    pub(super) fn update_other_wrist(&mut self, index: usize) {
        let mut others = self.hands.iter().enumerate();
        let other = others.find(|(other, _)| *other != index);
        let other = other.map(|(_, hand)| (hand.wrist_in_room(), hand.room.jumps));
        let (wrist, jumps) = other.unwrap_or_default();
        let is_followed = self.layout().follows_other_hand();
        let hand = &mut self.hands[index];
        let has_jumped = std::mem::replace(&mut hand.room.other_jumps, jumps) != jumps;
        let is_known = is_followed && hand.room.is_measured && !has_jumped;
        hand.output.pose.other_wrist = wrist.filter(|_| is_known);
    }

    /// Returns `true` if the pose of a hand has the wrist of the other hand and the movement of that wrist until this step is not known:
    /// the wrist is late, or its last reading was after a gap.
    pub(super) fn is_other_wrist_late(&mut self, index: usize) -> bool {
        let mut others = self.hands.iter().enumerate();
        let other = others.find(|(other, _)| *other != index);
        let Some(other) = other.map(|(_, hand)| hand.room) else {
            return false;
        };
        let hand = &mut self.hands[index];
        let was_late = std::mem::replace(&mut hand.room.other_gaps, other.gaps) != other.gaps;
        let is_late = was_late || other.wrist.is_late(hand.output.estimate.time);
        is_late && hand.output.pose.other_wrist.is_some()
    }

    /// Releases what the other hand holds on boards that follow this one, if this one is lost.
    pub(super) fn release_followers(&mut self, index: usize, events: &mut Events) {
        if self.hands[index].wrist_in_room().is_some() {
            return;
        }
        for other in 0..self.hands.len() {
            if other != index && self.hands[other].output.pose.other_wrist.is_some() {
                self.release_lost(other, events);
            }
        }
    }
}
