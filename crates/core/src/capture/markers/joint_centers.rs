//! Joint centres of the arm from markers on the skin.

use glam::DVec3;

/// Returns the centre of the wrist: the mean of the markers on its two sides.
pub fn wrist_center(first: DVec3, second: DVec3) -> DVec3 {
    (first + second) / 2.0
}

/// The bend of an arm at its elbow marker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bend {
    /// Sine of the angle between upper arm and forearm, 0..=1: 0 for a straight and for a folded arm.
    pub sine: f64,
    /// Unit normal of the plane of the arm, (E − S) × (W − E). `None` if the three points are nearly in line, where noise
    /// would decide its direction.
    pub normal: Option<DVec3>,
}

/// Returns the bend of the arm through `shoulder`, `elbow` and `wrist`; `None` if a segment has no length or a number is
/// not finite. The points count as in line if the sine is less than `min_sine`.
pub fn elbow_bend(shoulder: DVec3, elbow: DVec3, wrist: DVec3, min_sine: f64) -> Option<Bend> {
    let (upper_arm, forearm) = (elbow - shoulder, wrist - elbow);
    let lengths = upper_arm.length() * forearm.length();
    if !lengths.is_finite() || lengths <= 0.0 {
        return None;
    }
    let normal = upper_arm.cross(forearm);
    let is_in_line = normal.length() < min_sine * lengths;
    Some(Bend {
        sine: normal.length() / lengths,
        normal: normal.try_normalize().filter(|_| !is_in_line),
    })
}

/// The centre of the elbow from a marker on its skin: marker + offset · normal of the plane of the arm.
///
/// While the arm is nearly straight, the plane is not determined, and the last normal is used.
#[derive(Clone, Copy, Debug)]
pub struct ElbowCenter {
    /// Distance from the marker to the centre along the normal, positive or negative, measured for each person.
    pub offset: f64,
    /// Smallest sine of the bend at which the plane of the arm is determined.
    pub min_sine: f64,
    last_normal: Option<DVec3>,
}

impl ElbowCenter {
    /// Sine of 2.9°, at which 1 mm of noise at a forearm of 250 mm turns the normal by 5°.
    pub const MIN_SINE: f64 = 0.05;

    /// Creates the estimate for an `offset` in the unit of the markers.
    pub fn new(offset: f64) -> Self {
        Self {
            offset,
            min_sine: Self::MIN_SINE,
            last_normal: None,
        }
    }

    /// Returns the centre of the elbow. `None` if a segment of the arm has no length, or if the arm has been straight
    /// since the start and the offset is not 0.
    pub fn update(&mut self, shoulder: DVec3, marker: DVec3, wrist: DVec3) -> Option<DVec3> {
        let bend = elbow_bend(shoulder, marker, wrist, self.min_sine)?;
        self.last_normal = bend.normal.or(self.last_normal);
        if self.offset == 0.0 {
            return Some(marker);
        }
        Some(marker + self.offset * self.last_normal?)
    }

    /// Forgets the last normal, after an interruption.
    pub fn reset(&mut self) {
        self.last_normal = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_arm_keeps_the_last_normal() {
        let (shoulder, marker) = (DVec3::ZERO, DVec3::new(0.0, -0.3, 0.0));
        let bent = DVec3::new(0.0, -0.3, -0.25);
        let straight = DVec3::new(0.0, -0.55, -0.001);
        let mut elbow = ElbowCenter::new(0.04);
        assert_eq!(elbow.update(shoulder, marker, straight), None);
        let center = elbow.update(shoulder, marker, bent).unwrap();
        assert!(
            center.distance(marker + DVec3::X * 0.04) < 1e-12,
            "{center}"
        );
        assert_eq!(elbow.update(shoulder, marker, straight), Some(center));
        assert_eq!(elbow.update(shoulder, shoulder, bent), None);
        elbow.reset();
        assert_eq!(elbow.update(shoulder, marker, straight), None);
    }

    #[test]
    fn a_marker_without_an_offset_is_the_centre_of_a_straight_arm_too() {
        let marker = DVec3::new(0.0, -0.3, 0.0);
        let wrist = DVec3::new(0.0, -0.6, 0.0);
        let mut elbow = ElbowCenter::new(0.0);
        assert_eq!(elbow.update(DVec3::ZERO, marker, wrist), Some(marker));
    }
}
