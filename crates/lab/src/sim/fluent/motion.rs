//! Strokes of a hand, and what its sensors show of them.

use parry3d::math::{Vec2, Vec3};

use super::aim::{goal_of, within_plane};
use super::hand::{FluentHand, STRAIGHT, StrokePlan};
use super::timeline::{Bump, Timeline};
use crate::capture::Sample;
use crate::contact::TargetId;
use crate::contact::surface::{Scene, Shape};
use crate::estimate::JointAngles;
use crate::hand::{Dof, Finger};
use crate::sim::unsteadiness::SHARES;

/// The height of a fingertip above the keys between two strokes, in metres.
const HOVER: f32 = 0.014;
/// The height of a fingertip above the keys where a hand changes to another finger, in metres: fingers that extend or bend, and an arm that
/// turns, leave a straight line by up to 30 mm.
const LIFT: f32 = 0.05;
/// The height of a fingertip above the keys at the start, in metres.
const START_HEIGHT: f32 = 0.03;
/// The delay with which neighbors follow a pressing finger, in seconds: 10 to 25 ms ?.
const ENSLAVING_DELAY: f64 = 0.015;
/// The part of the way down that is left when a finger arrives above its key.
const EARLY: f64 = 0.7;
/// The part of the way up after which a hand sets out for the next key.
const DEPARTURE: f64 = 0.5;
/// Bend of fingers that press by bending, as a fraction of their range.
const BENT: f64 = 0.85;
/// The deviation of a bend for each millimetre of depth scatter: 60 mm of travel are a whole bend ?.
const BEND_PER_MM: f64 = 1.0 / 60.0;
/// The fastest flexion of a finger, in rad/s; the highest speed of a minimum-jerk movement is 1.875 times its mean.
const FASTEST: f64 = 18.0;
const PEAK: f64 = 1.875;
/// The deviation of the times of the fingers of a chord, in seconds ?, and the most deviations by which one differs.
const CHORD_SPREAD: f64 = 0.01;
const MOST_SPREADS: f64 = 4.0;
/// The depth of a tap that is too shallow, as a part of the way to the front.
const SHALLOW: f32 = 0.5;

/// Ranges of joints that count as comfortable, in degrees: the flexion of the wrist as in RULA (McAtamney &
/// Corlett 1993), the others ?.
const COMFORTABLE: [(Dof, f64, f64); 7] = [
    (Dof::WristFlexion, -15.0, 15.0),
    (Dof::WristDeviation, -10.0, 10.0),
    (Dof::IndexMcpFlexion, -30.0, 60.0),
    (Dof::MiddleMcpFlexion, -30.0, 60.0),
    (Dof::RingMcpFlexion, -30.0, 60.0),
    (Dof::LittleMcpFlexion, -30.0, 60.0),
    (Dof::IndexPipFlexion, 0.0, 80.0),
];

/// A tap on a target.
#[derive(Clone, Copy, Debug)]
pub struct Tap {
    /// The target.
    pub target: TargetId,
    /// The finger.
    pub finger: Finger,
    /// The intended place from the center of the target, in metres.
    pub shift: Vec2,
    /// The time at which the person wants to be at the lowest point, in seconds.
    pub wanted: f64,
    /// The time from which the hand may move, in seconds.
    pub now: f64,
    /// `true` for a tap that does not reach the target.
    pub is_shallow: bool,
    /// `true` for a tap without an error of its place.
    pub is_exact: bool,
}

