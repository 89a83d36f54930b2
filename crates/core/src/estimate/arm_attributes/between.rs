//! Movements between two postures, in the space of the attributes.
//!
//! Angles take the short way, directions move on the sphere, and lengths change linearly, so that no bone shrinks on the way as it
//! does between landmarks.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::ArmAttributes;

/// The smallest inclination of a wrist, in radians, whose azimuth means something.
const MIN_INCLINATION: f64 = 1e-6;

/// The largest sine of the angle between two directions that count as parallel.
const PARALLEL: f64 = 1e-9;

impl ArmAttributes {
    /// Returns the attributes at a fraction of a movement to `end`, 0..=1: exactly these at 0, and exactly `end` at 1.
    ///
    /// Angles with limits stay between their two ends, and a signed shoulder rotation takes the short way, so that a movement
    /// between possible postures is possible.
    #[must_use]
    pub fn between(&self, end: &Self, fraction: f64) -> Self {
        if fraction <= 0.0 {
            return *self;
        }
        if fraction >= 1.0 {
            return *end;
        }
        let linear = |from: f64, to: f64| from + (to - from) * fraction;
        let vector = |from: DVec3, to: DVec3| {
            direction_between(from, to, fraction) * linear(from.length(), to.length())
        };
        // A hand in line with the forearm has no azimuth of its own.
        let [from, to] = match (self.wrist_inclination, end.wrist_inclination) {
            (from, _) if from < MIN_INCLINATION => [end.wrist_rotation; 2],
            (_, to) if to < MIN_INCLINATION => [self.wrist_rotation; 2],
            _ => [self.wrist_rotation, end.wrist_rotation],
        };
        // Only a rotation with a sign has a way across half a turn.
        let rotation = [self.shoulder_rotation, end.shoulder_rotation];
        let shoulder_rotation = if (rotation[1] - rotation[0]).abs() > PI {
            turn_between(rotation[0], rotation[1], fraction)
        } else {
            linear(rotation[0], rotation[1])
        };
        Self {
            shoulder_direction: direction_between(
                self.shoulder_direction,
                end.shoulder_direction,
                fraction,
            ),
            upper_arm_length: linear(self.upper_arm_length, end.upper_arm_length),
            shoulder_rotation,
            elbow_angle: linear(self.elbow_angle, end.elbow_angle),
            forearm_length: linear(self.forearm_length, end.forearm_length),
            elbow_rotation: turn_between(self.elbow_rotation, end.elbow_rotation, fraction),
            wrist_rotation: turn_between(from, to, fraction),
            wrist_inclination: linear(self.wrist_inclination, end.wrist_inclination),
            little_vector: vector(self.little_vector, end.little_vector),
            index_vector: vector(self.index_vector, end.index_vector),
            thumb_vector: vector(self.thumb_vector, end.thumb_vector),
        }
    }
}

/// Returns a turn between two, in radians, on the short way: −π..π.
fn turn_between(from: f64, to: f64, fraction: f64) -> f64 {
    let difference = wrapped(to - from);
    wrapped(from + difference * fraction)
}

fn wrapped(angle: f64) -> f64 {
    (angle + PI).rem_euclid(TAU) - PI
}

/// Returns a unit direction between two on the great circle. Opposite directions have many; the one through the axis that is most
/// perpendicular to them is taken.
fn direction_between(from: DVec3, to: DVec3, fraction: f64) -> DVec3 {
    let (from, to) = (from.normalize_or_zero(), to.normalize_or_zero());
    let angle = from.cross(to).length().atan2(from.dot(to));
    if angle.sin() > PARALLEL {
        let (near, far) = (((1.0 - fraction) * angle).sin(), (fraction * angle).sin());
        return ((from * near + to * far) / angle.sin()).normalize_or_zero();
    }
    if from.dot(to) >= 0.0 {
        return from.lerp(to, fraction).normalize_or_zero();
    }
    let across = from.any_orthonormal_vector();
    let (sine, cosine) = (fraction * PI).sin_cos();
    from * cosine + across * sine
}

#[cfg(test)]
mod tests {
    use super::*;

    fn posture() -> ArmAttributes {
        ArmAttributes {
            shoulder_direction: DVec3::new(0.0, 1.0, 0.0),
            upper_arm_length: 0.3,
            shoulder_rotation: 0.5,
            elbow_angle: 2.5,
            forearm_length: 0.25,
            elbow_rotation: 3.0,
            wrist_rotation: -3.0,
            wrist_inclination: 0.4,
            little_vector: DVec3::new(0.0, 0.03, 0.08),
            index_vector: DVec3::new(0.0, -0.03, 0.09),
            thumb_vector: DVec3::new(0.02, -0.04, 0.05),
        }
    }

    #[test]
    fn a_movement_begins_and_ends_exactly_at_its_postures() {
        let (start, end) = (
            posture(),
            ArmAttributes {
                elbow_angle: 1.0,
                ..posture()
            },
        );
        assert_eq!(start.between(&end, 0.0), start);
        assert_eq!(start.between(&end, 1.0), end);
        assert_eq!(start.between(&end, 0.5).elbow_angle, 1.75);
    }

    #[test]
    fn turns_take_the_short_way_across_half_a_turn() {
        let start = ArmAttributes {
            shoulder_rotation: 3.1,
            ..posture()
        };
        let end = ArmAttributes {
            shoulder_rotation: -3.1,
            elbow_rotation: -3.0,
            wrist_rotation: 3.0,
            ..posture()
        };
        for step in 1..10 {
            let between = start.between(&end, f64::from(step) / 10.0);
            assert!(between.shoulder_rotation.abs() >= 3.1, "{between:?}");
            assert!(between.elbow_rotation.abs() >= 3.0, "{between:?}");
            assert!(between.wrist_rotation.abs() >= 3.0, "{between:?}");
        }
    }

    #[test]
    fn directions_stay_on_the_sphere_and_lengths_between_their_ends() {
        let end = ArmAttributes {
            shoulder_direction: DVec3::new(0.0, -1.0, 0.0),
            upper_arm_length: 0.32,
            index_vector: DVec3::new(0.0, 0.0, -0.08),
            ..posture()
        };
        for step in 0..=20 {
            let between = posture().between(&end, f64::from(step) / 20.0);
            assert!((between.shoulder_direction.length() - 1.0).abs() < 1e-12);
            assert!((0.3..=0.32).contains(&between.upper_arm_length));
            let length = between.index_vector.length();
            assert!((0.08..=0.0949).contains(&length), "{length}");
        }
    }

    #[test]
    fn a_hand_that_bends_from_the_line_of_the_forearm_keeps_to_one_plane() {
        let straight = ArmAttributes {
            wrist_inclination: 0.0,
            wrist_rotation: 0.0,
            ..posture()
        };
        let between = straight.between(&posture(), 0.25);
        assert_eq!(between.wrist_rotation, -3.0);
        assert!((between.wrist_inclination - 0.1).abs() < 1e-12);
    }
}
