//! The recent bend of each finger, which tells a finger that presses from its neighbors that follow.

use std::time::Duration;

use parry3d::math::Vec3;

use crate::hand::{Finger, FingerSet, Joint, Side};
use crate::kinematics::HandPose;

/// The time constant with which displacements fade, in seconds: a fast tap goes down within 50 to 100 ms.
const MEMORY: f32 = 0.08;

/// The smallest displacement of a fingertip, in metres, that counts as pressing: above the noise of a camera.
const MIN_DISPLACEMENT: f32 = 0.004;

/// The fraction of the displacement of another finger below which a finger follows it. Neighbors follow a pressing finger by up to
/// 0.45 of its bend (Zatsiorsky, Li & Latash 1998).
const MAX_FOLLOWING_FRACTION: f32 = 0.5;

/// The shortest time for which the largest displacements are kept. Neighbors follow 10 to 25 ms later, and are slow to turn.
const LAG: Duration = Duration::from_millis(40);

/// The recent displacements of the fingertips of one hand out of the plane of its palm, which fade. Movements of the whole hand do not
/// count.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Flexion {
    known: FingerSet,
    /// The heights of the fingertips below the palm, from their knuckles, in the last pose, in metres.
    heights: [f32; Finger::COUNT],
    /// The sums of the changes of the heights, in metres, which fade; positive for a bend.
    displacements: [f32; Finger::COUNT],
    /// The largest displacements in the present lag and in the lag before it: a finger that follows is late.
    largest: [[f32; Finger::COUNT]; 2],
    /// The time since the start of the present lag.
    since: Duration,
}

impl Flexion {
    /// Appends a pose, `gap` after the last one. A finger that is not known in two consecutive poses has the displacement 0.
    pub fn push(&mut self, pose: &HandPose, gap: Duration) {
        let kept = (-gap.as_secs_f32() / MEMORY).exp();
        let palmar = palmar(pose);
        for &finger in Finger::ALL {
            let index = finger.index();
            let ends = pose.fingertip(finger).zip(pose.position(knuckle(finger)));
            // A body tracker shows one point of a finger, which has no bend.
            let ends = ends.filter(|(tip, knuckle)| tip != knuckle);
            let height = ends.zip(palmar);
            let height = height.map(|((tip, knuckle), direction)| (tip - knuckle).dot(direction));
            let Some(now) = height.filter(|height| height.is_finite()) else {
                self.known = self.known.without(finger);
                self.displacements[index] = 0.0;
                continue;
            };
            self.displacements[index] = if self.known.contains(finger) && !pose.jumped {
                self.displacements[index] * kept + (now - self.heights[index])
            } else {
                0.0
            };
            self.heights[index] = now;
            self.known = self.known.with(finger);
        }
        if pose.jumped {
            self.largest = Default::default();
        }
        self.remember(gap);
    }

    /// Updates the largest displacements of the last one to two lags. A finger that is not known has 0.
    fn remember(&mut self, gap: Duration) {
        self.since += gap;
        if self.since >= LAG {
            let is_old = self.since >= 2 * LAG;
            self.largest[1] = if is_old {
                self.displacements
            } else {
                self.largest[0]
            };
            self.largest[0] = self.displacements;
            self.since = Duration::ZERO;
        }
        for &finger in Finger::ALL {
            let index = finger.index();
            let [newer, older] = &mut self.largest;
            newer[index] = newer[index].max(self.displacements[index]);
            if !self.known.contains(finger) {
                (newer[index], older[index]) = (0.0, 0.0);
            }
        }
    }

    /// Returns `true` if a finger follows another one that bends at least twice as far. If the other one is `touching`, the largest
    /// recent bends of both count.
    pub fn follows(&self, finger: Finger, touching: FingerSet) -> bool {
        let own = finger.index();
        let is_less = |[own_displacement, leading]: [f32; 2]| {
            leading > MIN_DISPLACEMENT && own_displacement < MAX_FOLLOWING_FRACTION * leading
        };
        let mut others = Finger::ALL.iter().filter(|other| **other != finger);
        self.known.contains(finger)
            && others.any(|&other| {
                let index = other.index();
                // Both fingers may already move back.
                is_less(if touching.contains(other) {
                    [self.largest(own), self.largest(index)]
                } else {
                    [self.displacements[own], self.displacements[index]]
                })
            })
    }

    /// Returns the largest displacement of a finger in the last one to two lags, in metres.
    fn largest(&self, index: usize) -> f32 {
        let [newer, older] = &self.largest;
        newer[index].max(older[index])
    }
}

/// Returns the direction out of the palm (world, unit length), or `None` if the palm is not known.
fn palmar(pose: &HandPose) -> Option<Vec3> {
    let wrist = pose.position(Joint::Wrist)?;
    let index = pose.position(knuckle(Finger::Index))? - wrist;
    let little = pose.position(knuckle(Finger::Little))? - wrist;
    let normal = index.cross(little).try_normalize()?;
    Some(match pose.side {
        Side::Right => normal,
        Side::Left => -normal,
    })
}

/// Returns the joint around which a whole finger bends.
const fn knuckle(finger: Finger) -> Joint {
    match finger {
        Finger::Thumb => Joint::ThumbPhalanxProximal,
        Finger::Index => Joint::IndexPhalanxProximal,
        Finger::Middle => Joint::MiddlePhalanxProximal,
        Finger::Ring => Joint::RingPhalanxProximal,
        Finger::Little => Joint::LittlePhalanxProximal,
    }
}

