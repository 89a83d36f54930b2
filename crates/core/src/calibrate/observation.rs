//! Observations: what each channel showed in each pose.

use super::pose::CalibrationPose;
use crate::estimate::ChannelMap;
use crate::hand::{Dof, JointAngles};

/// The counts of one channel while a pose was held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelObservation {
    /// The index of the channel.
    pub channel: usize,
    /// The median, which a spike does not move.
    pub median: f64,
    /// The 10th percentile.
    pub low: f64,
    /// The 90th percentile.
    pub high: f64,
    /// `false` if the channel changed while the others were still.
    pub is_still: bool,
    /// `false` if no packet carried the channel, which then has the counts of a sensor at rest.
    pub is_sent: bool,
}

/// The counts of all channels while a pose was held.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseObservation {
    /// The pose.
    pub pose: CalibrationPose,
    /// The channels, in the order of their indices.
    pub channels: Vec<ChannelObservation>,
}

impl PoseObservation {
    /// Returns the observation of a channel, or `None` if it was not measured.
    pub fn channel(&self, channel: usize) -> Option<&ChannelObservation> {
        self.channels
            .iter()
            .find(|observation| observation.channel == channel)
    }

    /// Returns the median of a channel, or `None` if it was not measured.
    pub fn median(&self, channel: usize) -> Option<f64> {
        self.channel(channel).map(|observation| observation.median)
    }
}

/// The observations of a calibration: the poses that were held.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Observations {
    poses: Vec<PoseObservation>,
}

impl Observations {
    /// Adds a pose, in place of an earlier observation of it.
    pub fn insert(&mut self, observation: PoseObservation) {
        self.remove(observation.pose);
        self.poses.push(observation);
    }

    /// Removes a pose.
    pub fn remove(&mut self, pose: CalibrationPose) {
        self.poses.retain(|other| other.pose != pose);
    }

    /// Returns the observations without the poses that bend one finger alone. Those tell the fingers apart, and are no measure of a
    /// joint: the neighbors of a bent finger bend with it in part, as if their sensors followed it.
    #[must_use]
    pub fn without_single_fingers(&self) -> Self {
        let poses = self.poses.iter();
        let poses = poses.filter(|observed| observed.pose.bent_finger().is_none());
        Self {
            poses: poses.cloned().collect(),
        }
    }

    /// Returns the poses in the order in which they were held.
    pub fn poses(&self) -> &[PoseObservation] {
        &self.poses
    }

    /// Returns the observation of a pose, or `None` if it was skipped.
    pub fn get(&self, pose: CalibrationPose) -> Option<&PoseObservation> {
        self.poses.iter().find(|other| other.pose == pose)
    }

    /// Returns `false` for a channel of which all poses show that the glove does not have it.
    pub fn is_sent(&self, channel: usize) -> bool {
        let mut observed = self.poses.iter().filter_map(|pose| pose.channel(channel));
        observed.clone().next().is_none() || observed.any(|it| it.is_sent)
    }

    /// Returns the smallest and the largest median of a channel over all poses: its range without spikes. `None` if it was
    /// not measured.
    pub fn range(&self, channel: usize) -> Option<(f64, f64)> {
        let medians = self.poses.iter().filter_map(|pose| pose.median(channel));
        medians.fold(None, |range, median| {
            let (low, high) = range.unwrap_or((median, median));
            Some((median.min(low), median.max(high)))
        })
    }
}

/// Returns the angles of the hand in the pose [`Rest`](CalibrationPose::Rest), but only of its fingers: the arm may lie anywhere.
/// None are known if that pose was skipped.
pub fn rest_pose(observations: &Observations, map: &ChannelMap) -> JointAngles {
    let mut angles = JointAngles::default();
    let Some(rest) = observations.get(CalibrationPose::Rest) else {
        return angles;
    };
    for row in map
        .rows()
        .iter()
        .filter(|row| observations.is_sent(row.channel))
    {
        let is_of_hand = row.dof.finger().is_some()
            || matches!(row.dof, Dof::WristFlexion | Dof::WristDeviation);
        if let Some(count) = rest.median(row.channel)
            && is_of_hand
        {
            angles.set(row.dof, map.radians(row, count));
        }
    }
    angles
}
