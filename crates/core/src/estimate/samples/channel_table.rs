//! The conversion of all channels of a glove at once, without a branch for each.

use crate::capture::{Channels, MAX_CHANNELS};
use crate::estimate::limits::JointRange;
use crate::estimate::{AffineMap, ChannelMap, JointLimits};
use crate::hand::{Dof, JointAngles};

/// The rows of a channel map as one list of numbers of each kind, by degree of freedom, which compilers vectorise.
///
/// The angles equal the angles of the single rows, which take over when a channel is unknown or an angle is outside its limits.
// Aligned to vector registers, as the angles are.
#[derive(Clone, Debug)]
#[repr(C, align(16))]
pub(super) struct ChannelTable {
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
    channels: [u8; Dof::COUNT],
    full_scale: f64,
}

/// The result of a conversion.
pub(super) struct Conversion {
    /// `true` if all angles are finite, and none is farther outside its range than a calibration error explains.
    pub are_accepted: bool,
    /// `true` if a channel is unknown, or at an end of its range.
    pub has_exceptions: bool,
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

    /// Sets the angles that the counts show, with `offsets` added, in radians. The angles are valid only if the result
    /// states that all are accepted and no channel is unknown.
    pub fn convert(
        &self,
        channels: &Channels,
        offsets: &JointAngles,
        angles: &mut JointAngles,
    ) -> Conversion {
        angles.set_known_as(&self.measured);
        // An array of fixed length needs no check of an index, which would keep the loop from being vectorised.
        let mut counts = [0; MAX_CHANNELS];
        counts[..channels.counts.len()].copy_from_slice(&channels.counts);
        let (mut accepted, mut plain) = (0, 0);
        let [accepted_low, accepted_high] = &self.accepted;
        let [low, high] = &self.limits;
        for (index, angle) in angles.radians_mut().iter_mut().enumerate() {
            let count = f64::from(counts[usize::from(self.channels[index]) % MAX_CHANNELS]);
            let linear = count - self.bends[index] * count * (self.full_scale - count);
            let calibrated = linear * self.gains[index] + self.offsets[index];
            let radians = calibrated + offsets.radians()[index];
            let is_accepted = (radians >= accepted_low[index]) & (radians <= accepted_high[index]);
            // A sum has the width of the numbers, unlike a `bool`.
            accepted += u64::from(is_accepted);
            plain += u64::from((count > 0.0) & (count < self.full_scale));
            *angle = JointRange::new(low[index], high[index]).clamp(radians);
        }
        Conversion {
            are_accepted: accepted == Dof::COUNT as u64,
            has_exceptions: plain != Dof::COUNT as u64,
        }
    }
}
