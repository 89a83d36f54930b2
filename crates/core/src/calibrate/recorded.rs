//! Calibration from a recording: the poses are found by marks, or else by the still phases in their order.

use std::ops::Range;
use std::time::Duration;

use super::capture::observe;
use super::error::CalibrationError;
use super::observation::{ChannelObservation, Observations, PoseObservation};
use super::pose::CalibrationPose;
use crate::capture::{ChannelSet, Channels};
use crate::estimate::ChannelMap;
use crate::time::Timestamp;

/// The kind of the setup text of a recording with the marks of its poses.
pub const MARKS_KIND: &str = "calibration-poses";

/// The time for which a pose was held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PoseMark {
    /// The pose.
    pub pose: CalibrationPose,
    /// The time of the first reading of the still hand.
    pub start: Timestamp,
    /// The time of the last one.
    pub end: Timestamp,
}

/// Returns marks as a text: a line `POSE START END` for each, times in microseconds.
pub fn marks_to_text(marks: &[PoseMark]) -> String {
    let lines = marks.iter();
    lines
        .map(|mark| format!("{} {} {}\n", mark.pose, mark.start.0, mark.end.0))
        .collect()
}

/// Reads the text of [`marks_to_text`].
pub fn marks_from_text(text: &str) -> Result<Vec<PoseMark>, CalibrationError> {
    let invalid = |line: &str| CalibrationError::InvalidMarks {
        line: line.to_owned(),
    };
    let mark = |line: &str| {
        let [pose, start, end] = line.split(' ').collect::<Vec<_>>()[..] else {
            return Err(invalid(line));
        };
        let time = |word: &str| word.parse().map(Timestamp).map_err(|_| invalid(line));
        let (start, end) = (time(start)?, time(end)?);
        let pose = pose.parse().map_err(|_| invalid(line))?;
        if start <= end {
            Ok(PoseMark { pose, start, end })
        } else {
            Err(invalid(line))
        }
    };
    text.lines().map(mark).collect()
}

/// The time over which stillness is judged.
const WINDOW: Duration = Duration::from_millis(500);

/// The shortest time between two checks: a fast glove sends several readings in that time.
const STEP: Duration = Duration::from_millis(15);

/// The shortest still phase that is a pose.
const SHORTEST: Duration = Duration::from_millis(800);

/// Finds the poses in the readings of a recording, in the order of their times.
///
/// In a recording with marks, each pose is the time that they state. In others, the still phases are the poses of the procedure
/// for this glove, in its order.
///
/// # Errors
/// Fails if the recording has no channels, other counts than the glove, or another number of still phases than poses.
pub fn observe_recording(
    readings: &[(Timestamp, Channels)],
    marks: &[PoseMark],
    map: &ChannelMap,
) -> Result<Observations, CalibrationError> {
    let Some((_, first)) = readings.first() else {
        return Err(CalibrationError::NoChannels);
    };
    if first.full_scale != map.full_scale() {
        return Err(CalibrationError::OtherFullScale {
            found: first.full_scale,
            expected: map.full_scale(),
        });
    }
    let recording = Recording::new(readings, map);
    let marks = if marks.is_empty() {
        recording.still_poses(map)?
    } else {
        marks.to_vec()
    };
    let mut observations = Observations::default();
    for mark in marks {
        let channels = recording.observe(recording.between(mark.start, mark.end));
        observations.insert(PoseObservation {
            pose: mark.pose,
            channels,
        });
    }
    Ok(observations)
}

/// The counts of the channels of a glove in the course of time.
struct Recording {
    channels: Vec<usize>,
    full_scale: u16,
    times: Vec<Timestamp>,
    rows: Vec<Vec<u16>>,
    /// The channels that each reading does not carry.
    unsent: Vec<ChannelSet>,
}

