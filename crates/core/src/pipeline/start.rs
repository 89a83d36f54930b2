//! The position of the hand at the start, from which boards and pointers with the anchor `start` are measured.

use std::time::Duration;

use parry3d::math::Vec3;

use super::{Pipeline, PipelineState};
use crate::contact::trusted_fingertip;
use crate::device::Events;
use crate::hand::Finger;
use crate::hand::open_hand::{HOLD, StillTip, is_straight};
use crate::kinematics::{HandPose, StartPlace};

/// The longest gap between two poses of a hand that is held.
const MAX_GAP: Duration = Duration::from_millis(250);

/// Fingers that are extended in an open hand.
const FINGERS: [Finger; 4] = [Finger::Index, Finger::Middle, Finger::Ring, Finger::Little];

/// Detects an open hand that is held still.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StartDetector(Option<Held>);

/// An open hand that is held still, and the positions of its index fingertip so far.
#[derive(Clone, Copy, Debug)]
struct Held {
    tip: StillTip,
    sum: Vec3,
    count: f32,
}

impl StartDetector {
    /// Processes the next pose, and returns the mean position of the index fingertip once the hand was held for [`HOLD`].
    fn update(&mut self, pose: &HandPose) -> Option<Vec3> {
        let Some(at) = open_fingertip(pose).filter(|_| !pose.jumped) else {
            self.0 = None;
            return None;
        };
        let follow = |held: Held| {
            let tip = held.tip.at(pose.time, at, MAX_GAP)?;
            Some(Held { tip, ..held })
        };
        let mut held = self.0.and_then(follow).unwrap_or(Held {
            tip: StillTip::new(pose.time, at),
            sum: Vec3::ZERO,
            count: 0.0,
        });
        held.sum += at;
        held.count += 1.0;
        self.0 = Some(held);
        (held.tip.duration() >= HOLD).then(|| held.sum / held.count)
    }

    /// Discards the poses so far: the hand has to be held still from its next pose on.
    fn reset(&mut self) {
        self.0 = None;
    }
}

/// Returns the index fingertip of an open hand, or `None` if a finger is bent or not known.
fn open_fingertip(pose: &HandPose) -> Option<Vec3> {
    let is_open = |finger: &Finger| is_extended(pose, *finger) == Some(true);
    let tip = trusted_fingertip(pose, Finger::Index)?;
    FINGERS.iter().all(is_open).then_some(tip)
}

/// Returns `true` if a finger is straight; `None` if it is not known. Joints that the arm model lacks count as straight.
fn is_extended(pose: &HandPose, finger: Finger) -> Option<bool> {
    trusted_fingertip(pose, finger)?;
    let joints = &finger.joints()[1..];
    pose.position(*joints.first()?)?;
    Some(is_straight(
        joints.iter().filter_map(|joint| pose.position(*joint)),
    ))
}

impl Pipeline {
    /// Returns `true` if output is armed and the layout waits for an open hand that is held still.
    pub fn awaits_start(&self) -> bool {
        let is_placed = |pose: &HandPose| pose.start.own.is_some();
        self.state() == PipelineState::Running
            && self.layout().starts_at_hand()
            && !self.hands.iter().any(|hand| is_placed(&hand.output.pose))
    }

    /// Places what is anchored at the start at an open hand that was held still: at its index fingertip, or at the point that a
    /// pointer follows. While something is pressed, nothing is placed.
    pub(super) fn place_at_start(&mut self, index: usize, events: &mut Events) {
        let layout = &self.profiles[self.active_profile].layout;
        if !layout.starts_at_hand() {
            return;
        }
        let is_ready = self.state() == PipelineState::Running && !layout.is_in_use();
        let hand = &mut self.hands[index];
        if !is_ready || !hand.output.estimate.is_placed || hand.output.pose.start.own.is_some() {
            hand.start.reset();
            return;
        }
        let Some(place) = hand.start.update(&hand.output.pose) else {
            return;
        };
        hand.start.reset();
        // Pointers and fingertips start over in controls that have just appeared around them.
        self.release_all(self.time, events);
        let pose = &mut self.hands[index].output.pose;
        pose.start = StartPlace {
            own: Some(place),
            shared: pose.start.shared,
            ..StartPlace::from_pose(pose)
        };
        for other in &mut self.hands {
            other.output.pose.start.shared.get_or_insert(place);
        }
    }

