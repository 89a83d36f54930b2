//! Triggers: a joint angle, a pinch, a shape or a motion of the hand, a button of the glove, the head or a foot, or several of them in
//! an order, as a control without a target to touch.

mod circle;
mod hand_shape;
mod measure;
mod opening;
mod palm_motion;
mod sequence;
mod steady_bends;
mod switch;

pub use circle::{CircleDirection, CirclePoint};
pub use hand_shape::HandShape;
pub use measure::Measure;
pub use palm_motion::SwipeDirection;
pub use sequence::{MAX_STEPS, Steps};

use std::time::Duration;

use self::circle::CircleMotion;
use self::opening::Opening;
use self::palm_motion::PalmMotion;
use self::sequence::HandSequence;
use self::steady_bends::SteadyBends;
use self::switch::{Change, Switch};
use super::value_output::{ValueEmitter, ValueOutput};
use super::{Capabilities, DeviceInput, DeviceOutput, KeyAction, PressSource, VirtualDevice};
use crate::contact::TargetId;
use crate::hand::{Input, Side};
use crate::time::Timestamp;

/// Maximum number of triggers in a layout. Every step evaluates each of them.
pub const MAX_TRIGGERS: usize = 64;

/// Number of steps of the value in its range: coarse enough that hand tremor emits no events.
const VALUE_STEPS: f32 = 1000.0;

/// Smallest value at which an input of the glove counts as held.
const HELD: f32 = 0.5;

/// A control without a target: an action, and events for a value, that follow a measurement of the hand, the body or the glove.
///
/// It switches on when its measurement has been at `on` for the time `hold`, and off when it is back at `off`; `on` may be more or
/// less than `off`. While the measurement is unknown (the source does not provide the joint, the finger is
/// lost or untrusted, the hand was re-acquired), or [`held`](Self::held) is not held, the trigger is off, and has to be
/// seen off before it switches on. A measurement that reaches `on` during the cool-down has to be seen off, too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trigger {
    /// The subject of its value events. The scene does not contain it.
    pub target: TargetId,
    /// The hand; `None` for both hands, each on its own.
    pub side: Option<Side>,
    /// An input of the glove that has to be held; without it the trigger is off.
    pub held: Option<Input>,
    /// The measurement.
    pub measure: Measure,
    /// The measurement at which it switches on: in radians or metres, as a fraction for an input of the glove, as a confidence for a
    /// shape, or as a number of reversals or turns.
    pub on: f32,
    /// The measurement at which it switches off, in the same unit; not equal to `on`.
    pub off: f32,
    /// The time for which the measurement has to be beyond `on` before it switches on; in between it may come near `off`, but not reach it.
    pub hold: Duration,
    /// The time after it switched off in which it does not switch on; swipes of the same hand in any direction share it.
    pub cool_down: Duration,
    /// The measurements for the values 0 and 1, in the same unit. The value is
    /// `clamp((measurement − first) / (second − first), 0, 1)`; for an input of the glove or of the head it can be as low as
    /// −1, because a stick and a head move to both sides. `None`: the value is 1 while it is on, else 0.
    pub range: Option<(f32, f32)>,
    /// The action that is held while it is on.
    pub action: Option<KeyAction>,
    /// The events for its value.
    pub output: ValueOutput,
}

/// The triggers of a layout.
#[derive(Clone, Debug)]
pub struct Triggers {
    /// All but the sequences.
    triggers: Vec<HandTrigger>,
    sequences: Vec<HandSequence>,
    /// `true` if a trigger measures the motion of the hand.
    needs_motion: bool,
    /// `true` if a trigger measures a circle.
    needs_circles: bool,
    /// `true` if a trigger measures a shape of the hand.
    needs_bends: bool,
    /// The memory of each hand, by side.
    hands: [HandMemory; Side::COUNT],
}

/// The memory of one hand.
#[derive(Clone, Debug, Default)]
struct HandMemory {
    motion: PalmMotion,
    /// The circles by point of the hand.
    circles: [CircleMotion; CirclePoint::COUNT],
    bends: SteadyBends,
    opening: Opening,
    /// The time at which a swipe was on last.
    swiped: Option<Timestamp>,
}

