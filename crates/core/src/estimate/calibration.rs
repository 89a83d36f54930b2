//! Linear calibration: converts a raw sensor value into an angle.

/// The smallest and the largest count of a channel.
pub type CountRange = (f64, f64);

/// An affine map from a raw value to an angle: `angle = gain × value + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AffineMap {
    /// Angle per unit of the raw value.
    pub gain: f64,
    /// Angle at raw value 0.
    pub offset: f64,
}

impl AffineMap {
    /// The map that returns its argument.
    pub const IDENTITY: Self = Self {
        gain: 1.0,
        offset: 0.0,
    };

    /// Creates the map `initial + (counts + offset_counts) × gain`, the form used in glove files.
    pub fn from_counts(offset_counts: f64, gain: f64, initial: f64) -> Self {
        Self {
            gain,
            offset: offset_counts * gain + initial,
        }
    }

    /// Returns the angle for a raw value.
    pub fn apply(&self, value: f64) -> f64 {
        value * self.gain + self.offset
    }

    /// Returns the map that applies `first`, and then this one.
    pub fn after(&self, first: &Self) -> Self {
        Self {
            gain: self.gain * first.gain,
            offset: self.apply(first.offset),
        }
    }

    /// Returns the raw value for an angle; not finite if the gain is 0.
    pub fn apply_inverse(&self, angle: f64) -> f64 {
        (angle - self.offset) / self.gain
    }

    /// Fits the map to calibration poses, each a pair of raw value and known angle, by least squares.
    ///
    /// # Errors
    /// Fails with fewer than two poses, if all raw values are equal, or if a number is not finite.
    pub fn fit(poses: &[(f64, f64)]) -> Result<Self, FitError> {
        // The mean of equal values may differ from them by rounding.
        if poses.windows(2).all(|pair| pair[0].0 == pair[1].0) {
            return Err(FitError { poses: poses.len() });
        }
        let count = poses.len() as f64;
        let mean_value = poses.iter().map(|pose| pose.0).sum::<f64>() / count;
        let mean_angle = poses.iter().map(|pose| pose.1).sum::<f64>() / count;
        let variance: f64 = poses.iter().map(|pose| (pose.0 - mean_value).powi(2)).sum();
        if !(variance > 0.0 && variance.is_finite() && mean_angle.is_finite()) {
            return Err(FitError { poses: poses.len() });
        }
        let covariance: f64 = poses
            .iter()
            .map(|pose| (pose.0 - mean_value) * (pose.1 - mean_angle))
            .sum();
        let gain = covariance / variance;
        Ok(Self {
            gain,
            offset: mean_angle - gain * mean_value,
        })
    }
}

/// The calibration poses do not determine an affine map.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "cannot calibrate from {poses} poses: at least two with different readings are needed; bend the joint between them"
)]
pub struct FitError {
    /// The number of poses.
    pub poses: usize,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poses_with_equal_values_do_not_determine_a_map() {
        let error = AffineMap::fit(&[(100.0, 0.0), (100.0, 1.5)]).unwrap_err();
        assert!(error.to_string().contains("2 poses"));
        // The mean of three times 0.1 is 0.10000000000000002.
        assert!(AffineMap::fit(&[(0.1, 0.0), (0.1, 1.5), (0.1, 3.0)]).is_err());
        assert!(AffineMap::fit(&[]).is_err());
        assert!(AffineMap::fit(&[(0.0, f64::NAN), (1.0, 1.0)]).is_err());
    }

    #[test]
    fn the_inverse_undoes_the_map() {
        let map = AffineMap::from_counts(-25.0, 3.3 / 255.0, -0.8);
        assert!((map.apply_inverse(map.apply(100.0)) - 100.0).abs() < 1e-9);
    }
}