impl Recording {
    fn new(readings: &[(Timestamp, Channels)], map: &ChannelMap) -> Self {
        let channels = map.angle_channels();
        let row = |sample: &Channels| {
            let count = |&channel: &usize| sample.counts.get(channel).copied();
            let counts = channels.iter().map(count);
            counts
                .map(|sent| sent.unwrap_or(Channels::UNKNOWN))
                .collect()
        };
        Self {
            times: readings.iter().map(|(time, _)| *time).collect(),
            rows: readings.iter().map(|(_, sample)| row(sample)).collect(),
            unsent: readings.iter().map(|(_, sample)| sample.unsent).collect(),
            full_scale: map.full_scale(),
            channels,
        }
    }

    /// Returns the indices of the readings from `start` to `end`.
    fn between(&self, start: Timestamp, end: Timestamp) -> Range<usize> {
        let first = self.times.partition_point(|time| *time < start);
        let last = self.times.partition_point(|time| *time <= end);
        first..last.max(first)
    }

    fn observe(&self, readings: Range<usize>) -> Vec<ChannelObservation> {
        let unsent = self.unsent[readings.clone()].iter().copied();
        let unsent = unsent.fold(ChannelSet::ALL, ChannelSet::intersection);
        let rows: Vec<&[u16]> = self.rows[readings].iter().map(Vec::as_slice).collect();
        observe(&rows, &self.channels, unsent, self.full_scale)
    }

    /// Returns the still phases as the poses of the procedure.
    fn still_poses(&self, map: &ChannelMap) -> Result<Vec<PoseMark>, CalibrationError> {
        let poses = CalibrationPose::GUIDED.iter().copied();
        let poses: Vec<_> = poses.filter(|pose| pose.is_needed_for(map)).collect();
        let phases = self.still_phases();
        if phases.len() != poses.len() {
            return Err(CalibrationError::PosesNotFound {
                found: phases.len(),
                expected: poses.len(),
            });
        }
        let mark = |(pose, (start, end))| PoseMark { pose, start, end };
        Ok(poses.into_iter().zip(phases).map(mark).collect())
    }

    /// Returns the times between which the hand was still.
    fn still_phases(&self) -> Vec<(Timestamp, Timestamp)> {
        let mut phases: Vec<(Timestamp, Timestamp)> = Vec::new();
        let mut open: Option<(Timestamp, Timestamp)> = None;
        let (mut first, mut checked) = (0, Timestamp(0));
        for last in 0..self.times.len() {
            let end = self.times[last];
            if last > 0 && end.since(checked) < STEP {
                continue;
            }
            checked = end;
            while end.since(self.times[first]) > WINDOW {
                first += 1;
            }
            let start = self.times[first];
            let is_full = end.since(start) * 5 >= WINDOW * 4;
            if is_full && self.is_still(first..last + 1) {
                open = Some((open.map_or(start, |(start, _)| start), end));
            } else if let Some(phase) = open.take() {
                phases.push(phase);
            }
        }
        phases.extend(open);
        phases.retain(|(start, end)| end.since(*start) >= SHORTEST);
        phases
    }

    /// Returns `true` if all channels are still: a movement of the elbow changes only one.
    fn is_still(&self, readings: Range<usize>) -> bool {
        self.observe(readings)
            .iter()
            .all(|channel| channel.is_still)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_survive_a_text() {
        let mark = |pose, start, end| PoseMark {
            pose,
            start: Timestamp(start),
            end: Timestamp(end),
        };
        let marks = [
            mark(CalibrationPose::Rest, 0, 1_000_000),
            mark(CalibrationPose::WristUp, 2_000_000, 3_500_000),
        ];
        let text = marks_to_text(&marks);
        assert_eq!(text, "rest 0 1000000\nwrist-up 2000000 3500000\n");
        assert_eq!(marks_from_text(&text).unwrap(), marks);
    }

    #[test]
    fn damaged_marks_are_an_error_with_their_line() {
        for line in [
            "fist 1",
            "fits 1 2",
            "fist 2 1",
            "fist 1 -2",
            "fist 1 2 3",
            "",
        ] {
            let text = format!("rest 0 1\n{line}\n");
            let error = marks_from_text(&text).unwrap_err();
            assert!(error.to_string().contains(&format!("`{line}`")), "{error}");
        }
    }
}
