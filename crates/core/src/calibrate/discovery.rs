//! Discovery: the joint that each channel of an unknown glove measures.
//!
//! Each joint has two poses that differ in it. A channel belongs to the joint between whose poses it changes most. Channels of one
//! finger change together, as the poses bend all joints of a finger: they are assigned from the knuckle outwards in the
//! order of their indices. Channels that no packet carries, and channels that repeat another one, are ignored.

use super::error::CalibrationError;
use super::fingers;
use super::observation::Observations;
use super::pose::CalibrationPose as Pose;
use crate::estimate::{AffineMap, ChannelRow};
use crate::hand::{Dof, Finger};

/// The smallest change of a channel that counts as a movement, as a fraction of the full scale.
const MIN_CHANGE: f64 = 0.06;

/// The largest change between the poses of another joint, as a fraction of the change between its own. Fingers have a
/// [limit of their own](fingers::MAX_OTHER).
const MAX_OTHER: f64 = 0.7;

/// The poses of a discovery, in order.
pub const DISCOVERY_POSES: &[Pose] = &[
    Pose::Flat,
    Pose::Spread,
    Pose::ThumbBent,
    Pose::IndexBent,
    Pose::MiddleBent,
    Pose::RingBent,
    Pose::LittleBent,
    Pose::WristUp,
    Pose::WristDown,
    Pose::WristIn,
    Pose::WristOut,
    Pose::PalmDown,
    Pose::PalmUp,
    Pose::ElbowStraight,
    Pose::ElbowBent,
];

/// The joints of the channels of an unknown glove.
#[derive(Clone, Debug, PartialEq)]
pub struct Discovery {
    /// A row for each joint that was found, in the order of [`Dof::ALL`].
    pub rows: Vec<ChannelRow>,
    /// Channels that move with several parts of the hand, with the spread fingers, or with more joints than a finger has.
    pub unclear: Vec<usize>,
}

/// A part of the hand that moves between two poses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Finger(Finger),
    Joint(Dof),
    /// The abduction of the fingers, which spread together.
    Spread,
}

/// The parts, each with the poses between which it moves.
const PARTS: [(Part, Pose, Pose); 10] = [
    (Part::Spread, Pose::Flat, Pose::Spread),
    (Part::Finger(Finger::Thumb), Pose::Flat, Pose::ThumbBent),
    (Part::Finger(Finger::Index), Pose::Flat, Pose::IndexBent),
    (Part::Finger(Finger::Middle), Pose::Flat, Pose::MiddleBent),
    (Part::Finger(Finger::Ring), Pose::Flat, Pose::RingBent),
    (Part::Finger(Finger::Little), Pose::Flat, Pose::LittleBent),
    (
        Part::Joint(Dof::WristFlexion),
        Pose::WristUp,
        Pose::WristDown,
    ),
    (
        Part::Joint(Dof::WristDeviation),
        Pose::WristIn,
        Pose::WristOut,
    ),
    (
        Part::Joint(Dof::ForearmSupination),
        Pose::PalmDown,
        Pose::PalmUp,
    ),
    (
        Part::Joint(Dof::ElbowFlexion),
        Pose::ElbowStraight,
        Pose::ElbowBent,
    ),
];

/// Returns the joint of each channel, with counts up to `full_scale`.
///
/// # Errors
/// Fails if no channel follows the index finger, without which nothing can be typed, or if a pose was skipped that shows it.
pub fn discover(
    observations: &Observations,
    full_scale: u16,
) -> Result<Discovery, CalibrationError> {
    for pose in [Pose::Flat, Pose::IndexBent] {
        if observations.get(pose).is_none() {
            return Err(CalibrationError::PoseSkipped { pose });
        }
    }
    let mut discovery = Discovery {
        rows: Vec::new(),
        unclear: Vec::new(),
    };
    let mut found: Vec<(Part, Vec<usize>)> = Vec::new();
    for channel in channels(observations) {
        match part(observations, channel, f64::from(full_scale)) {
            Some(Ok(part)) => match found.iter_mut().find(|(other, _)| *other == part) {
                Some((_, channels)) => channels.push(channel),
                None => found.push((part, vec![channel])),
            },
            Some(Err(())) => discovery.unclear.push(channel),
            None => {}
        }
    }
    if !found
        .iter()
        .any(|(part, _)| *part == Part::Finger(Finger::Index))
    {
        return Err(CalibrationError::NoIndexFinger);
    }
    for (part, channels) in &found {
        discovery.add(*part, channels, observations);
    }
    discovery.rows.sort_by_key(|row| row.dof);
    discovery.unclear.sort_unstable();
    Ok(discovery)
}

