//! One hand of the simulated person, in a glove or followed by another sensor.

use std::time::Duration;

use arrayvec::ArrayVec;

use super::action::HandAction;
use super::action_error::ActionError;
use super::glove_sensor::GloveSensor;
use super::motor::Motor;
use super::movement::{ActiveMovement, InputChange, Movement};
use super::noise::Noise;
use super::planner;
use super::sensor::{BodyPosture, JointSensor, Sensor};
use super::settings::TypistSettings;
use super::tremor::Tremor;
use super::typing_hand::TypingHand;
use super::unsteadiness::Unsteadiness;
use crate::capture::{MAX_CHANNELS, Sample};
use crate::contact::surface::Scene;
use crate::hand::Finger;
use crate::kinematics::ArmModel;

/// The counts of all channels of a glove.
pub type GloveCounts = ArrayVec<u16, MAX_CHANNELS>;

/// A hand that performs its own actions, up to a limit that the typist sets.
#[derive(Clone)]
pub(super) struct SimulatedHand {
    hand: TypingHand,
    values: Vec<f64>,
    movements: std::vec::IntoIter<Movement>,
    /// Number of movements up to the end of each action.
    action_ends: Vec<usize>,
    /// Number of movements that have begun.
    begun: usize,
    active: Option<ActiveMovement>,
    /// Number of packets of the active movement so far.
    packet: u32,
    /// `true` if the fingertip presses a target after the movements so far.
    is_pressed: bool,
    /// The finger of the active or last movement.
    finger: Finger,
    motor: Motor,
    unsteadiness: Unsteadiness,
    /// Number of samples so far.
    samples: u64,
    /// Time between two samples.
    period: Duration,
    sensor: HandSensor,
    tremor: Tremor,
    /// The angles of head and legs.
    body: BodyPosture,
}

/// The sensor of the joint angles of a hand.
#[derive(Clone)]
enum HandSensor {
    Glove(GloveSensor),
    Joints(JointSensor, Noise),
}

/// The progress of a hand in one packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Progress {
    /// A movement continued.
    Moved,
    /// The hand keeps its posture until it may perform its next action.
    Waiting,
    /// All actions are done.
    Finished,
}

impl SimulatedHand {
    /// Plans actions in a scene for an arm with a sensor.
    pub(super) fn new(
        settings: &TypistSettings,
        actions: &[HandAction],
        scene: &Scene,
        arm: &ArmModel,
        sensor: Sensor,
    ) -> Result<Self, ActionError> {
        let noise = Noise::new(settings.noise, settings.seed);
        let (hand, sensor) = match sensor {
            Sensor::Glove(map) => (
                TypingHand::new(arm, map),
                HandSensor::Glove(GloveSensor::new(map, noise)),
            ),
            Sensor::Joints(sensor) => {
                let hand = TypingHand::without_glove(arm);
                let hand = match sensor {
                    JointSensor::Displacement => hand.stiffened(),
                    JointSensor::Body => hand.with_body(),
                    _ => hand,
                };
                (hand, HandSensor::Joints(sensor, noise))
            }
        };
        let person = &settings.person;
        let hand = hand
            .with_limits(&person.limits)
            .with_resting(person.resting);
        let motor = Motor::new(person, arm.side(), &settings.keys, settings.seed);
        let plan = planner::plan(actions, hand, &motor, scene, settings.packet_period)?;
        Ok(Self {
            hand: plan.hand,
            values: plan.start_values,
            movements: plan.movements.into_iter(),
            action_ends: plan.action_ends,
            begun: 0,
            active: None,
            packet: 0,
            is_pressed: false,
            finger: Finger::Index,
            motor,
            unsteadiness: Unsteadiness::new(&person.motion, arm, settings.seed),
            samples: 0,
            period: settings.packet_period,
            sensor,
            tremor: Tremor::default(),
            body: BodyPosture::default(),
        })
    }

    /// Advances by one packet within the first `actions` actions. With all actions permitted, the hand also returns to
    /// its rest posture.
    pub(super) fn advance(&mut self, actions: usize) -> Progress {
        if self.active.is_none() {
            if self.movements.len() == 0 {
                return Progress::Finished;
            }
            if self.waits_within(actions) {
                return Progress::Waiting;
            }
            self.begin();
        }
        let Some(active) = &self.active else {
            return Progress::Finished;
        };
        self.packet += 1;
        let fraction = self.packet as f32 / active.packets() as f32;
        active.step(fraction, &self.hand, &mut self.values);
        if self.packet == active.packets() {
            self.is_pressed = active.ends_down();
            self.active = None;
            self.packet = 0;
        }
        Progress::Moved
    }

    /// Returns `true` if the next movement is beyond the first `actions` actions, and another action follows them.
    fn waits_within(&self, actions: usize) -> bool {
        if actions >= self.action_ends.len() {
            return false;
        }
        // The first movement shows the hand before the first action.
        let last = actions.checked_sub(1);
        let end = last.map_or(1, |last| self.action_ends[last]);
        self.begun >= end
    }

    fn begin(&mut self) {
        self.begun += 1;
        let movement = self.movements.next();
        if let Some(movement) = &movement {
            self.finger = movement.effector.finger;
        }
        self.active =
            movement.map(|movement| ActiveMovement::begin(movement, &mut self.hand, &self.values));
        let input = self.active.as_ref().and_then(ActiveMovement::input);
        match (input, &mut self.sensor) {
            (Some(InputChange::Glove(input, value)), HandSensor::Glove(glove)) => {
                glove.set_input(input, value);
            }
            (Some(InputChange::Body(angle, radians)), _) => self.body.set(angle, radians),
            _ => {}
        }
    }

