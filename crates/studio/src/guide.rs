//! The guided calibration: readings through the [`Procedure`] of `ademan calibrate`, and the result.

use std::time::Duration;

use super::glove_editor::{Calibration, GloveEditor};
use super::sensors::SensorTable;
use ademan_core::calibrate::{
    self, CalibrationError, CalibrationPose, CalibrationResult, CaptureState, FingerSensor,
    Observations, Procedure, ProcedureState,
};
use ademan_core::estimate::{ChannelMap, ChannelRow, CountRange};
use ademan_core::hand::{Dof, Side};
use ademan_core::time::Timestamp;
use ademan_runtime::capture::Channels;
use ademan_runtime::sim::SimulatedWearer;

/// Time before each pose.
const COUNTDOWN: Duration = Duration::from_secs(3);

/// The most that a simulated person makes up for after a pause of the window.
const MAX_DELAY: Duration = Duration::from_secs(1);

/// A guided calibration of a glove.
pub struct Guide {
    start: ChannelMap,
    side: Side,
    procedure: Procedure,
    table: SensorTable,
    state: CaptureState,
    person: Option<Person>,
    result: Option<Result<Box<GuideResult>, CalibrationError>>,
}

/// A simulated person who takes the poses, and the time up to which they have moved.
struct Person {
    wearer: Box<SimulatedWearer>,
    time: Duration,
    packet: Timestamp,
}

/// The result of a calibration.
#[derive(Clone, Debug)]
pub struct GuideResult {
    /// The values for the glove file.
    pub calibration: Calibration,
    /// Score, and problems with their reasons.
    pub fit: CalibrationResult,
    /// The change of each joint.
    pub changes: Vec<JointChange>,
    /// The sensors that follow another finger than in the glove file.
    pub moved: Vec<FingerSensor>,
    /// `true` if the values have them at the fingers that they follow.
    pub is_matched: bool,
    /// `true` if only some of the poses of single fingers were taken, so that the sensors of the fingers were not compared.
    pub is_uncompared: bool,
}

/// The angles of a joint at the ends of the range of its sensor, before and after a calibration, in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointChange {
    /// The joint.
    pub dof: Dof,
    /// Before, the smaller first.
    pub before: [f64; 2],
    /// After, the smaller first.
    pub after: [f64; 2],
}

/// A mark of a pose in the list of poses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PoseProgress {
    /// It was taken.
    Taken,
    /// It is taken now.
    Present,
    /// It was skipped.
    Skipped,
    /// It is still to come.
    ToCome,
}

impl Guide {
    /// Starts the calibration of a glove, for the person at the source.
    pub fn new(editor: &GloveEditor) -> Self {
        let start = editor.map().clone();
        Self {
            side: editor.glove().side,
            procedure: Procedure::for_glove(&start, COUNTDOWN),
            table: SensorTable::new(&start),
            start,
            state: CaptureState::Preparing(COUNTDOWN),
            person: None,
            result: None,
        }
    }

    /// Starts the calibration of a glove for the simulated person with this number.
    pub fn demonstration(editor: &GloveEditor, number: u64) -> Self {
        let guide = Self::new(editor);
        let wearer = Box::new(SimulatedWearer::new(number, &guide.start, guide.side));
        Self {
            person: Some(Person {
                wearer,
                time: Duration::ZERO,
                packet: Timestamp::default(),
            }),
            ..guide
        }
    }

    /// Adds the poses of single fingers, which find exchanged sensors.
    #[must_use]
    pub fn with_single_fingers(mut self) -> Self {
        self.procedure = self.procedure.with_single_fingers(&self.start);
        self
    }

    /// Returns `true` if a simulated person takes the poses.
    pub fn is_demonstration(&self) -> bool {
        self.person.is_some()
    }

    /// Processes a reading of the source. A demonstration has readings of its own.
    pub fn push(&mut self, time: Timestamp, channels: &Channels) {
        if self.person.is_none() {
            self.process(time, channels);
        }
    }

    /// Moves the simulated person on by the time since the last frame.
    pub fn advance(&mut self, elapsed: Duration) {
        let Some(mut person) = self.person.take() else {
            return;
        };
        person.time += elapsed.min(MAX_DELAY);
        while Duration::from_micros(person.packet.0) < person.time
            && let Some(pose) = self.procedure.pose()
        {
            person.wearer.take(pose);
            let (time, channels) = person.wearer.next_packet();
            person.packet = time;
            self.process(time, &channels);
        }
        self.person = Some(person);
    }

    fn process(&mut self, time: Timestamp, channels: &Channels) {
        let (found, expected) = (channels.full_scale, self.start.full_scale());
        if found != expected {
            let error = CalibrationError::OtherFullScale { found, expected };
            self.result = Some(Err(error));
            return;
        }
        self.table.update(time, channels);
        if let ProcedureState::Pose(_, state) = self.procedure.push(time, channels) {
            self.state = state;
        }
        self.finish();
    }

