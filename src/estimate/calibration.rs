//! From a reading to an angle: straight lines, and how they are found.

/// A straight line from a reading to an angle: `angle = reading × factor + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AffineMap {
    /// Angle per count.
    pub gain: f64,
    /// Angle at reading 0.
    pub offset: f64,
}

impl AffineMap {
    /// The line that is written as `initial + (reading + offset_counts) × factor`.
    pub fn from_counts(offset_counts: f64, factor: f64, initial: f64) -> Self {
        Self {
            gain: factor,
            offset: offset_counts * factor + initial,
        }
    }

    /// The angle of a reading, in the unit of the line.
    pub fn apply(&self, reading: f64) -> f64 {
        reading * self.gain + self.offset
    }

    /// The reading that gives `angle`; not finite for a line of factor 0.
    pub fn apply_inverse(&self, angle: f64) -> f64 {
        (angle - self.offset) / self.gain
    }

    /// The line that comes nearest to known poses, `(reading, angle)`, by least squares.
    ///
    /// Needs two poses with different readings.
    pub fn fit(poses: &[(f64, f64)]) -> Result<Self, FitError> {
        let count = poses.len() as f64;
        let mean_reading = poses.iter().map(|pose| pose.0).sum::<f64>() / count;
        let mean_angle = poses.iter().map(|pose| pose.1).sum::<f64>() / count;
        let spread: f64 = poses
            .iter()
            .map(|pose| (pose.0 - mean_reading).powi(2))
            .sum();
        if !(spread > 0.0 && spread.is_finite() && mean_angle.is_finite()) {
            return Err(FitError { poses: poses.len() });
        }
        let shared: f64 = poses
            .iter()
            .map(|pose| (pose.0 - mean_reading) * (pose.1 - mean_angle))
            .sum();
        let factor = shared / spread;
        Ok(Self {
            gain: factor,
            offset: mean_angle - factor * mean_reading,
        })
    }
}

/// No line goes through the poses.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "cannot calibrate from {poses} poses: at least two with different readings are needed; bend the joint between them"
)]
pub struct FitError {
    /// How many poses there were.
    pub poses: usize,
}

/// The resistance of a bend sensor, from the voltage at its divider.
///
/// The sensor lies between the tap and ground, `fixed_resistance` between the supply and the tap:
/// R2 = R1 · Vx / (V − Vx), in the unit of R1. Infinite or negative when the tap is at or above the
/// supply, as with a broken wire.
pub fn divider_resistance(fixed_resistance: f64, supply_volt: f64, tap_volt: f64) -> f64 {
    fixed_resistance * tap_volt / (supply_volt - tap_volt)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_poses_with_one_reading_give_no_line() {
        let error = AffineMap::fit(&[(100.0, 0.0), (100.0, 1.5)]).unwrap_err();
        assert!(error.to_string().contains("2 poses"));
        assert!(AffineMap::fit(&[]).is_err());
        assert!(AffineMap::fit(&[(0.0, f64::NAN), (1.0, 1.0)]).is_err());
    }

    #[test]
    fn a_line_and_its_inverse_agree() {
        let line = AffineMap::from_counts(-25.0, 3.3 / 255.0, -0.8);
        assert!((line.apply_inverse(line.apply(100.0)) - 100.0).abs() < 1e-9);
    }
}