/// A trigger of one hand.
#[derive(Clone, Debug)]
struct HandTrigger {
    trigger: Trigger,
    side: Side,
    /// `true` for an angle of the body, which the readings of both hands have, and for a sequence of such angles: it belongs to the hand
    /// that shows it first.
    is_shared: bool,
    emitter: ValueEmitter,
    switch: Switch,
}

impl Triggers {
    /// Creates the triggers, all off; those after the first [`MAX_TRIGGERS`] are ignored.
    pub fn new(triggers: impl IntoIterator<Item = Trigger>) -> Self {
        let triggers = triggers.into_iter().take(MAX_TRIGGERS);
        let triggers = triggers.flat_map(HandTrigger::for_hands);
        let is_sequence = |it: &HandTrigger| matches!(it.trigger.measure, Measure::Sequence(_));
        let (sequences, triggers): (Vec<HandTrigger>, Vec<HandTrigger>) =
            triggers.partition(is_sequence);
        let sequences = sequences.iter();
        let sequences = sequences.filter_map(|it| HandSequence::new(it, &triggers));
        let needs_motion = |it: &HandTrigger| it.trigger.measure.is_motion();
        let needs_circles = |it: &HandTrigger| matches!(it.trigger.measure, Measure::Circle(..));
        let needs_bends = |it: &HandTrigger| matches!(it.trigger.measure, Measure::HandShape(_));
        Self {
            sequences: sequences.collect(),
            needs_motion: triggers.iter().any(needs_motion),
            needs_circles: triggers.iter().any(needs_circles),
            needs_bends: triggers.iter().any(needs_bends),
            triggers,
            hands: Default::default(),
        }
    }
}

impl VirtualDevice for Triggers {
    fn add_capabilities(&self, required: &mut Capabilities) {
        let sequences = self.sequences.iter().map(|it| &it.trigger);
        for HandTrigger { trigger, .. } in self.triggers.iter().chain(sequences) {
            required.extend(trigger.action.and_then(KeyAction::required_capability));
            trigger.output.add_capabilities(required);
        }
    }

    fn needs_bends(&self) -> bool {
        self.needs_bends
    }

    fn update(&mut self, input: &DeviceInput, out: &mut DeviceOutput) {
        let hand = &mut self.hands[input.pose.side.index()];
        if self.needs_motion {
            hand.motion.update(input.pose);
        }
        if self.needs_circles {
            for (circle, &point) in hand.circles.iter_mut().zip(CirclePoint::ALL) {
                circle.update(point, input.pose);
            }
        }
        if self.needs_bends {
            hand.bends.update(input);
            hand.opening.update(hand.bends.get(), input.pose.time);
        }
        for trigger in &mut self.triggers {
            let measurement = trigger.trigger.measure.measurement(input, hand);
            let measurement = measurement.filter(|_| trigger.is_held(input));
            if trigger.is_shared && trigger.switch.is_unknown() && measurement.is_some() {
                trigger.side = input.pose.side;
            }
            if trigger.side != input.pose.side {
                continue;
            }
            trigger.process(measurement, hand, input.pose.time, out);
        }
        for sequence in &mut self.sequences {
            sequence.update_side(&self.triggers);
            if sequence.trigger.side != input.pose.side {
                continue;
            }
            let measurement = sequence.measurement(&self.triggers, input.pose.time);
            let measurement = measurement.filter(|_| sequence.trigger.is_held(input));
            let trigger = &mut sequence.trigger;
            trigger.process(measurement, hand, input.pose.time, out);
        }
    }

    fn release_all(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        for hand in &mut self.hands {
            hand.motion.clear();
            hand.circles = Default::default();
            hand.bends = SteadyBends::default();
            hand.opening = Opening::None;
        }
        for trigger in &mut self.triggers {
            trigger.reset(time, out);
        }
        for sequence in &mut self.sequences {
            sequence.reset();
            sequence.trigger.reset(time, out);
        }
    }
}