    /// Fits the glove once all poses are taken or skipped.
    fn finish(&mut self) {
        if self.procedure.pose().is_none() && self.result.is_none() {
            let observations = self.procedure.observations();
            let sensors = calibrate::finger_sensors(observations, &self.start);
            let matched = sensors
                .as_deref()
                .and_then(|all| calibrate::at_their_fingers(all, &self.start));
            let start = matched.as_ref().unwrap_or(&self.start);
            let fit = calibrate::fit(&observations.without_single_fingers(), start);
            let is_matched = matched.is_some();
            let result =
                fit.map(|fit| Box::new(self.result_of(fit, sensors.as_deref(), is_matched)));
            self.result = Some(result);
        }
    }

    fn result_of(
        &self,
        fit: CalibrationResult,
        sensors: Option<&[FingerSensor]>,
        is_matched: bool,
    ) -> GuideResult {
        let observations = self.procedure.observations();
        GuideResult {
            calibration: Calibration {
                map: fit.map.clone(),
                rest: calibrate::rest_pose(observations, &fit.map),
            },
            changes: changes(&self.start, &fit.map, observations),
            is_uncompared: sensors.is_none()
                && *observations != observations.without_single_fingers(),
            moved: sensors
                .unwrap_or_default()
                .iter()
                .copied()
                .filter(FingerSensor::is_moved)
                .collect(),
            is_matched,
            fit,
        }
    }

    /// Skips the present pose.
    pub fn skip(&mut self) {
        self.procedure.skip();
        self.finish();
    }

    /// Starts the present pose again, or during its countdown the previous pose.
    pub fn repeat(&mut self) {
        self.result = None;
        self.procedure.repeat();
    }

    /// Returns the pose to take, or `None` at the end.
    pub fn pose(&self) -> Option<CalibrationPose> {
        self.procedure.pose()
    }

    /// Returns the progress of the present pose.
    pub fn state(&self) -> CaptureState {
        self.state
    }

    /// Returns the hand of the glove.
    pub fn side(&self) -> Side {
        self.side
    }

    /// Returns the procedure.
    pub fn procedure(&self) -> &Procedure {
        &self.procedure
    }

    /// Returns the present counts of the channels.
    pub fn table(&self) -> &SensorTable {
        &self.table
    }

    /// Returns the range that a channel has covered so far, in counts.
    pub fn seen(&self, channel: usize) -> Option<CountRange> {
        let mut live = self.procedure.live().iter();
        let (low, high) = live.find(|live| live.channel == channel)?.range?;
        Some((f64::from(low), f64::from(high)))
    }

    /// Returns the result, or `None` before the end.
    pub fn result(&self) -> Option<Result<&GuideResult, &CalibrationError>> {
        self.result.as_ref().map(|result| result.as_deref())
    }

    /// Iterates over all poses with their progress.
    pub fn poses(&self) -> impl Iterator<Item = (CalibrationPose, PoseProgress)> {
        let procedure = &self.procedure;
        let poses = procedure.poses().iter().enumerate();
        poses.map(move |(index, &pose)| {
            let is_taken = procedure.observations().get(pose).is_some();
            let progress = match (index == procedure.index(), is_taken) {
                (true, _) => PoseProgress::Present,
                (false, true) => PoseProgress::Taken,
                (false, false) if index < procedure.index() => PoseProgress::Skipped,
                (false, false) => PoseProgress::ToCome,
            };
            (pose, progress)
        })
    }

    /// Returns `true` if the present pose is taken for a joint.
    pub fn moves(&self, dof: Dof) -> bool {
        self.pose()
            .is_some_and(|pose| pose.defines(dof) && pose.expected(dof).radians != 0.0)
    }
}