impl FluentHand {
    /// Plans a tap with the errors of the person; `None` if the finger cannot reach the target.
    pub fn tap(&mut self, scene: &Scene, tap: Tap) -> Option<StrokePlan> {
        let aim = self.learn(scene, tap.target, tap.finger)?;
        let (_, found) = scene.target(tap.target)?;
        let size = match found.shape {
            Shape::Box(half) => half * 2.0,
            Shape::Disc(radius) => Vec2::splat(radius * 2.0),
        };
        let center = tap.shift.extend(HOVER);
        let goal = goal_of(scene, tap.target, &aim, center)?;
        let place = goal - self.reach_of(tap.finger);
        let moved = self.last_place.map_or(Vec3::ZERO, |last| place - last);
        let distance = f64::from(moved.length());
        let along = within_plane(scene, tap.target, &aim, moved)?;
        let error = self.error(tap.finger, size, along);
        let point = tap.shift + if tap.is_exact { Vec2::ZERO } else { error };
        let depth = self.depth(found.travel, tap.is_shallow);
        let (above, reached) = self.posture_at(scene, tap.target, &aim, point.extend(HOVER))?;
        let (below, _) = self.posture_at(scene, tap.target, &aim, point.extend(depth))?;
        self.last_place = Some(reached - self.reach_of(tap.finger));

        let press = self.person.press_ms * 1e-3;
        let dwell = self.draw.log_normal(self.person.dwell_ms, 0.25) * 1e-3;
        let depart = self.free_at.max(self.timeline.settled_at()).max(tap.now);
        let width = f64::from(size.min_element());
        let shortest = self.person.movement_time(distance, width);
        let lifted = self.lifted(scene, tap, &aim, point);
        let ways = self.ways(lifted, above.clone());
        let turning: f64 = ways.iter().map(|(_, seconds)| seconds).sum();
        let bottom = tap
            .wanted
            .max(depart + shortest.max(turning + EARLY * press));
        let arrival = (bottom - EARLY * press).max(depart + 0.5 * shortest);
        let release = bottom + dwell;
        self.last_tap = Some((tap.target, tap.finger, point));
        self.travel(ways, depart, arrival - depart - turning);
        let change: Vec<f64> = below.iter().zip(&above).map(|(b, a)| b - a).collect();
        let bump = Bump {
            change,
            start: bottom - press,
            down: press,
            release,
            up: press,
        };
        self.enslave(tap.finger, &bump);
        self.slip(scene, tap, &aim, (point, depth, &below), &bump);
        self.timeline.add(bump);
        self.free_at = release + DEPARTURE * press;
        Some(StrokePlan {
            target: tap.target,
            finger: tap.finger,
            bottom,
            end: release + press,
            distance,
            point,
        })
    }

    /// Returns the shortest time in which a finger bends to press, in seconds.
    fn bend_time(&self) -> f64 {
        let hand = self.typing_hand(Finger::Index);
        let times = Finger::ALL.iter().map(|&finger| {
            let mut bent = self.initial.clone();
            for (index, value) in hand.values_at_bend(finger, BENT) {
                bent[index] = value;
            }
            self.turn_time(&self.initial, &bent)
        });
        times.fold(0.0, f64::max)
    }

    /// Returns the shortest time from one posture to another, in seconds: no finger bends faster than [`FASTEST`].
    fn turn_time(&self, from: &[f64], to: &[f64]) -> f64 {
        let hand = self.typing_hand(Finger::Index);
        let (from, to) = (hand.angles(from), hand.angles(to));
        let joints = Finger::FLEXIONS.as_flattened().iter();
        let turns = joints.map(|&dof| (to.get(dof) - from.get(dof)).abs());
        PEAK * turns.fold(0.0, f64::max) / FASTEST
    }

    /// Returns the postures on the way to another finger: the last finger high above its last key, and the new one high above the next.
    fn lifted(
        &mut self,
        scene: &Scene,
        tap: Tap,
        aim: &super::aim::Aim,
        point: Vec2,
    ) -> Option<[Vec<f64>; 2]> {
        let (target, finger, last) = self.last_tap?;
        if finger == tap.finger {
            return None;
        }
        let last_aim = self.learn(scene, target, finger)?;
        let (old, _) = self.posture_at(scene, target, &last_aim, last.extend(LIFT))?;
        let (new, _) = self.posture_at(scene, tap.target, aim, point.extend(LIFT))?;
        Some([old, new])
    }

