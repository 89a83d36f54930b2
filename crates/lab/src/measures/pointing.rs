//! The multi-directional tapping test of ISO/TS 9241-411:2012, annex B: a ring of targets, and the figures of the clicks on them.

use serde::{Deserialize, Serialize};

/// A ring of targets, each movement to the next of which crosses it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    /// The number of targets: odd, so that the opposite one of each is another one.
    pub targets: usize,
    /// The center, in pixels.
    pub center: [f64; 2],
    /// The diameter, in pixels.
    pub diameter: f64,
    /// The diameter of a target, in pixels.
    pub width: f64,
}

impl Ring {
    /// Returns the center of the target of a click, in pixels. The order goes to the opposite side each time: a step of half of the
    /// ring meets every target.
    pub fn target(&self, click: usize) -> [f64; 2] {
        let place = click * self.targets.div_ceil(2) % self.targets;
        let angle = std::f64::consts::TAU * place as f64 / self.targets as f64;
        let radius = self.diameter / 2.0;
        [
            self.center[0] + radius * angle.sin(),
            self.center[1] - radius * angle.cos(),
        ]
    }
}

/// The figures of clicks on targets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PointingResult {
    /// Movements from one target to the next that ended with a click.
    pub targets: usize,
    /// Clicks beside their target.
    pub misses: usize,
    /// Mean time from one click to the next, in seconds.
    pub movement_s: f64,
    /// Straight distance from one click to the next by the length of the way, 0..=1: the mean.
    pub path_efficiency: f64,
    /// Distance of the way from the task axis, the line through the centers of both targets, in pixels: the mean over the length of a
    /// way, and the mean of the ways (movement error of MacKenzie, Kauppinen & Silfverberg 2001, Accuracy measures for evaluating
    /// computer pointing devices, doi 10.1145/365024.365028, who take the mean over equal times).
    pub axis_deviation_px: f64,
    /// Entries of a target after the first one and before the click, by movements (target re-entry of the same authors). A position of
    /// the pointer counts, and not the line between two of them.
    pub reentries: f64,
    /// Effective throughput in bits per second.
    pub throughput: f64,
}

/// A movement from one click to the next, in pixels of a screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Movement {
    /// The center of the target before.
    pub from: [f64; 2],
    /// The center of the target.
    pub to: [f64; 2],
    /// The click before, and the click.
    pub clicks: [[f64; 2]; 2],
    /// Length of the way of the pointer.
    pub way: f64,
    /// Mean distance of the way from the line through the centers of both targets.
    pub axis_deviation: f64,
    /// Entries of the target after the first one.
    pub reentries: usize,
    /// Time from one click to the next, in seconds.
    pub seconds: f64,
    /// `true` if the click is within the target.
    pub is_hit: bool,
}

/// Deviations in the effective width: √(2πe), the entropy of a normal distribution. Such a width holds 96 % of the clicks.
const WIDTH_IN_DEVIATIONS: f64 = 4.132_731;

/// Smallest deviation, in pixels: clicks at one pixel are rounded and deviate by 1/√12.
const MIN_DEVIATION: f64 = 0.289;

impl PointingResult {
    /// Scores movements; all figures are 0 without one, and the throughput with a single one, whose spread is unknown.
    ///
    /// The throughput follows ISO/TS 9241-411:2012, annex B, in the form of MacKenzie 2015 (Fitts' throughput and the remarkable case
    /// of touch-based target selection, doi 10.1007/978-3-319-20916-6_23) and of the program that comes with it, for a series of
    /// movements that start where the last one ended: log₂(Aₑ / Wₑ + 1) by the mean movement time, where Aₑ is the mean distance
    /// between two clicks along the axis from target to target, and Wₑ is √(2πe) times the sample standard deviation of the clicks
    /// along that axis. That program adds the deviation of the last click along its own axis to Aₑ; here the last click is projected
    /// on the present axis. The figures of several series are averaged after this computation, not before.
    pub fn new(movements: &[Movement]) -> Self {
        if movements.is_empty() {
            return Self::default();
        }
        let count = movements.len() as f64;
        let mean =
            |value: &dyn Fn(&Movement) -> f64| movements.iter().map(value).sum::<f64>() / count;
        let movement_s = mean(&|movement| movement.seconds);
        let deviation_of = |movement: &Movement| movement.along(movement.clicks[1], movement.to);
        let center = mean(&deviation_of);
        let squares = movements
            .iter()
            .map(|movement| (deviation_of(movement) - center).powi(2));
        let deviation = (squares.sum::<f64>() / (count - 1.0).max(1.0)).sqrt();
        let width = WIDTH_IN_DEVIATIONS * deviation.max(MIN_DEVIATION);
        let amplitude = mean(&|movement| movement.along(movement.clicks[1], movement.clicks[0]));
        let difficulty = (amplitude.max(0.0) / width + 1.0).log2();
        let efficiency = |movement: &Movement| {
            let straight = distance(movement.clicks[0], movement.clicks[1]);
            if movement.way > 0.0 {
                (straight / movement.way).min(1.0)
            } else {
                0.0
            }
        };
        Self {
            targets: movements.len(),
            misses: movements.iter().filter(|movement| !movement.is_hit).count(),
            movement_s,
            path_efficiency: mean(&efficiency),
            axis_deviation_px: mean(&|movement| movement.axis_deviation),
            reentries: mean(&|movement| movement.reentries as f64),
            // The smallest deviation would make one click the best of all.
            throughput: if movements.len() > 1 && movement_s > 0.0 {
                difficulty / movement_s
            } else {
                0.0
            },
        }
    }