/// Returns the change of each joint whose sensor was seen.
fn changes(start: &ChannelMap, new: &ChannelMap, observations: &Observations) -> Vec<JointChange> {
    let rows = start.rows().iter().zip(new.rows());
    let change = |(old, row): (&ChannelRow, &ChannelRow)| {
        let (low, high) = observations.range(row.channel)?;
        let ends = |map: &ChannelMap, channel_row: &ChannelRow| {
            let degrees = |count| map.radians(channel_row, count).to_degrees();
            let (one, other) = (degrees(low), degrees(high));
            [one.min(other), one.max(other)]
        };
        Some(JointChange {
            dof: row.dof,
            before: ends(start, old),
            after: ends(new, row),
        })
    };
    rows.filter_map(change).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use ademan_core::calibrate::observe_recording;
    use ademan_core::document::Document;
    use ademan_core::layout::{Glove, write_calibration};
    use ademan_runtime::sim::GloveFault;

    const STEP: Duration = Duration::from_millis(16);

    fn editor() -> GloveEditor {
        GloveEditor::new(&Document::shipped("unam-hc11").unwrap()).unwrap()
    }

    /// Plays a simulated person at a source through the guide, and returns the readings. The person leaves out one pose.
    fn play(
        guide: &mut Guide,
        mut wearer: SimulatedWearer,
        skipped: Option<CalibrationPose>,
    ) -> Vec<(Timestamp, Channels)> {
        let mut readings = Vec::new();
        while let Some(pose) = guide.pose() {
            if Some(pose) == skipped {
                guide.skip();
                continue;
            }
            wearer.take(pose);
            let (time, channels) = wearer.next_packet();
            guide.push(time, &channels);
            readings.push((time, channels));
            assert!(readings.len() < 20_000, "stays at {pose}");
        }
        readings
    }

    #[test]
    fn the_file_is_the_one_that_the_command_computes_from_the_same_recording() {
        let mut editor = editor();
        let mut guide = Guide::new(&editor);
        let wearer = SimulatedWearer::new(3, &guide.start, guide.side);
        let readings = play(&mut guide, wearer, None);
        let result = guide.result().unwrap().unwrap().clone();
        editor.set_all(result.calibration);
        let text = editor.text().unwrap();

        let document = Document::shipped("unam-hc11").unwrap();
        let map = Glove::parse(&document).unwrap().map;
        let marks = guide.procedure().marks();
        let observations = observe_recording(&readings, marks, &map).unwrap();
        let fit = calibrate::fit(&observations, &map).unwrap();
        let rest = calibrate::rest_pose(&observations, &fit.map);
        assert_eq!(text, write_calibration(&document, &fit.map, &rest).unwrap());
        assert_ne!(text, document.text);
        assert!(fit.score > 50 && result.fit.score == fit.score);
        editor.undo();
        assert_eq!(editor.text().unwrap(), document.text);
    }

    #[test]
    fn exchanged_sensors_are_put_right_with_each_finger_alone() {
        let mut glove_editor = editor();
        let mut guide = Guide::new(&glove_editor).with_single_fingers();
        let fault = GloveFault::Swapped(9, 52);
        let wearer = SimulatedWearer::new(8, &guide.start, guide.side).with_fault(fault);
        play(&mut guide, wearer, None);
        let result = guide.result().unwrap().unwrap();
        let moved: Vec<usize> = result.moved.iter().map(|sensor| sensor.channel).collect();
        assert_eq!(moved, [52, 9]);
        assert!(result.is_matched && !result.is_uncompared);
        glove_editor.set_all(result.calibration.clone());
        let text = glove_editor.text().unwrap();
        assert!(
            text.contains(r#"dof: "middle-pip-flexion", channel: 9,"#),
            "{text}"
        );
    }

    #[test]
    fn the_sensors_of_the_fingers_are_not_compared_without_a_pose_of_one_finger() {
        let mut guide = Guide::new(&editor()).with_single_fingers();
        let wearer = SimulatedWearer::new(8, &guide.start, guide.side);
        play(&mut guide, wearer, Some(CalibrationPose::RingBent));
        let result = guide.result().unwrap().unwrap();
        assert!(result.is_uncompared && result.moved.is_empty());
    }

    #[test]
    fn a_demonstration_takes_all_poses_by_itself() {
        let mut guide = Guide::demonstration(&editor(), 1);
        let count = guide.poses().count();
        let frames = (0..20_000).take_while(|_| {
            guide.advance(STEP);
            guide.result().is_none()
        });
        let seconds = frames.count() as f32 * STEP.as_secs_f32();
        assert!((40.0..120.0).contains(&seconds), "{seconds} s");
        let taken = guide.poses().filter(|(_, it)| *it == PoseProgress::Taken);
        assert_eq!(taken.count(), count);
        let result = guide.result().unwrap().unwrap();
        assert!(result.changes.len() > 10);
    }

    #[test]
    fn a_skipped_pose_is_marked_and_too_few_poses_are_an_error_that_can_be_repeated() {
        let mut guide = Guide::new(&editor());
        guide.skip();
        let first: Vec<_> = guide
            .poses()
            .take(3)
            .map(|(_, progress)| progress)
            .collect();
        let expected = [
            PoseProgress::Skipped,
            PoseProgress::Present,
            PoseProgress::ToCome,
        ];
        assert_eq!(first, expected);
        while guide.pose().is_some() {
            guide.skip();
        }
        let error = guide.result().unwrap().unwrap_err();
        assert!(matches!(
            error,
            CalibrationError::TooFewPoses { observed: 0 }
        ));
        guide.repeat();
        assert!(guide.result().is_none() && guide.pose().is_some());
    }

    #[test]
    fn a_source_of_another_glove_is_an_error() {
        let mut guide = Guide::new(&editor());
        let channels = Channels {
            full_scale: 4095,
            counts: [1; 64].into_iter().collect(),
            unsent: Default::default(),
        };
        guide.push(Timestamp(1), &channels);
        let error = guide.result().unwrap().unwrap_err().to_string();
        assert!(error.contains("full_scale_counts"), "{error}");
    }
}
