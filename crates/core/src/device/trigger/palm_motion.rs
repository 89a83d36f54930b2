//! The motion of a palm in the last second: swipes and shakes.

use std::time::Duration;

use arrayvec::ArrayVec;
use parry3d::math::Vec3;

use crate::hand::Joint;
use crate::kinematics::HandPose;
use crate::names::named_enum;
use crate::time::Timestamp;

/// The time in which a swipe covers its distance.
const SWIPE_TIME: Duration = Duration::from_millis(200);

/// The shortest time between two positions that are kept.
const MIN_PERIOD: Duration = Duration::from_millis(10);

/// Positions that are kept: all of a swipe, both ends included.
const MAX_POSITIONS: usize = 21;

/// The largest distance across a swipe, as a fraction of the distance along it.
const MAX_ACROSS: f32 = 0.5;

/// The longest gap between two positions of a motion.
const MAX_GAP: Duration = Duration::from_millis(250);

/// The time in which the reversals of a shake count.
const SHAKE_TIME: Duration = Duration::from_secs(1);

/// The shortest distance between two reversals of a shake, in metres: hands that type turn back more often after shorter ones.
const SHAKE_WAY: f32 = 0.1;

/// Reversals that are counted: a hand turns back fewer times in a second.
const MAX_REVERSALS: usize = 16;

named_enum! {
    /// The direction of a swipe, as the wearer sees it.
    pub enum SwipeDirection ("direction of a swipe") {
        /// To the left.
        Left = "left",
        /// To the right.
        Right = "right",
        /// Up.
        Up = "up",
        /// Down.
        Down = "down",
    }
}

/// The last positions of the palm of one hand: of the knuckle of its index finger, in the world.
#[derive(Clone, Debug, Default)]
pub(super) struct PalmMotion {
    /// Oldest first.
    positions: ArrayVec<(Timestamp, Vec3), MAX_POSITIONS>,
    /// The time and the position of the last reading.
    last: Option<(Timestamp, Vec3)>,
    /// The reversals by axis of the world.
    reversals: [Reversals; 3],
}

/// The reversals of a motion back and forth along one axis.
#[derive(Clone, Debug, Default)]
struct Reversals {
    /// The furthest position since the last reversal, in metres.
    furthest: f32,
    /// `true` if the motion is towards positive positions.
    ascends: bool,
    times: ArrayVec<Timestamp, MAX_REVERSALS>,
}

impl SwipeDirection {
    /// Returns the direction in the world: +X is right, +Y is up.
    fn vector(self) -> Vec3 {
        match self {
            Self::Left => -Vec3::X,
            Self::Right => Vec3::X,
            Self::Up => Vec3::Y,
            Self::Down => -Vec3::Y,
        }
    }
}

impl PalmMotion {
    /// Processes the next pose. A hand that is lost, jumped or was not seen for a while has no motion.
    pub(super) fn update(&mut self, pose: &HandPose) {
        let position = pose.position(Joint::IndexPhalanxProximal);
        let position = position.filter(|it| it.is_finite() && !pose.jumped);
        let Some(position) = position else {
            return self.clear();
        };
        if self
            .last
            .is_some_and(|(last, _)| pose.time.since(last) > MAX_GAP)
        {
            self.clear();
        }
        let is_first = self.last.is_none();
        self.last = Some((pose.time, position));
        let is_over = |(time, _): &(Timestamp, Vec3)| pose.time.since(*time) > SWIPE_TIME;
        let over = self.positions.iter().take_while(|it| is_over(it)).count();
        self.positions.drain(..over);
        let newest = self.positions.last();
        let is_due = newest.is_none_or(|(time, _)| pose.time.since(*time) >= MIN_PERIOD);
        if is_due && !self.positions.is_full() {
            self.positions.push((pose.time, position));
        }
        for (reversals, at) in self.reversals.iter_mut().zip(position.to_array()) {
            if is_first {
                reversals.furthest = at;
            }
            reversals.update(at, pose.time);
        }
    }

    /// Forgets the motion.
    pub(super) fn clear(&mut self) {
        self.positions.clear();
        self.last = None;
        for reversals in &mut self.reversals {
            reversals.times.clear();
        }
    }