    /// Returns the postures on the way to one of a finger, with the shortest time to each in seconds. With another finger than the last
    /// one, the hand goes by postures high above the keys, so that neither touches a key on the way.
    fn ways(&self, lifted: Option<[Vec<f64>; 2]>, above: Vec<f64>) -> Vec<(Vec<f64>, f64)> {
        let mut ways: Vec<(Vec<f64>, f64)> = Vec::new();
        for posture in lifted.into_iter().flatten().chain([above]) {
            let last = ways.last().map(|(last, _)| last.as_slice());
            let seconds = self.turn_time(last.unwrap_or(self.timeline.goal()), &posture);
            ways.push((posture, seconds));
        }
        ways
    }

    /// Goes ways one after another, with `spare` seconds more than they take at least.
    fn travel(&mut self, ways: Vec<(Vec<f64>, f64)>, depart: f64, spare: f64) {
        let each = spare / ways.len() as f64;
        let mut start = depart;
        for (posture, seconds) in ways {
            self.timeline.go_to(posture, start, seconds + each);
            start += seconds + each;
        }
    }

    /// Starts above a target, clear of all keys, if nothing has moved yet.
    pub fn start_above(&mut self, scene: &Scene, target: TargetId, finger: Finger) {
        let aim = self.learn(scene, target, finger);
        let posture =
            aim.and_then(|aim| self.posture_at(scene, target, &aim, Vec3::Z * START_HEIGHT));
        if let Some((posture, _)) = posture {
            self.timeline = Timeline::new(posture);
            self.last_tap = Some((target, finger, Vec2::ZERO));
        }
    }

    /// Plans a bend of fingers, and their return; `None` if a target is not pressed by bending.
    pub fn chord(
        &mut self,
        scene: &Scene,
        targets: &[TargetId],
        wanted: f64,
        now: f64,
        is_shallow: bool,
    ) -> Option<StrokePlan> {
        let press = (self.person.press_ms * 1e-3).max(self.bend_time());
        let dwell = self.draw.log_normal(self.person.dwell_ms.max(60.0), 0.25) * 1e-3;
        let depart = self.free_at.max(now);
        let bottom = wanted.max(depart + press + MOST_SPREADS * CHORD_SPREAD);
        let mut first = None;
        for &target in targets {
            let (surface, _) = scene.target(target)?;
            let finger = surface.bent_by(target)?;
            _ = first.get_or_insert((target, finger));
            let scatter = self.person.depth_scatter * BEND_PER_MM;
            let bend = if is_shallow {
                0.3
            } else {
                BENT + scatter * self.draw.normal()
            };
            // No finger sets out before the hand is free.
            let spreads = self.draw.normal().clamp(-MOST_SPREADS, MOST_SPREADS);
            let spread = CHORD_SPREAD * spreads;
            let mut change = vec![0.0; self.values.len()];
            let hand = self.typing_hand(Finger::Index);
            let straight = hand.values_at_bend(finger, STRAIGHT);
            for (index, value) in hand.values_at_bend(finger, bend.clamp(0.0, 1.0)) {
                let rest = straight.iter().find(|(other, _)| *other == index);
                change[index] = value - rest.map_or(value, |(_, rest)| *rest);
            }
            let bump = Bump {
                change,
                start: bottom - press + spread,
                down: press,
                release: bottom + dwell + spread,
                up: press,
            };
            self.enslave(finger, &bump);
            self.timeline.add(bump);
        }
        let (target, finger) = first?;
        self.free_at = bottom + dwell + press;
        Some(StrokePlan {
            target,
            finger,
            bottom,
            end: self.free_at,
            distance: 0.0,
            point: Vec2::ZERO,
        })
    }

    /// Moves to a time in seconds and writes what the sensors show; returns `false` for a lost picture. Times ascend by `step`.
    pub fn sample(&mut self, seconds: f64, step: f64, sample: &mut Sample) -> bool {
        let mut values = std::mem::take(&mut self.values);
        self.timeline.posture(seconds, &mut values);
        // Movements that add up end at the limits of the joints.
        let variables = &self.typing_hand(Finger::Index).variables;
        for (value, variable) in values.iter_mut().zip(variables) {
            *value = value.clamp(variable.range.0, variable.range.1);
        }
        let mut angles = self.typing_hand(Finger::Index).angles(&values);
        self.values = values;
        for unsteadiness in &mut self.unsteadiness {
            unsteadiness.apply(&mut angles, None, seconds);
        }
        self.bear(&angles, step);
        self.sensors.measure(&self.own, &angles, step, sample)
    }

