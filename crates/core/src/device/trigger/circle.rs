//! Circles that a palm or a fingertip draws.

use std::f32::consts::{PI, TAU};
use std::time::Duration;

use parry3d::math::{Vec2, Vec3};

use crate::contact::trusted_fingertip;
use crate::hand::{Finger, Joint};
use crate::kinematics::HandPose;
use crate::names::named_enum;
use crate::time::Timestamp;

/// The shortest chord with a direction, in metres: several times the noise of a camera.
const CHORD: f32 = 0.02;

/// The longest time of a chord. A hand that is slower rests, or reaches for something.
const CHORD_TIME: Duration = Duration::from_millis(200);

/// The largest turn from one chord to the next, in radians. Hands that type or tap turn back, or turn at a key.
const MAX_TURN: f32 = 1.4;

/// The turn against the direction of a circle that ends it, in radians.
const MAX_BACK: f32 = 1.0;

/// The longest time of a turn, in seconds.
const MAX_TURN_TIME: f32 = 2.5;

/// The smallest mean radius, in metres. The path of a fingertip from key to key reaches 30 mm.
const MIN_RADIUS: f32 = 0.035;

/// The least area of a circle as a fraction of a round one of the same length. An ellipse 3.4 times as long as
/// wide has 0.6.
const MIN_ROUNDNESS: f32 = 0.6;

named_enum! {
    /// The point of a hand that draws a circle.
    pub enum CirclePoint ("point of a hand") {
        /// The palm: the knuckle of the index finger.
        Palm = "palm",
        /// The tip of the index finger.
        Index = "index",
    }
}

named_enum! {
    /// The direction of a circle, as the wearer sees it; of a flat circle as the wearer sees it from above.
    pub enum CircleDirection ("direction of a circle") {
        /// Clockwise.
        Clockwise = "clockwise",
        /// Counter-clockwise.
        CounterClockwise = "counter-clockwise",
    }
}

/// The circle that a point of a hand draws.
#[derive(Clone, Debug, Default)]
pub(super) struct CircleMotion {
    /// Seen from the front, and from above.
    planes: [Turning; 2],
    is_known: bool,
}

/// The path of a point in a plane since it began to turn in one direction.
#[derive(Clone, Debug, Default)]
struct Turning {
    /// The end of the last chord.
    last: Option<(Timestamp, Vec2)>,
    /// The direction of the last chord, of length 1.
    heading: Option<Vec2>,
    /// The time and the position at which the path begins.
    since: Timestamp,
    origin: Vec2,
    /// The sum of the turns from chord to chord in radians, counter-clockwise, and the largest one since the beginning.
    angle: f32,
    furthest: f32,
    /// The length of the path in metres, and the area that it encloses in square metres, counter-clockwise.
    length: f32,
    area: f32,
}

impl CirclePoint {
    fn position(self, pose: &HandPose) -> Option<Vec3> {
        match self {
            Self::Palm => pose.position(Joint::IndexPhalanxProximal),
            Self::Index => trusted_fingertip(pose, Finger::Index),
        }
    }
}

impl CircleMotion {
    /// Processes the next pose. A point that is not known, or that jumped, draws nothing.
    pub(super) fn update(&mut self, point: CirclePoint, pose: &HandPose) {
        let position = point.position(pose);
        let position = position.filter(|it| it.is_finite() && !pose.jumped);
        let Some(Vec3 { x, y, z }) = position else {
            *self = Self::default();
            return;
        };
        self.is_known = true;
        for (plane, at) in self.planes.iter_mut().zip([[x, y], [x, -z]]) {
            plane.update(pose.time, Vec2::from_array(at));
        }
    }

    /// Returns the number of turns without a stop in a direction, in the plane in which the circle is larger; 0 for a path that is
    /// not round, and `None` if the point is not known.
    pub(super) fn turns(&self, direction: Option<CircleDirection>) -> Option<f32> {
        let [front, above] = &self.planes;
        let plane = if front.area.abs() >= above.area.abs() {
            front
        } else {
            above
        };
        let turns = plane.turns();
        let turns = match direction {
            None => turns.abs(),
            Some(CircleDirection::CounterClockwise) => turns.max(0.0),
            Some(CircleDirection::Clockwise) => (-turns).max(0.0),
        };
        self.is_known.then_some(turns)
    }
}