    /// Returns `true` if the first `actions` actions are done, even if the hand moves on.
    pub(super) fn has_done(&self, actions: usize) -> bool {
        let last = actions.checked_sub(1);
        let end = last.and_then(|last| self.action_ends.get(last));
        end.is_none_or(|&end| self.begun > end) || self.has_finished(actions)
    }

    /// Returns the hand.
    pub(super) fn hand(&self) -> &TypingHand {
        &self.hand
    }

    /// Returns the motor model of the person.
    pub(super) fn motor(&self) -> &Motor {
        &self.motor
    }

    /// Returns the present posture.
    pub(super) fn values(&self) -> &[f64] {
        &self.values
    }

    /// Sets the posture at once, before the first sample.
    pub(super) fn set_posture(&mut self, values: &[f64]) {
        self.values.copy_from_slice(values);
    }

    /// Copies the posture, the inputs and the time of another hand. Returns `false`, and copies nothing, if its channels differ in
    /// number.
    pub(super) fn continue_from(&mut self, other: &Self) -> bool {
        if self.values.len() != other.values.len() {
            return false;
        }
        self.values.copy_from_slice(&other.values);
        (self.body, self.finger, self.samples) = (other.body, other.finger, other.samples);
        if let (HandSensor::Glove(glove), HandSensor::Glove(other)) =
            (&mut self.sensor, &other.sensor)
        {
            glove.keep_inputs(other);
        }
        true
    }

    /// Returns `true` if the fingertip presses a target, or is on its way down to one or up from it.
    pub(super) fn is_down(&self) -> bool {
        self.active
            .as_ref()
            .map_or(self.is_pressed, ActiveMovement::is_down)
    }

    /// Returns `true` if the fingertip has pressed and only has to lift.
    pub(super) fn is_lifting(&self) -> bool {
        let lifts = |movement: &Movement| movement.is_down && !movement.ends_down;
        match &self.active {
            Some(active) if active.is_down() && !active.ends_down() => true,
            _ => self.movements.as_slice().first().is_some_and(lifts),
        }
    }

    /// Returns `true` if movements are left.
    pub(super) fn has_movements(&self) -> bool {
        self.active.is_some() || self.movements.len() > 0
    }

    /// Adds movements to a hand that has none.
    pub(super) fn append(&mut self, movements: Vec<Movement>) {
        self.movements = movements.into_iter();
        self.action_ends = vec![0];
    }

    /// Drops all movements and keeps the present posture.
    pub(super) fn stop(&mut self) {
        self.append(Vec::new());
        self.active = None;
        self.packet = 0;
        self.is_pressed = false;
    }

    /// Returns `true` if the first `actions` actions are done.
    pub(super) fn has_finished(&self, actions: usize) -> bool {
        let last = actions.checked_sub(1);
        let end = last.and_then(|last| self.action_ends.get(last));
        self.active.is_none() && end.is_none_or(|&end| self.begun >= end)
    }

    /// Returns the sample of the next packet.
    pub(super) fn sample(&mut self) -> Sample {
        let seconds = self.period.as_secs_f64() * self.samples as f64;
        self.samples += 1;
        let presser = self.is_down().then_some(self.finger);
        let mut angles = self.hand.angles(&self.values);
        self.unsteadiness.apply(&mut angles, presser, seconds);
        match &mut self.sensor {
            HandSensor::Glove(glove) => glove.measure(&angles),
            HandSensor::Joints(sensor, noise) => {
                let mut sample = sensor.measure_with_body(self.hand.arm(), &angles, &self.body);
                noise.add_to(&mut sample);
                let period = self.period.as_secs_f64();
                self.tremor.add_to(&mut sample, period);
                sample
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hand::{Dof, Side};
    use crate::kinematics::BoneLengths;
    use crate::layout::Person;
    use crate::sim::motor::TypingKeys;

    /// Returns a hand without a glove over no board.
    fn hand_for(actions: &[HandAction]) -> SimulatedHand {
        let bones = BoneLengths::from_hand_and_forearm(0.18, 0.25).expect("lengths");
        let arm = ArmModel::anthropometric(Side::Right, &bones).expect("an arm");
        let settings = TypistSettings {
            name: "hand".to_owned(),
            packet_period: Duration::from_millis(10),
            noise: 0.0,
            seed: 0,
            person: Person::default(),
            keys: TypingKeys::default(),
        };
        let sensor = Sensor::Joints(JointSensor::Angles);
        SimulatedHand::new(&settings, actions, &Scene::new(), &arm, sensor)
            .expect("a plan of movements")
    }

    #[test]
    fn a_finger_that_is_bent_a_little_is_straight_again_at_the_end() {
        let bent = -0.1;
        let action = HandAction::SetAngles(vec![(Dof::RingMcpFlexion, bent)], None);
        let mut hand = hand_for(&[action]);
        let ring = hand.hand().index_of(Dof::RingMcpFlexion).expect("a joint");
        let (rest, mut farthest) = (hand.values()[ring], 0.0_f64);
        assert!((bent - rest).abs() > 0.1, "{rest}");
        while hand.advance(usize::MAX) != Progress::Finished {
            farthest = farthest.max((hand.values()[ring] - rest).abs());
        }
        assert!((farthest - (bent - rest).abs()).abs() < 1e-6, "{farthest}");
        assert!((hand.values()[ring] - rest).abs() < 1e-6);
    }

    #[test]
    fn a_hand_that_has_movements_but_no_action_moves_on() {
        let mut hand = hand_for(&[HandAction::Wait(Duration::from_millis(50))]);
        hand.action_ends.clear();
        assert!(hand.has_movements());
        while hand.has_movements() {
            assert_eq!(hand.advance(1), Progress::Moved);
        }
        assert_eq!(hand.advance(1), Progress::Finished);
    }
}
