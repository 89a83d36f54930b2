//! A typist who looks at the screen.

use ademan::capture::Reading;
use ademan::contact::surface::Scene;
use ademan::estimate::{ChannelMap, Estimate, JointAngles, JointLimits};
use ademan::hand::Finger;
use ademan::kinematics::ArmModel;
use ademan::sim::{HandAction, SimulatedWearer, TypingHand};
use ademan::time::Timestamp;
use parry3d::math::Vec3;

use crate::key_reach::KeyReach;

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

    /// Returns the readings of a hand that makes these taps. Other actions, and targets that the scene lacks, are left out.
    pub fn tap_all(mut self, taps: &[HandAction]) -> Vec<Reading> {
        for action in taps {
            let HandAction::Tap(point) = action else {
                continue;
            };
            let Some(key) = KeyReach::new(&self.seen.at_rest, self.scene, point.target) else {
                continue;
            };
            let is_first = self.readings.is_empty();
            self.tap(&key);
            if is_first {
                self.wait(CLEAR_PACKETS);
                self.tap(&key);
            }
        }
        self.wait(CLEAR_PACKETS);
        self.readings
    }

    fn tap(&mut self, key: &KeyReach) {
        let is_first = self.readings.is_empty();
        let arrival = key.tip(ARRIVAL);
        self.go_to(arrival, TRAVEL_PACKETS);
        self.correct(arrival);
        if is_first {
            return;
        }
        let above = key.hover();
        self.go_to(above, SHORT_PACKETS);
        self.correct(above);
        self.press(key);
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
    fn press(&mut self, key: &KeyReach) {
        let below = key.bottom();
        self.go_to(below, SHORT_PACKETS);
        for _ in 0..self.corrections {
            self.wait(SEE_PACKETS);
            let is_down = self
                .look()
                .is_none_or(|seen| key.height(seen) <= -key.travel - DOWN);
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
        self.difference = seen - self.own_tip();
        Some(seen)
    }

    /// Returns the own fingertip (world, metres).
    fn own_tip(&self) -> Vec3 {
        let pose = self.hand.pose(&self.values);
        pose.fingertip(Finger::Index).expect("an index finger")
    }

    /// Moves the own fingertip on a line to the place where it should be seen at `goal`.
    fn go_to(&mut self, goal: Vec3, packets: u32) {
        let start = self.own_tip();
        let end = goal - self.difference;
        for packet in 1..=packets {
            let time = packet as f32 / packets as f32;
            // Minimum jerk (Flash & Hogan 1985).
            let t = time.powi(3) * (10.0 + time * (-15.0 + 6.0 * time));
            self.hand.reach(start.lerp(end, t), &mut self.values, &[]);
            self.send();
        }
    }

    fn wait(&mut self, packets: u32) {
        for _ in 0..packets {
            self.send();
        }
    }

    fn send(&mut self) {
        let angles = self.hand.angles(&self.values);
        self.readings.push(self.wearer.send(&angles));
    }
}
