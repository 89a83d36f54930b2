//! A typist who looks at the screen.

use parry3d::math::Vec3;

use super::SimulatedWearer;
use crate::capture::Reading;
use crate::contact::TargetId;
use crate::contact::surface::Scene;
use crate::estimate::{ChannelMap, Estimate, JointAngles, JointLimits};
use crate::hand::Finger;
use crate::kinematics::ArmModel;
use crate::sim::action::TargetPoint;
use crate::sim::movement::minimum_jerk;
use crate::sim::reach_target::ReachTarget;
use crate::sim::typing_hand::TypingHand;
use crate::time::Timestamp;

/// The height above a key's front at which a fingertip arrives, in metres: a finger moves to another key in an arc.
const ARRIVAL: f32 = 0.03;
/// The depth beyond the travel of a key at which it is seen to be down, in metres.
const DOWN: f32 = 0.001;
/// The distance of the seen fingertip from its goal that needs no correction, in metres.
const CLOSE: f32 = 0.0025;
/// The packets of a movement to another key: about 0.4 s.
const TRAVEL_PACKETS: u32 = 24;
/// The packets of a correction and of a press: about 0.2 s.
const SHORT_PACKETS: u32 = 12;
/// The packets for which the hand waits to see where it is: about 0.2 s.
const SEE_PACKETS: u32 = 12;
/// The packets at rest before the first key: the output is armed after 0.3 s.
const CLEAR_PACKETS: u32 = 60;

/// A person who types with the index finger and sees the hand of the program on the board.
///
/// A movement is planned with the own arm, from the difference between the own and the seen fingertip that was seen last. At its end
/// the person sees where the fingertip is for the program, and corrects a limited number of times.
pub struct SightedTypist<'a> {
    wearer: &'a mut SimulatedWearer,
    hand: TypingHand,
    seen: SeenHand<'a>,
    scene: &'a Scene,
    values: Vec<f64>,
    /// The seen fingertip minus the own one, in metres.
    difference: Vec3,
    corrections: usize,
    readings: Vec<Reading>,
}

/// The hand as the program shows it.
struct SeenHand<'a> {
    arm: &'a ArmModel,
    map: &'a ChannelMap,
    at_rest: TypingHand,
}

impl SeenHand<'_> {
    /// Returns the index fingertip in the world (metres).
    fn tip(&self, wearer: &SimulatedWearer, angles: &JointAngles) -> Option<Vec3> {
        let counts = wearer.sensors().exact(angles);
        let limits = JointLimits::human();
        let mut seen = JointAngles::default();
        for row in self.map.rows() {
            let radians = self.map.radians(row, counts[row.channel]);
            seen.set(row.dof, limits.clamp(row.dof, radians));
        }
        for &(dof, radians) in self.map.assumed_angles() {
            seen.set(dof, radians);
        }
        let pose = self.arm.forward(&Estimate::new(Timestamp(0), seen));
        pose.fingertip(Finger::Index)
    }
}

impl<'a> SightedTypist<'a> {
    /// Creates a typist on the boards of a scene. `map` and `arm` are the program's own. The person makes up to `corrections`
    /// corrections on the way to a key, and as many while pressing it.
    pub fn new(
        wearer: &'a mut SimulatedWearer,
        scene: &'a Scene,
        map: &'a ChannelMap,
        arm: &'a ArmModel,
        corrections: usize,
    ) -> Self {
        let hand = TypingHand::without_glove(wearer.arm());
        Self {
            values: hand.rest_values(),
            hand,
            seen: SeenHand {
                arm,
                map,
                at_rest: TypingHand::new(arm, map),
            },
            wearer,
            scene,
            difference: Vec3::ZERO,
            corrections,
            readings: Vec::new(),
        }
    }

    /// Returns the readings of a hand that taps these targets. Targets that the scene lacks are left out.
    pub fn tap_all(mut self, targets: &[TargetId]) -> Vec<Reading> {
        for (index, &target) in targets.iter().enumerate() {
            let Some(reach) = self.seen.at_rest.reach_target(self.scene, target) else {
                continue;
            };
            let point = TargetPoint {
                target,
                offset: Default::default(),
            };
            self.tap(&reach, point);
            if index == 0 {
                self.rest();
                self.tap(&reach, point);
            }
        }
        self.rest();
        self.readings
    }

    fn tap(&mut self, reach: &ReachTarget, point: TargetPoint) {
        let is_first = self.readings.is_empty();
        let arrival = reach.tip_position(point, ARRIVAL);
        self.go_to(arrival, TRAVEL_PACKETS);
        self.correct(arrival);
        if is_first {
            return;
        }
        let above = reach.tip_position(point, reach.hover_height);
        self.go_to(above, SHORT_PACKETS);
        self.correct(above);
        self.press(reach, point);
        self.go_to(arrival, SHORT_PACKETS);
    }

    /// Moves the fingertip until it is seen at `goal`, or until the corrections are used up.
    fn correct(&mut self, goal: Vec3) {
        for _ in 0..self.corrections {
            self.wait(SEE_PACKETS);
            let is_close = self.look().is_none_or(|seen| seen.distance(goal) <= CLOSE);
            if is_close {
                return;
            }
            self.go_to(goal, SHORT_PACKETS);
        }
    }

    /// Presses a key until it is seen to be down, or until the corrections are used up.
    fn press(&mut self, reach: &ReachTarget, point: TargetPoint) {
        let below = reach.tip_position(point, reach.bottom_height);
        self.go_to(below, SHORT_PACKETS);
        for _ in 0..self.corrections {
            self.wait(SEE_PACKETS);
            let is_down = self
                .look()
                .is_none_or(|seen| reach.pad_position(seen).z <= -reach.travel - DOWN);
            if is_down {
                return;
            }
            self.go_to(below, SHORT_PACKETS);
        }
        self.wait(SHORT_PACKETS);
    }

    /// Sees the fingertip (world, metres) and remembers its difference from the own one.
    fn look(&mut self) -> Option<Vec3> {
        let angles = self.hand.angles(&self.values);
        let seen = self.seen.tip(self.wearer, &angles)?;
        self.difference = seen - self.hand.tip(&self.values);
        Some(seen)
    }

    /// Moves the own fingertip on a line to the place where it should be seen at `goal`.
    fn go_to(&mut self, goal: Vec3, packets: u32) {
        let start = self.hand.tip(&self.values);
        let end = goal - self.difference;
        for packet in 1..=packets {
            let t = minimum_jerk(packet as f32 / packets as f32);
            self.hand.reach(start.lerp(end, t), &mut self.values, &[]);
            self.send();
        }
    }

    fn wait(&mut self, packets: u32) {
        for _ in 0..packets {
            self.send();
        }
    }

    fn rest(&mut self) {
        self.wait(CLEAR_PACKETS);
    }

    fn send(&mut self) {
        let angles = self.hand.angles(&self.values);
        self.readings.push(self.wearer.send(&angles));
    }
}