impl HandTrigger {
    fn for_hands(trigger: Trigger) -> impl Iterator<Item = Self> {
        let is_shared = matches!(trigger.measure, Measure::Body(_)) && trigger.side.is_none();
        let sides = Side::ALL.iter().copied();
        let sides = sides.filter(move |&side| trigger.side.is_none_or(|own| own == side));
        let count = if is_shared { 1 } else { Side::COUNT };
        sides.take(count).map(move |side| Self {
            is_shared,
            emitter: ValueEmitter::new(trigger.target, trigger.output, 0.0)
                .with_axis_at_rest_for_zero(),
            trigger,
            side,
            switch: Switch::new(),
        })
    }

    /// Returns `true` if the input that has to be held is held.
    fn is_held(&self, input: &DeviceInput) -> bool {
        let is_held = |held| input.inputs.get(held).is_some_and(|value| value >= HELD);
        self.trigger.held.is_none_or(is_held)
    }

    fn source(&self) -> PressSource {
        PressSource::Part(self.trigger.target, self.side.index() as u8)
    }

    /// Processes the measurement of a step, `None` if it is not known.
    fn process(
        &mut self,
        measurement: Option<f32>,
        hand: &mut HandMemory,
        time: Timestamp,
        out: &mut DeviceOutput,
    ) {
        match measurement {
            Some(measurement) => self.update(measurement, hand, time, out),
            None => self.reset(time, out),
        }
    }

    fn update(
        &mut self,
        measurement: f32,
        hand: &mut HandMemory,
        time: Timestamp,
        out: &mut DeviceOutput,
    ) {
        let is_swipe = matches!(self.trigger.measure, Measure::Swipe(_));
        // The hand swings back after a swipe.
        let is_blocked = is_swipe && !self.switch.is_on() && hand.is_cooling(&self.trigger, time);
        let change = self
            .switch
            .update(&self.trigger, measurement, is_blocked, time);
        match change {
            Change::Known => self.emitter.restart_at(self.value(measurement), time, out),
            Change::Due => self.switch_on(time, out),
            Change::Off => out.release(self.source(), time),
            Change::None if self.switch.is_unknown() => return,
            Change::None => {}
        }
        if is_swipe && (self.switch.is_on() || change == Change::Off) {
            hand.swiped = Some(time);
        }
        self.emitter.set(self.value(measurement), time, out);
    }

    /// Switches on, or stays off if the press does not fit into the event list.
    fn switch_on(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        let action = self.trigger.action;
        if action.is_none_or(|action| out.press(self.source(), action, time)) {
            self.switch.switch_on(time);
        }
    }

    fn reset(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        if !self.switch.forget(time) && self.emitter.is_at_zero() {
            return;
        }
        out.cancel(self.source(), time);
        self.emitter.restart_at(0.0, time, out);
    }

    fn value(&self, measurement: f32) -> f32 {
        let Some((first, second)) = self.trigger.range else {
            return f32::from(u8::from(self.switch.is_on()));
        };
        let lowest = match self.trigger.measure {
            Measure::Input(_) => -1.0,
            Measure::Body(angle) if angle.is_of_head() => -1.0,
            _ => 0.0,
        };
        let fraction = ((measurement - first) / (second - first)).clamp(lowest, 1.0);
        (fraction * VALUE_STEPS).round() / VALUE_STEPS
    }
}

