//! The sequence of poses of a calibration, with repeat and skip.

use std::time::Duration;

use super::capture::{CaptureState, LiveChannel, PoseCapture};
use super::observation::Observations;
use super::pose::CalibrationPose;
use super::recorded::PoseMark;
use crate::capture::{Channels, MAX_CHANNELS};
use crate::estimate::{ChannelMap, InputRow};
use crate::hand::Dof;
use crate::time::Timestamp;

/// The longest gap between two readings of one pose. After a longer one the hand was not seen, and the pose starts again.
const MAX_GAP: Duration = Duration::from_secs(1);

/// The smallest angle between two poses, in radians, by which a hand that takes the second one is told from a hand that has not moved:
/// 40°. Fingers at rest may be straight already.
const LARGE_TURN: f64 = 0.7;

/// The state of a procedure after a reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ProcedureState {
    /// The pose and its progress. The state [`CaptureState::Captured`] occurs once for each pose; the next reading belongs to the
    /// next pose.
    Pose(CalibrationPose, CaptureState),
    /// All poses are captured or skipped.
    Finished,
}

/// The sequence of poses of a calibration. It is fed with readings and leads from pose to pose.
#[derive(Clone, Debug)]
pub struct Procedure {
    poses: Vec<CalibrationPose>,
    channels: Vec<usize>,
    /// The joints of the channels; none for an unknown glove.
    joints: Vec<(Dof, usize)>,
    prepare: Duration,
    index: usize,
    capture: Option<PoseCapture>,
    /// The time of the last reading.
    latest: Option<Timestamp>,
    live: Vec<LiveChannel>,
    observations: Observations,
    marks: Vec<PoseMark>,
}

impl Procedure {
    /// Creates the procedure for a glove: the poses that it needs, each after a countdown of `prepare`.
    pub fn for_glove(map: &ChannelMap, prepare: Duration) -> Self {
        let poses = CalibrationPose::GUIDED.iter().copied();
        let poses = poses.filter(|pose| pose.is_needed_for(map)).collect();
        let rows = map.rows().iter();
        Self {
            joints: rows.map(|row| (row.dof, row.channel)).collect(),
            ..Self::new(poses, map.angle_channels(), prepare)
        }
    }

    /// Adds the poses of single fingers, which find swapped sensors of fingers that bend together in all other poses.
    #[must_use]
    pub fn with_single_fingers(mut self, map: &ChannelMap) -> Self {
        let poses = CalibrationPose::SINGLE_FINGERS.iter().copied();
        self.poses
            .extend(poses.filter(|pose| pose.is_needed_for(map)));
        self
    }

    /// Creates the procedure for an unknown glove: the flat hand and single fingers, with all channels except the channels of
    /// `inputs`, which measure no joint.
    pub fn for_unknown_glove(
        poses: &[CalibrationPose],
        inputs: &[InputRow],
        prepare: Duration,
    ) -> Self {
        let is_input = |channel: usize| inputs.iter().any(|input| input.channel == channel);
        let channels = (0..MAX_CHANNELS).filter(|channel| !is_input(*channel));
        Self::new(poses.to_vec(), channels.collect(), prepare)
    }

    fn new(poses: Vec<CalibrationPose>, channels: Vec<usize>, prepare: Duration) -> Self {
        let live = channels.iter().map(|&channel| LiveChannel::new(channel));
        Self {
            live: live.collect(),
            poses,
            channels,
            joints: Vec::new(),
            prepare,
            index: 0,
            capture: None,
            latest: None,
            observations: Observations::default(),
            marks: Vec::new(),
        }
    }

    /// Adds a reading and returns the progress.
    pub fn push(&mut self, time: Timestamp, channels: &Channels) -> ProcedureState {
        for live in &mut self.live {
            live.push(channels);
        }
        let Some(pose) = self.pose() else {
            return ProcedureState::Finished;
        };
        let latest = self.latest.replace(time);
        if latest.is_some_and(|latest| time.since(latest) > MAX_GAP) {
            self.capture = None;
        }
        let new = || {
            let before = counts_before(pose, &self.observations, &self.joints);
            PoseCapture::new(pose, &self.channels, self.prepare).after(before)
        };
        let capture = self.capture.get_or_insert_with(new);
        let state = capture.push(time, channels);
        if state == CaptureState::Captured {
            self.finish_pose();
        }
        ProcedureState::Pose(pose, state)
    }

