//! The correction of a curved sensor.

/// A map from the counts of a curved sensor to linear counts: `count − bend × count × (full scale − count)`.
///
/// It is 0 at 0 and the full scale at the full scale. A bend sensor in a voltage divider is such a sensor: the voltage rises more
/// slowly than the resistance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linearity {
    bend: f64,
    full_scale: f64,
}

impl Linearity {
    /// Creates the map of a sensor that is `counts` above the line in the middle of its full scale.
    pub fn new(counts: f64, full_scale: u16) -> Self {
        let full_scale = f64::from(full_scale);
        Self {
            bend: 4.0 * counts / (full_scale * full_scale),
            full_scale,
        }
    }

    /// Returns `bend` of the formula.
    pub(super) fn bend(&self) -> f64 {
        self.bend
    }

    /// Returns the linear count for a count of the sensor. Both are equal for a sensor without curvature.
    pub fn apply(&self, count: f64) -> f64 {
        count - self.bend * count * (self.full_scale - count)
    }

    /// Returns the count of the sensor for a linear count.
    pub fn apply_inverse(&self, linear: f64) -> f64 {
        if self.bend == 0.0 {
            return linear;
        }
        let slope = 1.0 - self.bend * self.full_scale;
        let root = (slope * slope + 4.0 * self.bend * linear).max(0.0).sqrt();
        // The stable form of the root of bend × count² + slope × count − linear.
        2.0 * linear / (slope + root)
    }
}

/// Returns the voltage of a bend sensor R2 to ground in a divider with the fixed resistor R1 to the supply: Vx = R2 · V / (R1 + R2).
/// Both resistances have the same unit, 0 or more, and not both are 0.
pub fn divider_voltage(fixed_resistance: f64, sensor_resistance: f64, supply_volt: f64) -> f64 {
    sensor_resistance * supply_volt / (fixed_resistance + sensor_resistance)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_sensor_is_not_changed() {
        let straight = Linearity::new(0.0, 255);
        for count in [0.0, 1.0, 99.0, 254.0, 255.0] {
            assert_eq!(straight.apply(count), count);
            assert_eq!(straight.apply_inverse(count), count);
        }
    }

    #[test]
    fn a_curved_sensor_is_corrected_most_in_the_middle() {
        for curvature in [-51.0, -3.0, 20.0, 51.0] {
            let curved = Linearity::new(curvature, 255);
            assert_eq!(curved.apply(0.0), 0.0);
            assert!((curved.apply(255.0) - 255.0).abs() < 1e-9);
            assert!((curved.apply(127.5) - (127.5 - curvature)).abs() < 1e-9);
            for count in 0..255 {
                let count = f64::from(count);
                let linear = curved.apply(count);
                assert!(curved.apply(count + 1.0) > linear, "{curvature} {count}");
                assert!((curved.apply_inverse(linear) - count).abs() < 1e-9);
            }
        }
    }
}