impl HandMemory {
    /// Returns `true` if a swipe was on within the cool-down of a trigger.
    fn is_cooling(&self, trigger: &Trigger, time: Timestamp) -> bool {
        let swiped = self.swiped;
        swiped.is_some_and(|swiped| time.since(swiped) < trigger.cool_down)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::surface::Scene;
    use crate::device::{Axis, EventKind, Events, KeyArbiter, OutputEvent, TextId, TimedCommands};
    use crate::hand::{BodyAngle, InputValues, JointAngles};
    use crate::kinematics::HandPose;

    /// Returns a trigger of both hands without an action.
    fn trigger(target: u32, measure: Measure, on: f32, off: f32) -> Trigger {
        Trigger {
            target: TargetId(target),
            side: None,
            held: None,
            measure,
            on,
            off,
            hold: Duration::ZERO,
            cool_down: Duration::ZERO,
            range: None,
            action: None,
            output: ValueOutput::ValueOnly,
        }
    }

    /// Processes a step of a hand with these inputs.
    fn update(
        triggers: &mut Triggers,
        arbiter: &mut KeyArbiter,
        pose: &HandPose,
        inputs: &InputValues,
        events: &mut Events,
    ) {
        let input = DeviceInput {
            scene: &Scene::new(),
            angles: &JointAngles::default(),
            bends: &Default::default(),
            inputs,
            pose,
            touches: &[],
            presses: &[],
        };
        let mut out = DeviceOutput {
            arbiter,
            events,
            commands: &mut TimedCommands::new(),
        };
        triggers.update(&input, &mut out);
    }

    #[test]
    fn a_sequence_of_angles_of_the_body_acts_once_with_two_hands() {
        let yaw = Measure::Body(BodyAngle::HeadYaw);
        let steps = Measure::Sequence(Steps {
            targets: [Some(TargetId(0)), Some(TargetId(1)), None, None],
            within: Duration::from_secs(1),
        });
        let mut triggers = Triggers::new([
            trigger(0, yaw, -0.3, -0.2),
            trigger(1, yaw, 0.3, 0.2),
            Trigger {
                action: Some(KeyAction::Text(TextId(0))),
                ..trigger(2, steps, 1.0, 0.9)
            },
        ]);
        let mut arbiter = KeyArbiter::new(vec!["x".to_owned()]);
        let mut characters = 0;
        for (step, turn) in [0.0, -0.4, 0.0, 0.4, 0.0].into_iter().enumerate() {
            for &side in Side::ALL {
                let mut inputs = InputValues::default();
                inputs.set_angle(BodyAngle::HeadYaw, turn);
                let pose = HandPose::new(Timestamp(step as u64 * 100_000), side, 0.005);
                let mut events = Events::new();
                update(&mut triggers, &mut arbiter, &pose, &inputs, &mut events);
                let kinds = events.iter().map(|event| event.kind);
                characters += kinds
                    .filter(|kind| matches!(kind, EventKind::Character(_)))
                    .count();
            }
        }
        assert_eq!(characters, 1);
    }

    #[test]
    fn the_axis_of_an_input_that_is_lost_returns_to_0_in_the_next_step_with_room() {
        let mut triggers = Triggers::new([Trigger {
            side: Some(Side::Right),
            range: Some((0.0, 1.0)),
            output: ValueOutput::Axis(Axis::LeftTrigger),
            ..trigger(0, Measure::Input(Input::Trigger), 0.5, 0.4)
        }]);
        let mut arbiter = KeyArbiter::default();
        let mut axis_after = |ms: u64, value: Option<f32>, room: usize| {
            let time = Timestamp(ms * 1_000);
            let mut inputs = InputValues::default();
            if let Some(value) = value {
                inputs.set(Input::Trigger, value);
            }
            let filler = OutputEvent {
                time,
                kind: EventKind::MoveBy(1, 0),
            };
            let mut events = Events::new();
            while events.remaining_capacity() > room {
                events.push(filler);
            }
            let pose = HandPose::new(time, Side::Right, 0.005);
            update(&mut triggers, &mut arbiter, &pose, &inputs, &mut events);
            events.iter().find_map(|event| match event.kind {
                EventKind::Axis(Axis::LeftTrigger, position) => Some(position),
                _ => None,
            })
        };
        let all = Events::new().capacity();
        assert_eq!(axis_after(10, Some(0.0), all), None);
        assert_eq!(axis_after(20, Some(1.0), all), Some(1.0));
        // Only the value returns.
        assert_eq!(axis_after(30, None, 1), None);
        assert_eq!(axis_after(40, None, all), Some(0.0));
        assert_eq!(axis_after(50, None, all), None);
    }
}