    /// Returns the present pose, or `None` at the end.
    pub fn pose(&self) -> Option<CalibrationPose> {
        self.poses.get(self.index).copied()
    }

    /// Returns the index of the present pose; the number of poses at the end.
    pub fn index(&self) -> usize {
        self.index
    }

    /// Returns all poses.
    pub fn poses(&self) -> &[CalibrationPose] {
        &self.poses
    }

    /// Skips to the next pose. The present pose counts as not observed.
    pub fn skip(&mut self) {
        if let Some(pose) = self.pose() {
            self.forget(pose);
            self.index += 1;
        }
        self.capture = None;
    }

    /// Starts the present pose again with its countdown, or the previous pose if the present pose has not begun.
    pub fn repeat(&mut self) {
        let is_counting =
            |capture: &PoseCapture| matches!(capture.state(), CaptureState::Preparing(_));
        if self.capture.as_ref().is_none_or(is_counting) {
            self.index = self.index.saturating_sub(1);
        }
        if let Some(pose) = self.pose() {
            self.forget(pose);
        }
        self.capture = None;
    }

    /// Returns the present counts and ranges of the channels of the glove.
    pub fn live(&self) -> &[LiveChannel] {
        &self.live
    }

    /// Returns the observations so far.
    pub fn observations(&self) -> &Observations {
        &self.observations
    }

    /// Returns the times of the observations so far, with which a recording finds them again.
    pub fn marks(&self) -> &[PoseMark] {
        &self.marks
    }

    fn finish_pose(&mut self) {
        let Some(capture) = self.capture.take() else {
            return;
        };
        if let (Some(observation), Some((start, end))) = (capture.observation(), capture.span()) {
            let pose = observation.pose;
            self.forget(pose);
            self.observations.insert(observation.clone());
            self.marks.push(PoseMark { pose, start, end });
        }
        self.index += 1;
    }

    fn forget(&mut self, pose: CalibrationPose) {
        self.observations.remove(pose);
        self.marks.retain(|mark| mark.pose != pose);
    }
}