    /// Releases everything and removes what is anchored at the start, until an open hand is held still again.
    pub(super) fn place_again(&mut self, events: &mut Events) {
        self.release_all(self.time, events);
        for hand in &mut self.hands {
            hand.output.pose.start = StartPlace::default();
            hand.start.reset();
        }
    }
}

#[cfg(test)]
mod tests {
    use parry3d::math::Pose;

    use super::*;
    use crate::hand::Side;
    use crate::time::Timestamp;

    /// A hand whose fingers point up, each with bones of 40, 30 and 20 mm; the last two are bent by `bend` radians.
    fn hand(time_ms: u64, place: Vec3, bend: f32) -> HandPose {
        let mut pose = HandPose::new(Timestamp(time_ms * 1000), Side::Right, 0.005);
        for (number, finger) in FINGERS.into_iter().enumerate() {
            let mut position = place + Vec3::X * 0.02 * number as f32 - Vec3::Y * 0.09;
            let mut angle = 0.0_f32;
            let joints = finger.joints()[1..].iter();
            for (joint, (length, turn)) in
                joints.zip([(0.0, 0.0), (0.04, 0.0), (0.03, bend), (0.02, bend)])
            {
                angle += turn;
                position += Vec3::new(0.0, angle.cos(), -angle.sin()) * length;
                pose.set(*joint, Pose::from_translation(position));
            }
        }
        pose
    }

    fn found(poses: impl IntoIterator<Item = HandPose>) -> Option<(Timestamp, Vec3)> {
        let mut detector = StartDetector::default();
        let mut poses = poses.into_iter();
        poses.find_map(|pose| Some((pose.time, detector.update(&pose)?)))
    }

    #[test]
    fn an_open_hand_that_is_still_for_a_second_has_the_mean_place_of_its_index_fingertip() {
        let place = |frame: u64| Vec3::new(0.1 + 0.01 * (frame % 2) as f32, 0.2, -0.4);
        let poses = (0..40).map(|frame| hand(33 * frame, place(frame), 0.0));
        let (time, found) = found(poses).expect("it is still");
        assert_eq!(time, Timestamp(31 * 33_000));
        let expected = Vec3::new(0.105, 0.2, -0.4);
        assert!(found.distance(expected) < 0.003, "{found}");
    }

    #[test]
    fn a_hand_that_moves_jumps_is_lost_or_is_closed_has_no_place() {
        let still = Vec3::new(0.1, 0.2, -0.4);
        let open = |frame: u64| hand(33 * frame, still, 0.1);
        let moving = |frame: u64| hand(33 * frame, still + Vec3::X * 0.002 * frame as f32, 0.1);
        assert_eq!(found((0..90).map(moving)), None);
        assert_eq!(
            found((0..90).map(|frame| hand(33 * frame, still, 0.8))),
            None
        );
        let jumping = |frame: u64| {
            let mut pose = open(frame);
            pose.jumped = frame.is_multiple_of(20);
            pose
        };
        assert_eq!(found((0..90).map(jumping)), None);
        let lost = (0..90).filter(|frame| frame % 30 < 20).map(open);
        assert_eq!(found(lost), None);
        let untrusted = |frame: u64| {
            let mut pose = open(frame);
            if frame.is_multiple_of(25) {
                pose.untrusted = pose.untrusted.with(Finger::Ring);
            }
            pose
        };
        assert_eq!(found((0..90).map(untrusted)), None);
    }
}
