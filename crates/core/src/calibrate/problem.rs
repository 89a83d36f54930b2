//! Problems of a calibration: the sensor, the reason, and the remedy.

use std::fmt;

use super::pose::CalibrationPose;
use crate::hand::Dof;

/// The weight of a problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// The calibration corrects it.
    Corrected,
    /// The joint is less exact than it could be.
    Inexact,
    /// The joint cannot be used.
    Unusable,
}

/// The largest cross-talk of a usable channel, as a fraction of its range: more turns a straight finger half bent.
const MAX_CROSS_TALK: f64 = 0.45;

/// A problem of a calibration. The message states what is wrong, why, and what to do.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Problem {
    /// The counts of a channel never change.
    DeadChannel {
        /// The index of the channel.
        channel: usize,
        /// The joint that it measures.
        dof: Dof,
        /// The count.
        count: f64,
    },
    /// A channel was not measured.
    MissingChannel {
        /// The index of the channel.
        channel: usize,
        /// The joint that it measures.
        dof: Dof,
    },
    /// The counts change too little between the poses.
    SmallRange {
        /// The index of the channel.
        channel: usize,
        /// The joint that it measures.
        dof: Dof,
        /// The change in counts.
        counts: f64,
    },
    /// The counts change in the other direction than in the starting glove.
    InvertedChannel {
        /// The index of the channel.
        channel: usize,
        /// The joint that it measures.
        dof: Dof,
    },
    /// Two channels measure each other's joints.
    SwappedChannels {
        /// The first channel and the joint of the glove file.
        first: (usize, Dof),
        /// The second channel and the joint of the glove file.
        second: (usize, Dof),
    },
    /// A channel follows another one while its own joint is still.
    CrossTalk {
        /// The index of the channel.
        channel: usize,
        /// The joint that it measures.
        dof: Dof,
        /// The channel that it follows, and its joint.
        source: (usize, Dof),
        /// The change of the channel for the range of the other one, as a fraction of its own range.
        fraction: f64,
    },
    /// A channel changed while the hand was still.
    Restless {
        /// The index of the channel.
        channel: usize,
        /// The joint that it measures.
        dof: Dof,
        /// The pose.
        pose: CalibrationPose,
    },
    /// The counts of a channel in the poses of its joint contradict each other.
    Erratic {
        /// The index of the channel.
        channel: usize,
        /// The joint that it measures.
        dof: Dof,
    },
    /// A joint keeps the values of the starting glove, because too few of its poses were observed.
    NotObserved {
        /// The joint.
        dof: Dof,
    },
    /// A joint was outside the range of motion in a pose.
    Implausible {
        /// The joint.
        dof: Dof,
        /// The pose.
        pose: CalibrationPose,
        /// The angle in degrees.
        degrees: f64,
    },
}

impl Problem {
    /// Returns the channel; `None` for a problem of two channels, or of a joint.
    const fn channel(&self) -> Option<usize> {
        match self {
            Self::DeadChannel { channel, .. }
            | Self::MissingChannel { channel, .. }
            | Self::SmallRange { channel, .. }
            | Self::InvertedChannel { channel, .. }
            | Self::CrossTalk { channel, .. }
            | Self::Restless { channel, .. }
            | Self::Erratic { channel, .. } => Some(*channel),
            Self::SwappedChannels { .. } | Self::NotObserved { .. } | Self::Implausible { .. } => {
                None
            }
        }
    }

    /// Returns the weight.
    pub fn severity(&self) -> Severity {
        match self {
            Self::CrossTalk { fraction, .. } if *fraction > MAX_CROSS_TALK => Severity::Unusable,
            Self::DeadChannel { .. }
            | Self::MissingChannel { .. }
            | Self::SwappedChannels { .. } => Severity::Unusable,
            Self::InvertedChannel { .. } => Severity::Corrected,
            Self::SmallRange { .. }
            | Self::CrossTalk { .. }
            | Self::Restless { .. }
            | Self::Erratic { .. }
            | Self::NotObserved { .. }
            | Self::Implausible { .. } => Severity::Inexact,
        }
    }

    /// Returns the joint that is worse for it; the first of two.
    pub const fn dof(&self) -> Dof {
        match self {
            Self::DeadChannel { dof, .. }
            | Self::MissingChannel { dof, .. }
            | Self::SmallRange { dof, .. }
            | Self::InvertedChannel { dof, .. }
            | Self::CrossTalk { dof, .. }
            | Self::Restless { dof, .. }
            | Self::Erratic { dof, .. }
            | Self::NotObserved { dof }
            | Self::Implausible { dof, .. } => *dof,
            Self::SwappedChannels { first, .. } => first.1,
        }
    }
}

