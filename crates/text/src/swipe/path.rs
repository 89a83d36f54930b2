//! The path of a finger over the keys.

use arrayvec::ArrayVec;

use crate::keyboard::Millimetres;

/// The most points of a path: 1.5 m, more than any word needs.
const MAX_POINTS: usize = 512;
/// The distance between two points of a path in mm.
const POINT_SPACING: f32 = 3.0;
/// The most samples of a path.
pub(super) const MAX_SAMPLES: usize = 64;
/// The fewest samples of a path.
const MIN_SAMPLES: usize = 8;
/// The distance between two samples in mm, if that needs no more than [`MAX_SAMPLES`].
const SAMPLE_SPACING: f32 = 8.0;

/// The path of a finger that stays on the keyboard, in millimetres, with points at least 3 mm apart.
#[derive(Clone, Debug, Default)]
pub struct SwipePath {
    points: ArrayVec<Millimetres, MAX_POINTS>,
}

impl SwipePath {
    /// Adds a point, unless it is near the last one. Returns `false` if the path is too long for a word.
    pub fn push(&mut self, point: Millimetres) -> bool {
        let last = self.points.last();
        if last.is_some_and(|&last| distance(last, point) < POINT_SPACING) {
            return true;
        }
        self.points.try_push(point).is_ok()
    }

    /// Returns the points.
    pub fn points(&self) -> &[Millimetres] {
        &self.points
    }
}

/// Points at equal distances along a path.
#[derive(Clone, Debug, Default)]
pub(super) struct Samples {
    pub points: ArrayVec<Millimetres, MAX_SAMPLES>,
    /// The direction of the path at each, of length 1.
    pub directions: ArrayVec<Millimetres, MAX_SAMPLES>,
    /// The distance between two of them in mm.
    pub spacing: f32,
}

impl Samples {
    /// Replaces the samples by the samples of another path. A path without length has no samples.
    pub fn set(&mut self, path: &[Millimetres]) {
        self.points.clear();
        self.directions.clear();
        let steps = || {
            path.windows(2)
                .map(|pair| (pair, distance(pair[0], pair[1])))
        };
        let length: f32 = steps().map(|(_, length)| length).sum();
        if !(length.is_finite() && length > 0.0) {
            return;
        }
        let count = ((length / SAMPLE_SPACING) as usize).clamp(MIN_SAMPLES, MAX_SAMPLES);
        self.spacing = length / (count - 1) as f32;
        let mut passed = 0.0;
        // Two equal points have no point between them.
        for (pair, step) in steps().filter(|&(_, step)| step > 0.0) {
            let next = |samples: &Self| samples.points.len() as f32 * samples.spacing;
            while self.points.len() < count - 1 && next(self) <= passed + step {
                let t = (next(self) - passed) / step;
                let point = |axis: usize| pair[0][axis] + t * (pair[1][axis] - pair[0][axis]);
                self.points.push([point(0), point(1)]);
            }
            passed += step;
        }
        if let Some(&last) = path.last() {
            self.points.push(last);
        }
        for index in 0..self.points.len() {
            let [before, after] = [index.saturating_sub(1), (index + 1).min(count - 1)];
            let along = direction(self.points[before], self.points[after]);
            self.directions.push(along);
        }
    }
}

/// Returns the distance of two points.
pub fn distance(left: Millimetres, right: Millimetres) -> f32 {
    (left[0] - right[0]).hypot(left[1] - right[1])
}

/// Returns the direction from a point to another one, of length 1, or 0 if they are the same.
pub(super) fn direction(from: Millimetres, to: Millimetres) -> Millimetres {
    let length = distance(from, to);
    if length > 0.0 {
        [(to[0] - from[0]) / length, (to[1] - from[1]) / length]
    } else {
        [0.0; 2]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_evenly_spaced_and_keep_both_ends() {
        let mut samples = Samples::default();
        samples.set(&[[0.0, 0.0], [70.0, 0.0], [70.0, 50.0]]);
        assert_eq!(samples.points.len(), 15);
        assert_eq!(samples.points[0], [0.0, 0.0]);
        assert_eq!(samples.points[14], [70.0, 50.0]);
        let along = |point: &Millimetres| point[0] + point[1];
        for pair in samples.points.windows(2) {
            assert!((along(&pair[1]) - along(&pair[0]) - 120.0 / 14.0).abs() < 1e-3);
        }
        samples.set(&[[1.0, 1.0]]);
        assert!(samples.points.is_empty());
        samples.set(&[[0.0, 0.0], [0.0, 0.0], [70.0, 0.0]]);
        assert_eq!(samples.points[0], [0.0, 0.0]);
    }

    #[test]
    fn a_finger_that_rests_adds_nothing_and_a_path_has_an_end() {
        let mut path = SwipePath::default();
        assert!(path.push([0.0; 2]) && path.push([1.0; 2]));
        assert_eq!(path.points().len(), 1);
        let is_full = (0..MAX_POINTS).any(|step| !path.push([4.0 * step as f32, 9.0]));
        assert!(is_full);
    }
}
