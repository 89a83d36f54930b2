//! The conversion of all channels of a glove at once, without a branch for each.

use crate::capture::Channels;
use crate::estimate::limits::JointRange;
use crate::estimate::{AffineMap, ChannelMap, JointLimits};
use crate::hand::{Dof, JointAngles};

/// The rows of a channel map as one list of numbers of each kind, by degree of freedom, which compilers vectorise.
///
/// The angles are those of the rows one by one, which take over when a channel is unknown or an angle is outside its limits.
#[derive(Clone, Debug)]
pub(super) struct ChannelTable {
    full_scale: f64,
    channels: [u8; Dof::COUNT],
    /// See [`Linearity`](crate::estimate::Linearity).
    bends: [f64; Dof::COUNT],
    gains: [f64; Dof::COUNT],
    offsets: [f64; Dof::COUNT],
    /// The ends of the ranges that are accepted. Every angle is, without a row.
    accepted: [[f64; Dof::COUNT]; 2],
    /// The ends of the ranges to which angles are clamped. Both are 0 without a row.
    limits: [[f64; Dof::COUNT]; 2],
    /// The degrees of freedom with a row.
    measured: JointAngles,
}

impl ChannelTable {
    /// Creates the table; `None` for a map without rows, or one that measures an angle twice.
    pub fn new(map: &ChannelMap, limits: Option<&JointLimits>) -> Option<Self> {
        let first = map.rows().first()?;
        let mut table = Self {
            full_scale: f64::from(map.full_scale()),
            channels: [u8::try_from(first.channel).ok()?; Dof::COUNT],
            bends: [0.0; Dof::COUNT],
            gains: [0.0; Dof::COUNT],
            offsets: [0.0; Dof::COUNT],
            accepted: JointRange::ANY.ends().map(|end| [end; Dof::COUNT]),
            limits: [[0.0; Dof::COUNT]; 2],
            measured: JointAngles::default(),
        };
        for row in map.rows() {
            if table.measured.is_known(row.dof) {
                return None;
            }
            let index = row.dof.index();
            let range = limits.map_or(JointRange::ANY, |limits| limits.joint_range(row.dof));
            table.channels[index] = u8::try_from(row.channel).ok()?;
            table.bends[index] = map.linearity(row.channel).bend();
            table.set_calibration(row.dof, row.calibration);
            let accepted = range.with_tolerance();
            for end in 0..2 {
                table.accepted[end][index] = accepted.ends()[end];
                table.limits[end][index] = range.ends()[end];
            }
            table.measured.set(row.dof, 0.0);
        }
        Some(table)
    }

    /// Replaces the calibration of the row that measures `dof`.
    pub fn set_calibration(&mut self, dof: Dof, calibration: AffineMap) {
        self.gains[dof.index()] = calibration.gain;
        self.offsets[dof.index()] = calibration.offset;
    }

    /// Returns the counts by degree of freedom, those of a row for one without.
    pub fn counts(&self, channels: &Channels) -> [u16; Dof::COUNT] {
        self.channels
            .map(|channel| channels.counts[usize::from(channel)])
    }

    /// Sets the angles that known counts show, with `offsets` added, in radians. Returns `false`, and leaves angles that mean
    /// nothing, if one is not finite or farther outside its range than a calibration error explains.
    pub fn convert(
        &self,
        counts: &[u16; Dof::COUNT],
        offsets: &JointAngles,
        angles: &mut JointAngles,
    ) -> bool {
        angles.set_known_as(&self.measured);
        let mut are_accepted = true;
        let [accepted_low, accepted_high] = &self.accepted;
        let [low, high] = &self.limits;
        for (index, angle) in angles.radians_mut().iter_mut().enumerate() {
            let count = f64::from(counts[index]);
            let linear = count - self.bends[index] * count * (self.full_scale - count);
            let calibrated = linear * self.gains[index] + self.offsets[index];
            let radians = calibrated + offsets.radians()[index];
            are_accepted &= (radians >= accepted_low[index]) & (radians <= accepted_high[index]);
            *angle = JointRange::new(low[index], high[index]).clamp(radians);
        }
        are_accepted
    }
}