/// Returns the messages of problems, each with its first problem. Channels of one finger with the same fault share a message: a glove
/// that sends one value for a finger has it in the channel of each joint.
pub fn problem_messages(problems: &[Problem]) -> Vec<(&Problem, String)> {
    let mut groups: Vec<Vec<&Problem>> = Vec::new();
    for problem in problems {
        let mut like = groups.iter_mut();
        match like.find(|group| has_same_fault(group[0], problem)) {
            Some(group) => group.push(problem),
            None => groups.push(vec![problem]),
        }
    }
    let groups = groups.iter();
    let with_messages = groups.map(|group| (group[0], group_message(group)));
    with_messages.collect()
}

/// Returns the message of problems with the same fault. There is at least one.
fn group_message(group: &[&Problem]) -> String {
    let others = group[1..].iter().filter_map(|other| other.channel());
    let others: Vec<String> = others.map(|channel| channel.to_string()).collect();
    match others.len() {
        0 => group[0].to_string(),
        1 => format!("{} (also channel {})", group[0], others[0]),
        _ => format!("{} (also channels {})", group[0], others.join(", ")),
    }
}

/// Returns `true` if the messages of two channels of one finger differ only in channel and joint.
fn has_same_fault(one: &Problem, other: &Problem) -> bool {
    let fault = |problem: &Problem| {
        let subject = format!("channel {} ({})", problem.channel()?, problem.dof());
        let message = problem.to_string();
        message.strip_prefix(&subject).map(str::to_owned)
    };
    let finger = one.dof().finger();
    finger.is_some()
        && finger == other.dof().finger()
        && fault(one).is_some_and(|words| Some(words) == fault(other))
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::DeadChannel {
                channel,
                dof,
                count,
            } => write!(
                f,
                "channel {channel} ({dof}) stays at {count:.0} in every pose: the sensor is dead; check its wires"
            ),
            Self::MissingChannel { channel, dof } => write!(
                f,
                "channel {channel} ({dof}) was not measured: the readings do not contain it; check the protocol and the glove file"
            ),
            Self::SmallRange {
                channel,
                dof,
                counts,
            } => write!(
                f,
                "channel {channel} ({dof}) changes by only {counts:.0} counts: one count is more than 5°; repeat the poses to the end of the movement, or check the resistor of the sensor"
            ),
            Self::InvertedChannel { channel, dof } => write!(
                f,
                "channel {channel} ({dof}) counts the other way than in the starting glove: its wires are exchanged; the calibration corrects it"
            ),
            Self::SwappedChannels { first, second } => write!(
                f,
                "channels {} ({}) and {} ({}) are swapped: each follows the joint of the other; exchange their plugs, or their numbers in the glove file",
                first.0, first.1, second.0, second.1
            ),
            Self::CrossTalk {
                channel,
                dof,
                source,
                fraction,
            } => write!(
                f,
                "channel {channel} ({dof}) follows channel {} ({}) by {:.0} % of its range: separate their wires, or fasten the sensor",
                source.0,
                source.1,
                fraction * 100.0
            ),
            Self::Restless { channel, dof, pose } => write!(
                f,
                "channel {channel} ({dof}) was not still in the pose `{pose}`: hold it longer, or check the wire"
            ),
            Self::Erratic { channel, dof } => write!(
                f,
                "channel {channel} ({dof}) does not follow its joint: its counts in the poses contradict each other; repeat the poses, or check its wires"
            ),
            Self::NotObserved { dof } => write!(
                f,
                "{dof} keeps its values: too few of its poses were taken; repeat the calibration without skipping them"
            ),
            Self::Implausible { dof, pose, degrees } => write!(
                f,
                "{dof} is at {degrees:.0}° in the pose `{pose}`, which no joint reaches: repeat the pose"
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_of_one_finger_with_one_fault_share_a_message() {
        let dead = |channel, dof, count| Problem::DeadChannel {
            channel,
            dof,
            count,
        };
        let inverted = Problem::InvertedChannel {
            channel: 24,
            dof: Dof::RingPipFlexion,
        };
        let problems = [
            dead(23, Dof::RingMcpFlexion, 85.0),
            inverted.clone(),
            dead(24, Dof::RingPipFlexion, 85.0),
            dead(25, Dof::RingDipFlexion, 85.0),
            dead(27, Dof::LittleMcpFlexion, 85.0),
            dead(28, Dof::LittlePipFlexion, 86.0),
            dead(4, Dof::WristFlexion, 85.0),
        ];
        let expected = [
            (
                &problems[0],
                format!("{} (also channels 24, 25)", problems[0]),
            ),
            (&inverted, inverted.to_string()),
            (&problems[4], problems[4].to_string()),
            (&problems[5], problems[5].to_string()),
            (&problems[6], problems[6].to_string()),
        ];
        assert_eq!(problem_messages(&problems), expected);
    }
}