#[cfg(test)]
mod tests {
    use parry3d::math::{Pose, Rotation};

    use super::*;
    use crate::time::Timestamp;

    /// A hand whose fingers are bent by these millimetres, turned about its wrist.
    fn pose(side: Side, ways: [f32; Finger::COUNT], turn: f32) -> HandPose {
        let mut pose = HandPose::new(Timestamp(0), side, 0.008);
        let mirror = if side == Side::Right { 1.0 } else { -1.0 };
        let turned = Rotation::from_rotation_x(turn);
        let mut set = |joint, at: Vec3| pose.set(joint, Pose::from_translation(turned * at));
        set(Joint::Wrist, Vec3::ZERO);
        for &finger in Finger::ALL {
            let across = (finger.index() as f32 - 2.0) * 0.02 * mirror;
            let base = Vec3::new(across, 0.0, -0.08);
            set(knuckle(finger), base);
            let bend = ways[finger.index()] * 1e-3;
            set(
                Joint::tip(finger),
                base + Vec3::new(0.0, -0.03 - bend, -0.06),
            );
        }
        pose
    }

    /// The flexion after fingers have bent by these millimetres in 40 ms, while the hand has turned.
    fn after(side: Side, ways: [f32; Finger::COUNT], turn: f32) -> Flexion {
        let mut flexion = Flexion::default();
        for step in 0..=8 {
            let part = step as f32 / 8.0;
            let pose = pose(side, ways.map(|way| way * part), turn * part);
            flexion.push(&pose, Duration::from_millis(5));
        }
        flexion
    }

    #[test]
    fn a_neighbor_follows_and_a_finger_of_a_chord_does_not() {
        for side in [Side::Right, Side::Left] {
            for turn in [0.0, 0.3] {
                let flexion = after(side, [0.0, 15.0, 6.0, 12.0, -2.0], turn);
                let followers = Finger::ALL
                    .iter()
                    .filter(|it| flexion.follows(**it, FingerSet::ALL));
                let followers: Vec<Finger> = followers.copied().collect();
                assert_eq!(followers, [Finger::Thumb, Finger::Middle, Finger::Little]);
            }
        }
    }

    #[test]
    fn a_neighbor_that_is_late_follows_while_the_other_finger_goes_back() {
        let mut flexion = Flexion::default();
        // 40 ms down by 15 mm and 40 ms up, and the middle finger by 0.45 of it 25 ms later.
        let way = |ms: u64| 15.0 * (1.0 - (ms.min(80) as f32 / 40.0 - 1.0).abs());
        for ms in (0..=65_u64).step_by(5) {
            let middle = 0.45 * way(ms.saturating_sub(25));
            let pose = pose(Side::Right, [0.0, way(ms), middle, 0.0, 0.0], 0.0);
            flexion.push(&pose, Duration::from_millis(5));
        }
        let index = FingerSet::NONE.with(Finger::Index);
        assert!(flexion.follows(Finger::Middle, index));
        assert!(!flexion.follows(Finger::Middle, FingerSet::NONE));
        // Another finger that bends as far as the first one does not.
        let pose = pose(Side::Right, [0.0, 0.0, 6.0, 15.0, 0.0], 0.0);
        flexion.push(&pose, Duration::from_millis(5));
        assert!(!flexion.follows(Finger::Ring, FingerSet::ALL));
    }

    #[test]
    fn fingers_of_a_hand_that_goes_down_as_a_whole_do_not_follow() {
        let flexion = after(Side::Right, [0.0, 1.0, 0.5, 0.0, 3.0], 0.4);
        assert!(
            !Finger::ALL
                .iter()
                .any(|it| flexion.follows(*it, FingerSet::ALL))
        );
    }

    #[test]
    fn a_finger_of_which_one_point_is_seen_follows_none() {
        let mut flexion = Flexion::default();
        for step in 0..=8 {
            let bends = [2.0 * step as f32, 0.0, 0.0, 0.0, 0.0];
            let mut pose = pose(Side::Right, bends, 0.0);
            let seen = pose.position(knuckle(Finger::Index));
            pose.set(
                Joint::IndexTip,
                Pose::from_translation(seen.expect("it is set")),
            );
            flexion.push(&pose, Duration::from_millis(5));
        }
        assert!(!flexion.follows(Finger::Index, FingerSet::NONE));
        assert!(flexion.follows(Finger::Middle, FingerSet::NONE));
    }

    #[test]
    fn a_way_fades_and_a_jump_forgets_it() {
        let ways = [0.0, 15.0, 0.0, 0.0, 0.0];
        let mut flexion = after(Side::Right, ways, 0.0);
        assert!(flexion.follows(Finger::Middle, FingerSet::ALL));
        let mut pose = pose(Side::Right, ways, 0.0);
        let mut later = flexion;
        later.push(&pose, Duration::from_millis(300));
        assert!(!later.follows(Finger::Middle, FingerSet::ALL));
        pose.jumped = true;
        flexion.push(&pose, Duration::from_millis(5));
        assert!(!flexion.follows(Finger::Middle, FingerSet::ALL));
    }
}
