//! Errors of a calibration.

use super::pose::CalibrationPose;
use super::problem::{Problem, problem_messages};
use crate::hand::Finger;
use crate::message::escape;

/// The reason why the data give no calibration. Each message states what is wrong and what to do.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CalibrationError {
    /// The glove has no rows.
    #[error("the glove has no channels for joints; discover them, or start from another glove")]
    EmptyGlove,
    /// The readings carry none of the channels of the glove.
    #[error(
        "the readings have no channel of this glove file; start from another glove (`ademan gloves` lists them), or find the channels with `--discover`"
    )]
    NothingSent,
    /// Too few poses were observed.
    #[error(
        "only {observed} poses were observed: a calibration needs at least the flat hand and the fist; repeat it without skipping them"
    )]
    TooFewPoses {
        /// The number of poses.
        observed: usize,
    },
    /// The readings do not have the full scale of the glove.
    #[error(
        "the readings have counts up to {found}, the glove file states {expected}; start from a glove of this source (`ademan gloves` lists them), or correct `full_scale_counts`"
    )]
    OtherFullScale {
        /// The full scale of the readings.
        found: u16,
        /// The full scale of the glove file.
        expected: u16,
    },
    /// Joints of the hand cannot be used.
    #[error("the calibration is not usable: {}", reasons(.problems))]
    Unusable {
        /// The problems.
        problems: Vec<Problem>,
    },
    /// A recording does not contain the poses.
    #[error(
        "the recording has {found} still phases, and the procedure has {expected} poses; record it again with `ademan calibrate`, which marks the poses, or hold each pose for 2 s"
    )]
    PosesNotFound {
        /// The number of still phases.
        found: usize,
        /// The number of poses.
        expected: usize,
    },
    /// A recording has no readings of channels.
    #[error(
        "the recording has no readings of sensor channels; only gloves with channels are calibrated"
    )]
    NoChannels,
    /// A pose was skipped without which the index finger of an unknown glove is not found.
    #[error(
        "the pose `{pose}` was skipped, and no channel of the index finger is found without it; repeat the poses and take it"
    )]
    PoseSkipped {
        /// The pose.
        pose: CalibrationPose,
    },
    /// No channel of an unknown glove follows the index finger.
    #[error(
        "no channel changes when only the index finger bends, and nothing can be typed without it; check the wires, or repeat the poses with larger movements"
    )]
    NoIndexFinger,
    /// The marks of a recording are damaged.
    #[error(
        "the marks of the poses in the recording are damaged at `{}`; record the calibration again",
        escape(.line)
    )]
    InvalidMarks {
        /// The line.
        line: String,
    },
}

/// The number of parts of the arm without a working sensor from which on the glove file is probably of another glove: each finger is a
/// part, and so is the rest.
const MANY_PARTS: usize = 3;

/// Returns the advice if the channels of many parts of the arm carry nothing.
pub fn other_glove_advice(problems: &[Problem]) -> Option<&'static str> {
    let is_idle = |problem: &&Problem| {
        matches!(
            problem,
            Problem::DeadChannel { .. } | Problem::MissingChannel { .. }
        )
    };
    let idle = problems.iter().filter(is_idle);
    let mut parts: Vec<Option<Finger>> = idle.map(|problem| problem.dof().finger()).collect();
    parts.sort_unstable();
    parts.dedup();
    (parts.len() >= MANY_PARTS).then_some(
        "if the hand took the poses, the glove has other channels than the glove file: find them with `ademan calibrate --discover`, \
         and name the new file with `--glove`",
    )
}

fn reasons(problems: &[Problem]) -> String {
    let messages = problem_messages(problems).into_iter();
    let mut reasons: Vec<String> = messages.map(|(_, message)| message).collect();
    reasons.extend(other_glove_advice(problems).map(str::to_owned));
    reasons.join("; ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hand::Dof;

    #[test]
    fn a_glove_without_counts_in_many_parts_is_to_be_discovered() {
        let dead = |channel, dof| Problem::DeadChannel {
            channel,
            dof,
            count: 0.0,
        };
        let mut problems = vec![
            dead(1, Dof::IndexMcpFlexion),
            dead(2, Dof::IndexPipFlexion),
            dead(3, Dof::ElbowFlexion),
        ];
        let message =
            |found: Vec<Problem>| CalibrationError::Unusable { problems: found }.to_string();
        let few = message(problems.clone());
        assert!(!few.contains("--discover"), "{few}");
        problems.push(dead(4, Dof::RingMcpFlexion));
        let many = message(problems);
        assert!(many.contains("`ademan calibrate --discover`"), "{many}");
    }
}
