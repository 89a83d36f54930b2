//! The curvature of a sensor.
//!
//! A bend sensor whose resistance R grows with the angle, in a divider with a fixed resistor of `r` times its straight resistance
//! and a bent resistance of `q` times it, is above the line between the ends of its range by `(q − 1) / (2 (2r + 1 + q))` of the
//! range. Common bend sensors have q from 1.5 to 2.5; guides for them recommend r from 1 to 4.7. This gives 2 % to 14 %, and
//! less where the sensor is not bent to its end. Two poses do not show a curvature: then this expectation remains.

use super::weighted_line::Point;

/// The expected curvature of a bend sensor, as a fraction of its range.
const BEND_SENSOR: Prior = Prior {
    mean: 0.055,
    deviation: 0.03,
};

/// The expected curvature of a potentiometer, or of a sensor that its firmware makes linear.
const LINEAR_SENSOR: Prior = Prior {
    mean: 0.0,
    deviation: 0.02,
};

/// The largest difference from the expectation, in deviations: poses that demand more contradict each other for another reason.
const MAX_DEVIATIONS: f64 = 2.7;

/// The expectation of a curvature before any pose was seen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Prior {
    mean: f64,
    deviation: f64,
}

impl Prior {
    /// Returns the expectation for a sensor. The counts of a sensor with exchanged wires fall with its resistance, and bend the
    /// other way.
    pub(super) fn for_sensor(uses_full_range: bool, is_exchanged: bool) -> Self {
        let prior = if uses_full_range {
            LINEAR_SENSOR
        } else {
            BEND_SENSOR
        };
        let sign = if is_exchanged { -1.0 } else { 1.0 };
        Self {
            mean: sign * prior.mean,
            ..prior
        }
    }

    fn clamp(self, curvature: f64) -> f64 {
        let most = MAX_DEVIATIONS * self.deviation;
        curvature.clamp(self.mean - most, self.mean + most)
    }
}

/// Returns the curvature of a channel as a fraction of the range of its counts, from pairs of count and angle.
///
/// It is the maximum of the posterior: the expectation and the points, each with the weight of its deviation. Alternates between
/// the line for a curvature and the curvature for a line.
pub(super) fn estimate(points: &[Point], prior: Prior) -> f64 {
    let (low, high) = range(points);
    let span = high - low;
    let mut curvature = prior.mean;
    if span <= 0.0 {
        return 0.0;
    }
    for _ in 0..20 {
        let bow = |x: f64| 4.0 * (x - low) / span * (high - x) / span;
        let straight = points.iter().map(|point| Point {
            x: (point.x - low) / span - curvature * bow(point.x),
            ..*point
        });
        let straight: Vec<Point> = straight.collect();
        let Some(line) = super::weighted_line::fit_line(&straight) else {
            return prior.mean;
        };
        let (mut weights, mut sum) = (
            prior.deviation.powi(-2),
            prior.mean * prior.deviation.powi(-2),
        );
        for point in points {
            let fraction = (point.x - low) / span;
            // y = offset + gain × (fraction − curvature × bow)
            let effect = -line.map.gain * bow(point.x);
            let rest = point.y - line.map.apply(fraction);
            let weight = point.deviation.powi(-2);
            weights += weight * effect * effect;
            sum += weight * effect * rest;
        }
        curvature = prior.clamp(sum / weights);
    }
    curvature
}

/// Returns the curvature in counts over the full scale of a channel whose curvature is a fraction of its range.
pub(super) fn over_full_scale(curvature: f64, (low, high): (f64, f64), full_scale: f64) -> f64 {
    let span = high - low;
    // The parabola has one second derivative everywhere; `rest` is the part of the full scale that is not in the range.
    let rest = full_scale - low - high;
    let limit = crate::estimate::MAX_CURVATURE * full_scale;
    let divisor = span + 4.0 * curvature * rest;
    if divisor <= 0.0 {
        // No parabola that rises bends a small range near an end of the full scale that far.
        return limit.copysign(curvature);
    }
    let bend = 4.0 * curvature / divisor;
    (bend * full_scale * full_scale / 4.0).clamp(-limit, limit)
}

/// Returns the smallest and the largest count.
pub(super) fn range(points: &[Point]) -> (f64, f64) {
    points
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), point| {
            (low.min(point.x), high.max(point.x))
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::{Linearity, divider_voltage};

    fn point(x: f64, y: f64) -> Point {
        Point {
            x,
            y,
            deviation: 0.02,
        }
    }

    #[test]
    fn two_poses_leave_the_expectation_and_a_third_corrects_it() {
        let prior = Prior::for_sensor(false, false);
        let ends = [point(30.0, 0.0), point(130.0, 1.5)];
        assert!((estimate(&ends, prior) - 0.055).abs() < 1e-6);
        // At half of the angle, the count is above the middle by a tenth of the range.
        let bent = [ends[0], point(90.0, 0.75), ends[1]];
        let curvature = estimate(&bent, prior);
        assert!((0.08..0.11).contains(&curvature), "{curvature}");
    }

    #[test]
    fn the_divider_is_above_its_line_by_the_stated_fraction() {
        for (r, q) in [(1.0, 2.5), (2.2, 2.0), (4.7, 1.5)] {
            let volt = |resistance: f64| divider_voltage(r, resistance, 1.0);
            let (low, high) = (volt(1.0), volt(q));
            let middle = volt((1.0 + q) / 2.0);
            let above = (middle - (low + high) / 2.0) / (high - low);
            let stated: f64 = (q - 1.0) / (2.0 * (2.0 * r + 1.0 + q));
            assert!((above - stated).abs() < 1e-9, "{above} {stated}");
        }
    }

    #[test]
    fn a_curvature_of_a_range_is_the_same_over_the_full_scale() {
        for (curvature, low, high) in [
            (0.06, 40.0, 220.0),
            (-0.04, 30.0, 200.0),
            (0.08, 60.0, 240.0),
        ] {
            let counts = over_full_scale(curvature, (low, high), 255.0);
            let line = Linearity::new(counts, 255);
            let (first, last) = (line.apply(low), line.apply(high));
            for fraction in [0.25, 0.5, 0.75] {
                let found = (line.apply(low + fraction * (high - low)) - first) / (last - first);
                let expected = fraction - curvature * 4.0 * fraction * (1.0 - fraction);
                assert!((found - expected).abs() < 1e-9, "{found} {expected}");
            }
        }
    }
}
