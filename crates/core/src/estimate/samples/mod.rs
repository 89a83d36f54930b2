//! Conversion of samples to estimates: one file per kind of sample.

mod angles;
mod body;
mod body_angles;
mod body_points;
mod bones;
mod channel_table;
mod channels;
mod displacement;
mod joints;

pub(super) use self::channels::ChannelConverter;

use std::time::Duration;

use super::plausibility::Plausibility;
use super::{ChannelMap, Estimate, EstimatorSettings, Rejection};
use crate::capture::{Reading, Sample};
use crate::hand::{BodyPoints, JointAngles, Side};

/// The lowest confidence of a landmark that is used, 0..=1: the lowest that the tasks of MediaPipe accept by default.
const MIN_CONFIDENCE: f32 = 0.5;

/// The time for which an arm keeps its last pose when its landmarks are not trusted: three frames of a camera. After that it is
/// lost, and its fingers release everything.
const LANDMARK_HOLD: Duration = Duration::from_millis(100);

/// The converter of one hand, with the state that the kinds of samples need.
#[derive(Clone, Debug)]
pub(super) struct SampleConverter {
    channels: Option<ChannelConverter>,
    joints: joints::JointConverter,
    body: body::BodyConverter,
    bones: bones::BoneConverter,
}

impl SampleConverter {
    /// Creates a converter for samples that need no channel map.
    pub(super) fn new() -> Self {
        Self {
            channels: None,
            joints: joints::JointConverter::default(),
            body: body::BodyConverter::default(),
            bones: bones::BoneConverter::default(),
        }
    }

    /// Sets the channel map for samples of sensor channels.
    pub(super) fn set_channel_map(&mut self, map: &ChannelMap, settings: &EstimatorSettings) {
        self.channels = Some(ChannelConverter::new(map, settings));
    }

    /// Returns the converter of sensor channels, if there is a channel map.
    pub(super) fn channels(&self) -> Option<&ChannelConverter> {
        self.channels.as_ref()
    }

    /// Returns the converter of sensor channels, to learn the ranges of its sensors.
    pub(super) fn channels_mut(&mut self) -> Option<&mut ChannelConverter> {
        self.channels.as_mut()
    }

    /// Returns `true` if the latest reading did not show an arm that was seen before, for longer than the hold time.
    pub(super) fn has_lost_arm(&self) -> bool {
        self.joints.has_lost_arm() || self.body.has_lost_arm() || self.bones.has_lost_arm()
    }

    /// Returns head and hip, if landmarks of a body show them.
    pub(super) fn body_points(&self) -> &BodyPoints {
        self.body.points()
    }

    /// Writes what a reading shows without its history into `estimate`: angles within the joint limits, not filtered.
    /// `offsets` are added to measured angles, in radians. Angles that are outside their range are noted in `plausibility`.
    pub(super) fn convert(
        &mut self,
        reading: &Reading,
        settings: &EstimatorSettings,
        offsets: &JointAngles,
        plausibility: &mut Plausibility,
        estimate: &mut Estimate,
    ) -> Result<(), Rejection> {
        match &reading.sample {
            Sample::Channels(channels) => {
                let converter = self.channels.as_mut().ok_or(Rejection::WrongShape)?;
                converter.convert(
                    channels,
                    settings.rail_timeout,
                    offsets,
                    plausibility,
                    estimate,
                )
            }
            Sample::Angles { angles } => {
                let limits = settings.limits.as_ref();
                angles::convert(angles, limits, offsets, plausibility, &mut estimate.angles)
            }
            Sample::Joints { positions } => {
                let side = reading.side.unwrap_or(Side::Right);
                self.joints.convert(positions, side, settings, estimate)
            }
            Sample::Body(body) => {
                let side = reading.side.unwrap_or(Side::Right);
                self.body.convert(body, side, settings, estimate)
            }
            Sample::Bones { bones } => {
                let side = reading.side.unwrap_or(Side::Right);
                let limits = settings.limits.as_ref();
                self.bones.convert(bones, side, limits, estimate)
            }
            Sample::Displacement { displacement } => displacement::convert(displacement, estimate),
        }
    }
}

#[cfg(test)]
mod tests;