    /// Returns the fraction of clicks beside their target, 0..=1.
    pub fn miss_rate(&self) -> f64 {
        self.misses as f64 / self.targets.max(1) as f64
    }
}

impl Movement {
    /// Returns how far `point` is beyond `origin` along the axis from target to target.
    fn along(&self, point: [f64; 2], origin: [f64; 2]) -> f64 {
        let axis = [self.to[0] - self.from[0], self.to[1] - self.from[1]];
        let length = axis[0].hypot(axis[1]);
        let offset = [point[0] - origin[0], point[1] - origin[1]];
        (offset[0] * axis[0] + offset[1] * axis[1]) / length.max(f64::MIN_POSITIVE)
    }
}

/// Returns the distance of two points.
pub fn distance(one: [f64; 2], other: [f64; 2]) -> f64 {
    (one[0] - other[0]).hypot(one[1] - other[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Movements along X between targets 300 px apart, whose clicks are off by these distances along and across the axis.
    fn movements(errors: &[[f64; 2]], seconds: f64) -> Vec<Movement> {
        let movement = |[along, across]: &[f64; 2]| Movement {
            from: [0.0, 0.0],
            to: [300.0, 0.0],
            clicks: [[0.0, 0.0], [300.0 + along, *across]],
            way: 600.0,
            axis_deviation: 0.0,
            reentries: 0,
            seconds,
            is_hit: along.hypot(*across) <= 20.0,
        };
        errors.iter().map(movement).collect()
    }

    #[test]
    fn each_movement_crosses_the_ring_and_every_target_is_met() {
        let ring = Ring {
            targets: 13,
            center: [0.0; 2],
            diameter: 100.0,
            width: 10.0,
        };
        let mut met: Vec<[i64; 2]> = (0..13)
            .map(|click| ring.target(click).map(|it| (it * 1e6) as i64))
            .collect();
        for click in 0..13 {
            let way = distance(ring.target(click), ring.target(click + 1));
            assert!(way > 98.0, "{way}");
        }
        met.sort();
        met.dedup();
        assert_eq!(met.len(), 13);
    }

    #[test]
    fn the_throughput_of_known_clicks_is_that_of_the_formula() {
        // A standard deviation of 10 px: We = 41.327 px, IDe = log2(300 / 41.327 + 1) = 3.0460 bits.
        let result =
            PointingResult::new(&movements(&[[-10.0, 0.0], [0.0, 25.0], [10.0, 0.0]], 0.5));
        assert!((result.throughput - 6.0920).abs() < 1e-3, "{result:?}");
        assert_eq!((result.targets, result.misses), (3, 1));
        assert_eq!(result.movement_s, 0.5);
        assert!((result.path_efficiency - 0.5).abs() < 0.01, "{result:?}");
        // Clicks that are spread wider transmit less; errors across the axis do not count.
        let wide = PointingResult::new(&movements(&[[-40.0, 0.0], [0.0, 0.0], [40.0, 0.0]], 0.5));
        assert!(wide.throughput < result.throughput, "{wide:?}");
    }

    #[test]
    fn no_movements_and_perfect_clicks_have_finite_figures() {
        assert_eq!(PointingResult::new(&[]), PointingResult::default());
        let perfect = PointingResult::new(&movements(&[[0.0, 0.0]; 5], 1.0));
        assert!(
            perfect.throughput.is_finite() && perfect.throughput > 7.0,
            "{perfect:?}"
        );
        let one = PointingResult::new(&movements(&[[0.0, 0.0]], 1.0));
        assert_eq!((one.targets, one.throughput), (1, 0.0));
        let resting = Movement {
            from: [0.0; 2],
            to: [0.0; 2],
            clicks: [[0.0; 2]; 2],
            way: 0.0,
            axis_deviation: 0.0,
            reentries: 0,
            seconds: 0.0,
            is_hit: false,
        };
        let result = PointingResult::new(&[resting]);
        assert!(
            result.throughput == 0.0 && result.path_efficiency == 0.0,
            "{result:?}"
        );
    }
}
