//! Weighted least squares: the line through uncertain points.

use crate::estimate::AffineMap;

/// A point with the standard deviation of its y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Point {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) deviation: f64,
}

impl Point {
    fn weight(&self) -> f64 {
        self.deviation.powi(-2)
    }
}

/// A line and its misfit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Line {
    pub(super) map: AffineMap,
    /// The sum of the squared residuals in units of the deviations.
    pub(super) misfit: f64,
    /// As [`misfit`](Self::misfit), for the best constant instead of a line: how much the points demand a slope.
    pub(super) constant_misfit: f64,
}

/// Returns the line through points, or `None` for no points. Points with one x have the slope 0.
pub(super) fn fit_line(points: &[Point]) -> Option<Line> {
    let sum = |value: &dyn Fn(&Point) -> f64| {
        let weighted = points.iter().map(|point| point.weight() * value(point));
        weighted.sum::<f64>()
    };
    let total = sum(&|_| 1.0);
    if total.is_nan() || total <= 0.0 {
        return None;
    }
    let (x, y) = (sum(&|point| point.x) / total, sum(&|point| point.y) / total);
    let xx = sum(&|point| (point.x - x).powi(2));
    let xy = sum(&|point| (point.x - x) * (point.y - y));
    let yy = sum(&|point| (point.y - y).powi(2));
    let gain = if xx > 1e-9 * total { xy / xx } else { 0.0 };
    Some(Line {
        map: AffineMap {
            gain,
            offset: y - gain * x,
        },
        misfit: (yy - gain * xy).max(0.0),
        constant_misfit: yy,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_passes_nearer_to_the_more_certain_points() {
        let point = |x, y, deviation| Point { x, y, deviation };
        let line = fit_line(&[
            point(0.0, 0.0, 0.1),
            point(1.0, 1.0, 0.1),
            point(2.0, 5.0, 10.0),
        ]);
        let line = line.unwrap();
        assert!((line.map.gain - 1.0).abs() < 0.01, "{line:?}");
        assert!(line.misfit < 0.1 && line.constant_misfit > 40.0, "{line:?}");
        assert_eq!(fit_line(&[]), None);
        let flat = fit_line(&[point(3.0, 1.0, 1.0), point(3.0, 2.0, 1.0)]).unwrap();
        assert_eq!(
            flat.map,
            AffineMap {
                gain: 0.0,
                offset: 1.5
            }
        );
    }
}