/// Returns the channels that were measured in the first pose. A channel that repeats another one is left out: a glove that sends one
/// value for a finger has it in the channel of each joint.
fn channels(observations: &Observations) -> Vec<usize> {
    let first = observations.poses().first();
    let measured = first.into_iter().flat_map(|pose| &pose.channels);
    let mut channels: Vec<usize> = Vec::new();
    for channel in measured.map(|channel| channel.channel) {
        let repeats = |other: &usize| {
            let mut poses = observations.poses().iter();
            poses.all(|pose| pose.median(*other) == pose.median(channel))
        };
        if observations.is_sent(channel) && !channels.iter().any(repeats) {
            channels.push(channel);
        }
    }
    channels
}

/// Returns the part of the hand that a channel follows: `None` for a channel that does not change, and an error for a channel that
/// follows several parts.
fn part(observations: &Observations, channel: usize, full_scale: f64) -> Option<Result<Part, ()>> {
    let mut changes: Vec<(Part, f64)> = PARTS
        .iter()
        .filter_map(|&(part, from, to)| {
            Some((part, change(observations, channel, from, to)?.abs()))
        })
        .collect();
    changes.sort_by(|a, b| b.1.total_cmp(&a.1));
    let (part, largest) = *changes.first()?;
    if largest < MIN_CHANGE * full_scale {
        return None;
    }
    let is_clear = changes[1..].iter().all(|(other, change)| {
        let are_fingers = matches!((part, other), (Part::Finger(_), Part::Finger(_)));
        let limit = if are_fingers {
            fingers::MAX_OTHER
        } else {
            MAX_OTHER
        };
        *change <= limit * largest
    });
    Some(if is_clear { Ok(part) } else { Err(()) })
}

fn change(observations: &Observations, channel: usize, from: Pose, to: Pose) -> Option<f64> {
    let median = |pose| observations.get(pose)?.median(channel);
    Some(median(to)? - median(from)?)
}

impl Discovery {
    /// Adds the rows of a part with these channels, in ascending order.
    fn add(&mut self, part: Part, channels: &[usize], observations: &Observations) {
        let Some(&(_, from, to)) = PARTS.iter().find(|(other, ..)| *other == part) else {
            return;
        };
        let groups: Vec<&[Dof]> = match part {
            Part::Joint(Dof::WristFlexion) => vec![&[Dof::WristFlexion]],
            Part::Joint(Dof::WristDeviation) => vec![&[Dof::WristDeviation]],
            Part::Joint(Dof::ForearmSupination) => vec![&[Dof::ForearmSupination]],
            Part::Joint(_) => vec![&[Dof::ElbowFlexion]],
            Part::Spread => Vec::new(),
            Part::Finger(finger) => joints(flexions(finger), channels.len()),
        };
        self.unclear.extend(channels.iter().skip(groups.len()));
        for (&channel, dofs) in channels.iter().zip(groups) {
            let median = |pose: Pose| observations.get(pose)?.median(channel);
            let (Some(start), Some(end)) = (median(from), median(to)) else {
                continue;
            };
            for &dof in dofs {
                let (low, high) = (from.expected(dof).radians, to.expected(dof).radians);
                let gain = (high - low) / (end - start);
                self.rows.push(ChannelRow {
                    label: channel.to_string(),
                    dof,
                    channel,
                    calibration: AffineMap::from_counts(-start, gain, low),
                });
            }
        }
    }
}

/// Returns the flexions of a finger, from the knuckle outwards.
fn flexions(finger: Finger) -> &'static [Dof] {
    let first = Dof::ALL
        .iter()
        .position(|dof| dof.finger() == Some(finger))
        .unwrap_or(0);
    &Dof::ALL[first + 1..first + 4]
}

