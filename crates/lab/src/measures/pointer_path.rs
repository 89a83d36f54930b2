//! The way of a pointer from one click to the next.

use super::pointing::{Movement, Ring, distance};

/// The way of a pointer from one click to the next, position by position, in pixels of a screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointerPath {
    /// The center of the target before.
    from: [f64; 2],
    /// The center of the target.
    to: [f64; 2],
    /// The radius of the target.
    radius: f64,
    /// The click before.
    start: [f64; 2],
    /// The position so far.
    place: [f64; 2],
    length: f64,
    /// The integral of the distance from the task axis over the length of the way.
    area: f64,
    /// The times that the pointer was at a position within the target after one that was not; the start counts if it is within.
    entries: usize,
}

impl PointerPath {
    /// Begins the way to the target of a click of a ring, at the place of the click before.
    pub fn new(ring: &Ring, click: usize, start: [f64; 2]) -> Self {
        let to = ring.target(click);
        let radius = ring.width / 2.0;
        Self {
            from: ring.target(click.saturating_sub(1)),
            to,
            radius,
            start,
            place: start,
            length: 0.0,
            area: 0.0,
            entries: usize::from(distance(start, to) <= radius),
        }
    }

    /// Goes straight to the next position.
    pub fn go_to(&mut self, place: [f64; 2]) {
        let step = distance(self.place, place);
        let [before, after] = [self.place, place].map(|it| self.beside_axis(it));
        self.length += step;
        self.area += step * mean_distance(before, after);
        let is_within = |point| distance(point, self.to) <= self.radius;
        self.entries += usize::from(is_within(place) && !is_within(self.place));
        self.place = place;
    }

    /// Ends with a click at the present position, a time in seconds after the click before.
    pub fn click(&self, seconds: f64) -> Movement {
        Movement {
            from: self.from,
            to: self.to,
            clicks: [self.start, self.place],
            way: self.length,
            axis_deviation: if self.length > 0.0 {
                self.area / self.length
            } else {
                0.0
            },
            reentries: self.entries.saturating_sub(1),
            seconds,
            is_hit: distance(self.place, self.to) <= self.radius,
        }
    }

    /// Returns the distance of a point from the task axis, the line through the centers of both targets: below 0 on one side of it.
    fn beside_axis(&self, point: [f64; 2]) -> f64 {
        let axis = [self.to[0] - self.from[0], self.to[1] - self.from[1]];
        let offset = [point[0] - self.from[0], point[1] - self.from[1]];
        let length = axis[0].hypot(axis[1]);
        (offset[1] * axis[0] - offset[0] * axis[1]) / length.max(f64::MIN_POSITIVE)
    }
}

/// Returns the mean distance from a line on a straight way between two points, whose distances have a sign for the side.
fn mean_distance(before: f64, after: f64) -> f64 {
    let sum = before.abs() + after.abs();
    if before * after >= 0.0 {
        sum / 2.0
    } else {
        // Two triangles, on both sides of the line.
        (before * before + after * after) / (2.0 * sum)
    }
}

#[cfg(test)]
mod tests {
    use super::super::PointingResult;
    use super::*;

    /// Returns a movement down a ring of 400 px, from its upper end to a target of 40 px, by way of positions relative to the centers.
    fn movement(positions: &[[f64; 2]]) -> Movement {
        // The targets of two clicks of a ring of two are at its upper and at its lower end.
        let ring = Ring {
            targets: 2,
            center: [640.0, 400.0],
            diameter: 400.0,
            width: 40.0,
        };
        let at = |[right, down]: [f64; 2]| [640.0 + right, 200.0 + down];
        let mut path = PointerPath::new(&ring, 1, at([0.0, 0.0]));
        for position in positions {
            path.go_to(at(*position));
        }
        path.click(0.8)
    }

    #[test]
    fn the_way_beside_the_axis_is_the_area_between_them_by_its_length() {
        let straight = movement(&[[0.0, 150.0], [0.0, 400.0]]);
        assert!(straight.axis_deviation < 1e-9 && straight.is_hit);
        assert!((straight.way - 400.0).abs() < 1e-9, "{straight:?}");
        // Out by 30 px and 40 down, and straight on beside the axis: 50 px at 15 px on average, and 360 px at 30 px.
        let beside = movement(&[[30.0, 40.0], [30.0, 400.0]]);
        let expected = (50.0 * 15.0 + 360.0 * 30.0) / 410.0;
        assert!(
            (beside.axis_deviation - expected).abs() < 1e-9,
            "{beside:?}"
        );
        assert!(!beside.is_hit);
        // The side does not matter, and a rest does not count; across the axis, the mean distance is a quarter of the way.
        let across = movement(&[[-30.0, 0.0], [30.0, 0.0], [30.0, 0.0]]);
        assert!((across.axis_deviation - 15.0).abs() < 1e-9, "{across:?}");
    }

    #[test]
    fn a_target_is_entered_again_only_after_it_was_left() {
        let (inside, outside) = ([0.0, 390.0], [0.0, 430.0]);
        for (positions, reentries) in [
            (&[inside][..], 0),
            (&[inside, [5.0, 395.0]], 0),
            (&[outside, inside], 0),
            (&[inside, outside], 0),
            (&[inside, outside, inside], 1),
            (&[inside, outside, inside, outside, outside, inside], 2),
        ] {
            assert_eq!(movement(positions).reentries, reentries, "{positions:?}");
        }
    }

    #[test]
    fn the_figures_of_a_series_are_the_means_of_its_movements() {
        let (inside, outside) = ([0.0, 390.0], [0.0, 430.0]);
        let straight = movement(&[inside]);
        let beside = movement(&[inside, outside, inside, [-30.0, 390.0], [30.0, 390.0]]);
        let result = PointingResult::new(&[straight, beside]);
        // 470 px on the axis, and 90 px at 15 px on average.
        let expected = (90.0 * 15.0 / 560.0) / 2.0;
        assert!(
            (result.axis_deviation_px - expected).abs() < 1e-9,
            "{result:?}"
        );
        assert_eq!(result.reentries, 0.5);
    }
}