/// Returns the channels whose joints turn by a large angle from the pose before to `pose`, with their counts in the pose before. For an
/// unknown glove, these are all channels if `pose` bends a finger.
fn counts_before(
    pose: CalibrationPose,
    observations: &Observations,
    joints: &[(Dof, usize)],
) -> Vec<(usize, f64)> {
    let Some(before) = observations.poses().last() else {
        return Vec::new();
    };
    if joints.is_empty() && pose.bent_finger().is_some() {
        let sent = before.channels.iter().filter(|it| it.is_sent);
        return sent.map(|it| (it.channel, it.median)).collect();
    }
    let turns = |dof: Dof| {
        let is_known = !before.pose.leaves_free(dof) && !pose.leaves_free(dof);
        let turn = pose.expected(dof).radians - before.pose.expected(dof).radians;
        is_known && turn.abs() >= LARGE_TURN
    };
    let turned = joints.iter().filter(|(dof, _)| turns(*dof));
    let count = |(_, channel): &(Dof, usize)| {
        let seen = before.channel(*channel).filter(|it| it.is_sent)?;
        Some((*channel, seen.median))
    };
    turned.filter_map(count).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Document;
    use crate::layout::Glove;

    /// Pushes a reading with this count of all channels.
    fn push(procedure: &mut Procedure, packet: u64, count: u16) -> ProcedureState {
        let channels = Channels {
            full_scale: 4095,
            counts: std::iter::repeat_n(count, MAX_CHANNELS).collect(),
            unsent: Default::default(),
        };
        procedure.push(Timestamp(packet * 10_000), &channels)
    }

    /// A hand that holds one posture after the other for 3 s each.
    fn run(procedure: &mut Procedure, packets: std::ops::Range<u64>) -> Vec<CalibrationPose> {
        let mut captured = Vec::new();
        for packet in packets {
            let state = push(procedure, packet, 40 + 100 * procedure.index() as u16);
            if let ProcedureState::Pose(pose, CaptureState::Captured) = state {
                captured.push(pose);
            }
        }
        captured
    }

    fn procedure() -> Procedure {
        let map = Glove::parse(&Document::shipped("lucidgloves").unwrap())
            .unwrap()
            .map;
        Procedure::for_glove(&map, Duration::from_secs(1))
    }

    #[test]
    fn poses_follow_each_other_to_the_end() {
        let mut procedure = procedure();
        let poses = procedure.poses().to_vec();
        assert_eq!(run(&mut procedure, 0..1_200), poses);
        assert_eq!(procedure.pose(), None);
        assert_eq!(procedure.observations().poses().len(), poses.len());
        let marks = procedure.marks();
        assert!(marks.windows(2).all(|pair| pair[0].end < pair[1].start));
        let fist = procedure.observations().get(CalibrationPose::Fist).unwrap();
        assert_eq!(fist.median(10), Some(340.0));
    }

    #[test]
    fn a_gap_in_the_readings_starts_the_pose_again() {
        let mut procedure = procedure();
        // 1 s of countdown, and nearly 1 s of rest.
        assert_eq!(run(&mut procedure, 0..190), []);
        assert_eq!(
            run(&mut procedure, 5_000..5_190),
            [],
            "the program was stopped"
        );
        assert_eq!(run(&mut procedure, 5_190..5_210), [CalibrationPose::Rest]);
    }

    #[test]
    fn a_hand_that_stays_in_the_pose_before_is_waited_for_some_seconds() {
        use CalibrationPose::{Fist, Flat, Rest, Spread};
        let mut slow = procedure();
        assert_eq!(run(&mut slow, 0..605), [Rest, Flat, Spread]);
        let mut state = ProcedureState::Finished;
        for packet in 605..1_000 {
            state = push(&mut slow, packet, 240);
        }
        let waits = ProcedureState::Pose(Fist, CaptureState::Preparing(Duration::ZERO));
        assert_eq!(state, waits);
        assert_eq!(run(&mut slow, 1_000..1_200), [Fist]);
        // The sensors of a glove may be dead.
        let mut unmoved = procedure();
        assert_eq!(run(&mut unmoved, 0..605), [Rest, Flat, Spread]);
        let captured = ProcedureState::Pose(Fist, CaptureState::Captured);
        let found = (605..1_320).find(|&packet| push(&mut unmoved, packet, 240) == captured);
        assert!(found.is_some_and(|packet| packet > 1_200), "{found:?}");
    }

    #[test]
    fn a_finger_of_an_unknown_glove_is_waited_for() {
        let poses = [CalibrationPose::Flat, CalibrationPose::IndexBent];
        let mut procedure = Procedure::for_unknown_glove(&poses, &[], Duration::from_secs(1));
        assert_eq!(run(&mut procedure, 0..250), [CalibrationPose::Flat]);
        let mut state = ProcedureState::Finished;
        for packet in 250..600 {
            state = push(&mut procedure, packet, 40);
        }
        let waiting = CaptureState::Preparing(Duration::ZERO);
        let waits = ProcedureState::Pose(CalibrationPose::IndexBent, waiting);
        assert_eq!(state, waits);
        assert_eq!(run(&mut procedure, 600..800), [CalibrationPose::IndexBent]);
    }

    #[test]
    fn a_skipped_pose_is_not_observed_and_a_repeated_one_is_replaced() {
        let mut procedure = procedure();
        procedure.skip();
        let captured = run(&mut procedure, 0..205);
        assert_eq!(captured, [CalibrationPose::Flat]);
        // The countdown of the next pose runs: the last pose is repeated.
        procedure.repeat();
        assert_eq!(procedure.pose(), Some(CalibrationPose::Flat));
        assert!(procedure.observations().poses().is_empty() && procedure.marks().is_empty());
        let later = run(&mut procedure, 300..700);
        assert_eq!(later[..2], [CalibrationPose::Flat, CalibrationPose::Spread]);
        assert_eq!(procedure.observations().get(CalibrationPose::Rest), None);
    }
}