    fn bear(&mut self, angles: &JointAngles, step: f64) {
        if let Some(last) = &self.last_angles {
            let turn = |(now, before): (&f64, &f64)| (now - before).abs();
            let second = Dof::ForearmSecondBone.index();
            let twice = turn((&angles.radians()[second], &last.radians()[second]));
            // Several sums, which a vector register holds.
            let mut sums = [0.0; 4];
            let chunks = angles.radians().chunks(4).zip(last.radians().chunks(4));
            for (now, before) in chunks {
                for (sum, pair) in sums.iter_mut().zip(now.iter().zip(before)) {
                    *sum += turn(pair);
                }
            }
            self.load.travel += sums.iter().sum::<f64>() - twice;
        }
        self.last_angles = Some(*angles);
        self.load.seconds += step;
        let is_outside = |&(dof, low, high): &(Dof, f64, f64)| {
            !(low..=high).contains(&angles.get(dof).to_degrees())
        };
        if COMFORTABLE.iter().any(is_outside) {
            self.load.uncomfortable += step;
        }
    }

    /// Returns where a fingertip is relative to the index finger of a half bent hand (world, metres).
    fn reach_of(&self, finger: Finger) -> Vec3 {
        let pose = &self.half_bent;
        let tips = pose.fingertip(finger).zip(pose.fingertip(Finger::Index));
        tips.map_or(Vec3::ZERO, |(own, index)| own - index)
    }

    /// Returns the error of the place of a tap along the X and Y of the target, in metres: scatter that is stretched along the movement
    /// within the plane of the target, the offset of the finger, and the drift of the hand.
    fn error(&mut self, finger: Finger, size: Vec2, moved: Vec2) -> Vec2 {
        let step = (self.person.drift * 1e-3) as f32;
        let walk = Vec2::new(self.draw.normal() as f32, self.draw.normal() as f32) * step;
        self.drift = self.drift * self.person.drift_kept as f32 + walk;
        let deviation = self.person.deviation_at(size);
        let scatter = Vec2::new(self.draw.normal() as f32, self.draw.normal() as f32) * deviation;
        let along = moved.normalize_or_zero();
        let stretch = (1.0 + self.person.elongation).sqrt() as f32;
        let part = scatter.dot(along);
        let stretched = if along == Vec2::ZERO {
            scatter
        } else {
            along * part * stretch + (scatter - along * part) / stretch
        };
        let [x, y] = self.person.offsets[finger.index()];
        stretched + self.drift + Vec2::new(x as f32, y as f32) * 1e-3
    }

    /// Returns the lowest height of the pad above the front of a target, in metres.
    fn depth(&mut self, travel: f32, is_shallow: bool) -> f32 {
        if is_shallow {
            return HOVER * (1.0 - SHALLOW);
        }
        let beyond = self.person.depth + self.person.depth_scatter * self.draw.normal();
        -travel - (beyond * 1e-3) as f32
    }

    /// Lets the neighbors of a pressing finger follow it.
    fn enslave(&mut self, master: Finger, bump: &Bump) {
        if self.person.enslaving <= 0.0 {
            return;
        }
        let hand = self.typing_hand(Finger::Index);
        let gain = |index: usize, dof: Dof| {
            let mut mappings = hand.variables[index].mappings.iter().rev();
            let found = mappings.find(|(mapped, _)| *mapped == dof);
            found.map(|(_, map)| map.gain)
        };
        let mut change = vec![0.0; bump.change.len()];
        for &slave in Finger::ALL {
            let share = self.person.enslaving * SHARES[master.index()][slave.index()];
            let joints = Finger::FLEXIONS[master.index()].into_iter();
            for (own, other) in joints.zip(Finger::FLEXIONS[slave.index()]) {
                let indices = hand.index_of(own).zip(hand.index_of(other));
                let Some((own_index, other_index)) = indices.filter(|(from, to)| from != to) else {
                    continue;
                };
                // The sensors of a glove have counts of different sizes for one angle.
                if let Some((from, to)) = gain(own_index, own).zip(gain(other_index, other)) {
                    change[other_index] = share * bump.change[own_index] * from / to;
                }
            }
        }
        self.timeline.add(Bump {
            change,
            start: bump.start + ENSLAVING_DELAY,
            release: bump.release + ENSLAVING_DELAY,
            ..*bump
        });
    }