    /// Returns the distance that the palm has moved in a direction in the time of a swipe, in metres, if it has not moved more than
    /// half as far across it; `None` if the palm is unknown.
    pub(super) fn swipe(&self, direction: SwipeDirection) -> Option<f32> {
        let (_, to) = self.last?;
        let distance = |(_, from): &(Timestamp, Vec3)| {
            let way = to - *from;
            let along = way.dot(direction.vector());
            let across = (way - along * direction.vector()).length();
            (across <= MAX_ACROSS * along).then_some(along)
        };
        let distances = self.positions.iter().filter_map(distance);
        Some(distances.fold(0.0, f32::max))
    }

    /// Returns the number of reversals of the palm in the last second, along the axis of the world that has most; `None` if the palm is
    /// unknown.
    pub(super) fn reversals(&self) -> Option<f32> {
        self.last?;
        let counts = self.reversals.iter().map(|reversals| reversals.times.len());
        Some(counts.max().unwrap_or(0) as f32)
    }
}

impl Reversals {
    fn update(&mut self, at: f32, time: Timestamp) {
        let is_over = |reversal: &Timestamp| time.since(*reversal) > SHAKE_TIME;
        let over = self.times.iter().take_while(|it| is_over(it)).count();
        self.times.drain(..over);
        let ahead = if self.ascends {
            at - self.furthest
        } else {
            self.furthest - at
        };
        if ahead >= 0.0 {
            self.furthest = at;
        } else if ahead <= -SHAKE_WAY {
            self.ascends = !self.ascends;
            self.furthest = at;
            // A list that is full counts as many reversals as anything needs.
            _ = self.times.try_push(time);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hand::Side;
    use parry3d::math::Pose;

    /// Moves a palm to positions in millimetres, one every `period` milliseconds.
    fn motion(period: u64, millimetres: impl IntoIterator<Item = [f32; 3]>) -> PalmMotion {
        let mut motion = PalmMotion::default();
        for (index, position) in millimetres.into_iter().enumerate() {
            let time = Timestamp(index as u64 * period * 1000);
            let mut pose = HandPose::new(time, Side::Right, 0.005);
            let position = Vec3::from_array(position) * 1e-3;
            pose.set(
                Joint::IndexPhalanxProximal,
                Pose::from_translation(position),
            );
            motion.update(&pose);
        }
        motion
    }

    #[test]
    fn a_swipe_is_the_distance_of_the_last_200_ms_at_any_rate_of_readings() {
        for period in [1, 5, 20, 33] {
            let ways = (0..=500 / period).map(|index| [(index * period) as f32, 0.0, 0.0]);
            let motion = motion(period, ways);
            let right = motion.swipe(SwipeDirection::Right).unwrap();
            assert!((0.16..=0.2001).contains(&right), "{period} ms: {right}");
            for other in [
                SwipeDirection::Left,
                SwipeDirection::Up,
                SwipeDirection::Down,
            ] {
                assert_eq!(motion.swipe(other), Some(0.0), "{period} ms {other}");
            }
        }
    }

    #[test]
    fn a_slanted_motion_is_no_swipe() {
        let ways = |slope: f32| (0..20).map(move |it| [0.0, it as f32 * -10.0, it as f32 * slope]);
        let down = |slope| motion(10, ways(slope)).swipe(SwipeDirection::Down);
        assert!(down(4.0) > Some(0.18), "{:?}", down(4.0));
        assert_eq!(down(6.0), Some(0.0));
    }

    #[test]
    fn a_gap_ends_a_motion_and_an_unknown_palm_has_none() {
        let far = [[0.0; 3], [300.0, 0.0, 0.0]];
        assert_eq!(motion(300, far).swipe(SwipeDirection::Right), Some(0.0));
        let nothing = PalmMotion::default();
        assert_eq!(nothing.swipe(SwipeDirection::Right), None);
        assert_eq!(nothing.reversals(), None);
    }

    #[test]
    fn a_shake_has_the_reversals_of_the_last_second() {
        let shake = |hertz: f32, millimetres: f32| {
            let ways = (0..150).map(move |index| {
                let phase = index as f32 * 0.01 * hertz * std::f32::consts::TAU;
                [0.0, 0.0, millimetres * phase.sin()]
            });
            motion(10, ways).reversals().unwrap()
        };
        assert!(
            (5.0..=7.0).contains(&shake(3.0, 70.0)),
            "{}",
            shake(3.0, 70.0)
        );
        assert_eq!(shake(3.0, 45.0), 0.0);
        assert!(shake(0.5, 70.0) <= 1.0);
    }
}