/// Distributes the joints of a finger over a number of channels: the last channel spans the joints that are left.
fn joints(flexions: &'static [Dof], channels: usize) -> Vec<&'static [Dof]> {
    match channels {
        0 => Vec::new(),
        1 => vec![flexions],
        2 => vec![&flexions[..1], &flexions[1..]],
        _ => flexions.chunks(1).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate::{ChannelObservation, PoseObservation};

    /// Returns observations of a glove whose channels follow these functions of the pose.
    fn observe(channels: &[&dyn Fn(Pose) -> f64]) -> Observations {
        let mut observations = Observations::default();
        for &pose in DISCOVERY_POSES {
            let observe = |(channel, counts): (usize, &&dyn Fn(Pose) -> f64)| ChannelObservation {
                channel,
                median: counts(pose),
                low: counts(pose),
                high: counts(pose),
                is_still: true,
                is_sent: true,
            };
            observations.insert(PoseObservation {
                pose,
                channels: channels.iter().enumerate().map(observe).collect(),
            });
        }
        observations
    }

    #[test]
    fn channels_are_assigned_to_the_joints_that_they_follow() {
        let bent = |finger: Finger, from: f64, to: f64| {
            move |pose: Pose| {
                if pose.bent_finger() == Some(finger) {
                    to
                } else {
                    from
                }
            }
        };
        let wrist = |pose: Pose| match pose {
            Pose::WristUp => 40.0,
            Pose::WristDown => 200.0,
            _ => 120.0,
        };
        let observations = observe(&[
            &|_| 7.0,
            &bent(Finger::Index, 50.0, 150.0),
            &bent(Finger::Index, 180.0, 60.0),
            &bent(Finger::Thumb, 20.0, 90.0),
            &wrist,
            &|pose| if pose == Pose::Flat { 10.0 } else { 90.0 },
            &|pose| if pose == Pose::Spread { 90.0 } else { 10.0 },
        ]);
        let discovery = discover(&observations, 255).unwrap();
        let rows: Vec<(usize, Dof)> = discovery
            .rows
            .iter()
            .map(|row| (row.channel, row.dof))
            .collect();
        assert_eq!(
            rows,
            [
                (4, Dof::WristFlexion),
                (3, Dof::ThumbCmcFlexion),
                (3, Dof::ThumbMcpFlexion),
                (3, Dof::ThumbIpFlexion),
                (1, Dof::IndexMcpFlexion),
                (2, Dof::IndexPipFlexion),
                (2, Dof::IndexDipFlexion),
            ]
        );
        assert_eq!(discovery.unclear, [5, 6]);
        let pip = &discovery.rows[5];
        assert!(pip.calibration.apply(180.0).abs() < 1e-9);
        assert!((pip.calibration.apply(60.0).to_degrees() - 100.0).abs() < 1e-9);
    }

    #[test]
    fn a_finger_that_bends_with_its_neighbor_is_found() {
        let bent = |own: Finger, neighbor: Finger| {
            move |pose: Pose| match pose.bent_finger() {
                Some(finger) if finger == own => 180.0,
                Some(finger) if finger == neighbor => 150.0,
                _ => 50.0,
            }
        };
        let observations = observe(&[
            &bent(Finger::Index, Finger::Middle),
            &bent(Finger::Ring, Finger::Little),
            &bent(Finger::Little, Finger::Ring),
        ]);
        let discovery = discover(&observations, 255).unwrap();
        assert!(discovery.unclear.is_empty(), "{discovery:?}");
        let channels: Vec<usize> = discovery.rows.iter().map(|row| row.channel).collect();
        assert_eq!(channels, [0, 0, 0, 1, 1, 1, 2, 2, 2]);
    }

    #[test]
    fn a_glove_without_a_sensor_of_the_index_finger_is_refused() {
        let observations = observe(&[&|_| 7.0]);
        let error = discover(&observations, 255).unwrap_err();
        assert!(error.to_string().contains("index finger"), "{error}");
    }

    #[test]
    fn a_skipped_pose_of_the_index_finger_is_named() {
        for pose in [Pose::Flat, Pose::IndexBent] {
            let mut observations = observe(&[&|_| 7.0]);
            observations.remove(pose);
            let error = discover(&observations, 255).unwrap_err();
            assert_eq!(error, CalibrationError::PoseSkipped { pose });
        }
    }
}