    /// Adds a slip sideways while the target is down.
    fn slip(
        &mut self,
        scene: &Scene,
        tap: Tap,
        aim: &super::aim::Aim,
        (point, depth, below): (Vec2, f32, &[f64]),
        bump: &Bump,
    ) {
        let length = self.person.slip * 1e-3 * self.draw.between(0.0, 1.0);
        let direction = self.draw.between(0.0, std::f64::consts::TAU) as f32;
        if length <= 0.0 {
            return;
        }
        let slipped = point + Vec2::from_angle(direction) * length as f32;
        let Some((posture, _)) = self.posture_at(scene, tap.target, aim, slipped.extend(depth))
        else {
            return;
        };
        self.timeline.add(Bump {
            change: posture.iter().zip(below).map(|(s, b)| s - b).collect(),
            // From the moment at which the finger feels the key.
            start: bump.start + 0.6 * bump.down,
            ..*bump
        });
    }
}

#[cfg(test)]
mod tests {
    use super::super::hand::{HandSetup, StartPosture};
    use super::super::sensors::SourceKind;
    use super::*;
    use crate::document::Document;
    use crate::hand::Side;
    use crate::kinematics::ArmModel;
    use crate::layout::Glove;
    use crate::people::{Participant, People, population};
    use crate::sim::motor::TypingKeys;

    #[test]
    fn neighbors_follow_by_a_part_of_the_angle_whatever_a_glove_counts() {
        let person = Participant {
            enslaving: 1.0,
            ..population(&People::Drawn(1), None, 1).remove(0)
        };
        let arm = ArmModel::anthropometric(Side::Right, &person.assumed).expect("an arm");
        let document = Document::shipped("unam-hc11").expect("a shipped glove");
        let glove = Glove::parse(&document).expect("a glove").map;
        for (source, map) in [(SourceKind::Ideal, None), (SourceKind::Glove, Some(&glove))] {
            let setup = HandSetup {
                assumed: &arm,
                own: &arm,
                map,
                source,
            };
            let keys = TypingKeys::default();
            let mut hand = FluentHand::new(setup, &person, &keys, StartPosture::Relaxed);
            let typing = hand.typing_hand(Finger::Index).clone();
            let (mut values, before) = (hand.initial.clone(), typing.angles(&hand.initial));
            let middle = typing.index_of(Dof::MiddleMcpFlexion).expect("a joint");
            let bent = before.get(Dof::MiddleMcpFlexion) + 0.3;
            let mut change = vec![0.0; values.len()];
            change[middle] = typing.value_near(middle, bent) - values[middle];
            let bump = Bump {
                change,
                start: 0.0,
                down: 0.1,
                release: 1.0,
                up: 0.1,
            };
            hand.enslave(Finger::Middle, &bump);
            hand.timeline.posture(0.5, &mut values);
            let followed = typing.angles(&values);
            for (dof, finger) in [
                (Dof::IndexMcpFlexion, Finger::Index),
                (Dof::RingMcpFlexion, Finger::Ring),
                (Dof::LittleMcpFlexion, Finger::Little),
            ] {
                let turn = followed.get(dof) - before.get(dof);
                let share = SHARES[Finger::Middle.index()][finger.index()];
                assert!((turn - 0.3 * share).abs() < 1e-6, "{source} {dof}: {turn}");
            }
        }
    }
}