impl Turning {
    fn update(&mut self, time: Timestamp, at: Vec2) {
        let Some((last_time, last)) = self.last else {
            return self.restart(time, at, None);
        };
        let gap = time.since(last_time);
        let chord = at - last;
        let length = chord.length();
        if gap > CHORD_TIME {
            return self.restart(time, at, None);
        }
        if length < CHORD {
            return;
        }
        let heading = chord / length;
        let before = self.heading.replace(heading).unwrap_or(heading);
        let turn = before.perp_dot(heading).atan2(before.dot(heading));
        let angle = self.angle + turn;
        let is_back = (self.furthest - angle) * self.furthest.signum() > MAX_BACK;
        if turn.abs() > MAX_TURN || is_back || angle * self.angle < 0.0 {
            return self.restart(time, at, Some(heading));
        }
        self.angle = angle;
        if angle.abs() > self.furthest.abs() {
            self.furthest = angle;
        }
        self.length += length;
        self.area += (last - self.origin).perp_dot(at - self.origin) / 2.0;
        self.last = Some((time, at));
    }

    /// Begins another path at a position, with the direction of the chord that led to it.
    fn restart(&mut self, time: Timestamp, at: Vec2, heading: Option<Vec2>) {
        *self = Self {
            last: Some((time, at)),
            heading,
            since: time,
            origin: at,
            ..Self::default()
        };
    }

    /// Returns the number of turns, counter-clockwise; 0 if the path is too slow, too small or not round.
    fn turns(&self) -> f32 {
        let turns = self.angle / TAU;
        let seconds = self
            .last
            .map_or(0.0, |(time, _)| time.since(self.since).as_secs_f32());
        // Positive if the path encloses the side to which it turns. A round path of n turns encloses length² / (4 π n).
        let area = self.area * turns.signum();
        let round = self.length * self.length / (4.0 * PI * turns.abs());
        let smallest = PI * MIN_RADIUS * MIN_RADIUS * turns.abs();
        let is_circle = seconds <= turns.abs() * MAX_TURN_TIME
            && area >= MIN_ROUNDNESS * round
            && area >= smallest;
        if is_circle { turns } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hand::Side;
    use parry3d::math::Pose;

    /// Moves a palm, one position every `period` milliseconds, and returns the most turns in each direction.
    fn most(period: u64, way: impl Fn(f32) -> Vec3) -> [f32; 2] {
        let mut motion = CircleMotion::default();
        let mut most = [0.0_f32; 2];
        for time in (0..2_000).step_by(period as usize) {
            let mut pose = HandPose::new(Timestamp(time * 1000), Side::Right, 0.005);
            let position = way(time as f32 * 1e-3);
            pose.set(
                Joint::IndexPhalanxProximal,
                Pose::from_translation(position),
            );
            motion.update(CirclePoint::Palm, &pose);
            for (peak, &direction) in most.iter_mut().zip(CircleDirection::ALL) {
                *peak = peak.max(motion.turns(Some(direction)).unwrap());
            }
        }
        most
    }

    #[test]
    fn a_circle_has_a_direction_as_the_wearer_sees_it_upright_and_from_above() {
        let round = |seconds: f32| Vec2::from_angle(seconds.min(1.0) * TAU) * 0.08;
        for period in [2, 8, 33] {
            let upright = |seconds| round(seconds).extend(0.3);
            let [clockwise, counter] = most(period, upright);
            assert_eq!(clockwise, 0.0, "{period} ms");
            assert!((0.85..=1.01).contains(&counter), "{period} ms: {counter}");
            let flat = |seconds| Vec3::new(round(seconds).x, 0.3, round(seconds).y);
            let [flat_clockwise, flat_counter] = most(period, flat);
            assert_eq!(flat_counter, 0.0, "{period} ms");
            assert!(
                (0.85..=1.01).contains(&flat_clockwise),
                "{period} ms: {flat_clockwise}"
            );
        }
    }

    #[test]
    fn a_small_slow_or_long_way_is_no_circle() {
        let way = |right: f32, up: f32, hertz: f32| {
            most(8, move |seconds| {
                let (sine, cosine) = (seconds * hertz * TAU).sin_cos();
                Vec3::new(right * cosine, up * sine, 0.0)
            })
        };
        assert!(way(0.06, 0.06, 1.0)[1] > 1.5, "{:?}", way(0.06, 0.06, 1.0));
        assert_eq!(way(0.025, 0.025, 1.0), [0.0; 2]);
        assert_eq!(way(0.06, 0.06, 0.3), [0.0; 2]);
        assert_eq!(way(0.2, 0.02, 1.0), [0.0; 2]);
    }

    #[test]
    fn a_point_that_is_unknown_or_jumps_has_no_circle() {
        let mut motion = CircleMotion::default();
        assert_eq!(motion.turns(None), None);
        let mut pose = HandPose::new(Timestamp(0), Side::Right, 0.005);
        pose.set(Joint::IndexPhalanxProximal, Pose::IDENTITY);
        motion.update(CirclePoint::Palm, &pose);
        assert_eq!(motion.turns(None), Some(0.0));
        pose.jumped = true;
        motion.update(CirclePoint::Palm, &pose);
        assert_eq!(motion.turns(None), None);
    }
}
