//! Joint centers of the arm from markers on the skin.

use glam::DVec3;

/// Returns the center of the wrist: the mean of the markers on its two sides.
pub fn wrist_center(first: DVec3, second: DVec3) -> DVec3 {
    (first + second) / 2.0
}

/// The center E of the elbow from a marker M on its skin, which lies beside it along the normal n of the plane of the arm:
/// E = M + offset · n with n = (E − S) × (W − E) / |…| of the arm that results, not of the displaced marker.
///
/// n is perpendicular to the line from the shoulder S to the wrist W, and the marker is at the height −offset over the plane. These
/// conditions leave one normal, also for a straight arm. While hand and shoulder meet, or the marker is much nearer to the line
/// than its offset, the last normal is used.
#[derive(Clone, Copy, Debug)]
pub struct ElbowCenter {
    /// Distance from the marker to the center along the normal, in the unit of the markers; positive or negative, measured for each
    /// person.
    pub offset: f64,
    last_normal: Option<DVec3>,
}

impl ElbowCenter {
    /// Smallest distance of the marker from the line between shoulder and wrist, as a fraction of the offset, at which the marker
    /// shows the side on which it is.
    const MIN_HEIGHT: f64 = 0.5;

    /// Smallest distance between shoulder and wrist, as a fraction of the path over the elbow marker.
    const MIN_REACH: f64 = 0.05;

    /// Creates the estimate for an `offset` in the unit of the markers.
    pub fn new(offset: f64) -> Self {
        Self {
            offset,
            last_normal: None,
        }
    }

    /// Returns the center of the elbow. `None` if a segment of the arm has no length or a number is not finite, or if no normal
    /// has been seen since the start and the offset is not 0.
    pub fn update(&mut self, shoulder: DVec3, marker: DVec3, wrist: DVec3) -> Option<DVec3> {
        let way = [marker.distance(shoulder), marker.distance(wrist)];
        if !way.iter().all(|length| length.is_finite() && *length > 0.0) {
            return None;
        }
        if self.offset == 0.0 {
            return Some(marker);
        }
        let reach = wrist - shoulder;
        if reach.length() > Self::MIN_REACH * (way[0] + way[1]) {
            let normal = self.normal(reach.normalize(), marker - shoulder);
            self.last_normal = normal.or(self.last_normal);
        }
        Some(marker + self.offset * self.last_normal?)
    }

    /// Returns the normal at right angles to the unit direction `along` whose plane through the shoulder passes `marker` at the
    /// distance of the offset, on the side to which the resulting elbow bends.
    fn normal(&self, along: DVec3, marker: DVec3) -> Option<DVec3> {
        let across = marker.reject_from_normalized(along);
        let distance = across.length();
        if distance < Self::MIN_HEIGHT * self.offset.abs() {
            return None;
        }
        // Noise puts the marker of a straight arm nearer than its offset.
        let sine = (self.offset / distance).clamp(-1.0, 1.0);
        let cosine = (1.0 - sine * sine).sqrt();
        let across = across / distance;
        Some(-sine * across - cosine * along.cross(across))
    }

    /// Forgets the last normal, after an interruption.
    pub fn reset(&mut self) {
        self.last_normal = None;
    }
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;

    /// Returns shoulder, elbow and wrist of an arm in a turned plane, bent by some degrees, and the normal of its plane.
    fn arm(degrees: f64, turn: f64) -> ([DVec3; 3], DVec3) {
        let rotation = DQuat::from_euler(glam::EulerRot::XYZ, turn, 0.7 - turn, 1.9 * turn);
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let elbow = DVec3::new(0.0, -0.3, 0.0);
        let wrist = elbow + 0.26 * DVec3::new(0.0, -cosine, -sine);
        let shoulder = DVec3::new(0.2, 1.4, -0.1);
        let placed = [DVec3::ZERO, elbow, wrist].map(|point| shoulder + rotation * point);
        let normal = rotation * (elbow.cross(wrist - elbow).normalize_or(DVec3::X));
        (placed, normal)
    }

    #[test]
    fn the_centre_is_exact_at_every_bend_and_turn() {
        for offset in [0.04, -0.04, 0.01] {
            let mut elbow = ElbowCenter::new(offset);
            for step in 0..1700 {
                // Up to a folded arm of 170 degrees, through the nearly straight ones, while the arm turns.
                let (points, normal) = arm(0.1 * f64::from(step), 0.01 * f64::from(step));
                let [shoulder, center, wrist] = points;
                let marker = center - offset * normal;
                let found = elbow.update(shoulder, marker, wrist).unwrap();
                let error = found.distance(center);
                assert!(error < 1e-6, "{offset} at {step}: {error}");
            }
        }
    }

    #[test]
    fn noise_of_a_straight_arm_moves_the_centre_by_less_than_half_the_offset() {
        let mut random = fastrand::Rng::with_seed(8);
        for step in 0..2000 {
            let (points, normal) = arm(0.005 * f64::from(step), 0.003 * f64::from(step));
            let mut noise = || DVec3::from_array([0; 3].map(|_| 2e-3 * (random.f64() - 0.5)));
            let marker = points[1] - 0.04 * normal + noise();
            let [shoulder, wrist] = [points[0] + noise(), points[2] + noise()];
            let mut elbow = ElbowCenter::new(0.04);
            let found = elbow.update(shoulder, marker, wrist).unwrap();
            let error = found.distance(points[1]);
            assert!(error < 0.02, "{step}: {error}");
        }
    }

    #[test]
    fn an_arm_whose_ends_meet_and_a_marker_on_its_line_keep_the_last_normal() {
        let (points, normal) = arm(90.0, 0.3);
        let [shoulder, center, wrist] = points;
        let marker = center - 0.04 * normal;
        let mut elbow = ElbowCenter::new(0.04);
        assert_eq!(elbow.update(shoulder, marker, shoulder), None);
        let on_line = shoulder.midpoint(wrist);
        assert_eq!(elbow.update(shoulder, on_line, wrist), None);
        let found = elbow.update(shoulder, marker, wrist).unwrap();
        assert!(found.distance(center) < 1e-9, "{found}");
        for (seen_marker, seen_wrist) in [(marker, shoulder), (on_line, wrist)] {
            let held = elbow.update(shoulder, seen_marker, seen_wrist).unwrap();
            assert!(held.distance(seen_marker + 0.04 * normal) < 1e-9, "{held}");
        }
        assert_eq!(elbow.update(shoulder, shoulder, wrist), None);
        elbow.reset();
        assert_eq!(elbow.update(shoulder, marker, shoulder), None);
    }

    #[test]
    fn a_marker_without_an_offset_is_the_centre_of_a_straight_arm_too() {
        let marker = DVec3::new(0.0, -0.3, 0.0);
        let wrist = DVec3::new(0.0, -0.6, 0.0);
        let mut elbow = ElbowCenter::new(0.0);
        assert_eq!(elbow.update(DVec3::ZERO, marker, wrist), Some(marker));
    }
}
