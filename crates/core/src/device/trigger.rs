//! Triggers: a joint angle, a pinch or a button of the glove as a control, without a target to touch.

use super::value_output::{ValueEmitter, ValueOutput};
use super::{Capabilities, DeviceInput, DeviceOutput, KeyAction, PressSource, VirtualDevice};
use crate::contact::TargetId;
use crate::hand::{Dof, Finger, Input, Side};
use crate::time::Timestamp;

/// Maximum number of triggers of a layout: every step evaluates each of them.
pub const MAX_TRIGGERS: usize = 64;

/// Resolution of the value, in steps: hand tremor then emits no events.
const VALUE_STEPS: f32 = 1000.0;

/// The value from which an input of the glove is held.
const HELD: f32 = 0.5;

/// A trigger.
///
/// It switches on when its measurement reaches `on`, and off when it is back at `off`; `on` may be more or
/// less than `off`. While the measurement is unknown (the source does not provide the joint, the finger is
/// lost or untrusted, the hand was re-acquired), or [`held`](Self::held) is not held, the trigger is off, and has to be
/// seen off before it switches on.
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
    /// The measurement at which it switches on: in radians or metres, or as a fraction for an input of the glove.
    pub on: f32,
    /// The measurement at which it switches off, in the same unit; not equal to `on`.
    pub off: f32,
    /// The measurements for the values 0 and 1, in the same unit. The value is
    /// `clamp((measurement − first) / (second − first), 0, 1)`; that of an input of the glove can be as low as −1, because a
    /// stick moves to both sides. `None`: the value is 1 while it is on, else 0.
    pub range: Option<(f32, f32)>,
    /// The action that is held while it is on.
    pub action: Option<KeyAction>,
    /// The events for its value.
    pub output: ValueOutput,
}

/// The measurement of a trigger.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measure {
    /// A joint angle, in radians.
    Angle(Dof),
    /// The distance from the fingertip center of the thumb to that of a finger, in metres.
    Pinch(Finger),
    /// A stick, trigger or button of the glove, −1..=1.
    Input(Input),
}

/// The triggers of a layout.
#[derive(Clone, Debug)]
pub struct Triggers(Vec<HandTrigger>);

/// A trigger of one hand.
#[derive(Clone, Debug)]
struct HandTrigger {
    trigger: Trigger,
    side: Side,
    emitter: ValueEmitter,
    state: TriggerState,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum TriggerState {
    /// Not seen off since its measurement was unknown.
    Unknown,
    Off,
    On,
}

impl Triggers {
    /// Creates the triggers, all off; those after the first [`MAX_TRIGGERS`] are ignored.
    pub fn new(triggers: impl IntoIterator<Item = Trigger>) -> Self {
        let triggers = triggers.into_iter().take(MAX_TRIGGERS);
        Self(triggers.flat_map(HandTrigger::for_hands).collect())
    }
}

impl VirtualDevice for Triggers {
    fn add_capabilities(&self, required: &mut Capabilities) {
        for HandTrigger { trigger, .. } in &self.0 {
            required.extend(trigger.action.and_then(KeyAction::required_capability));
            trigger.output.add_capabilities(required);
        }
    }

    fn update(&mut self, input: &DeviceInput, out: &mut DeviceOutput) {
        for trigger in &mut self.0 {
            if trigger.side != input.pose.side {
                continue;
            }
            let measurement = trigger.trigger.measure.measurement(input);
            match measurement.filter(|_| trigger.is_held(input)) {
                Some(measurement) => trigger.update(measurement, input.pose.time, out),
                None => trigger.reset(input.pose.time, out),
            }
        }
    }

    fn release_all(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        for trigger in &mut self.0 {
            trigger.reset(time, out);
        }
    }
}

impl HandTrigger {
    fn for_hands(trigger: Trigger) -> impl Iterator<Item = Self> {
        let sides = Side::ALL.iter().copied();
        let sides = sides.filter(move |&side| trigger.side.is_none_or(|own| own == side));
        sides.map(move |side| Self {
            emitter: ValueEmitter::new(trigger.target, trigger.output, 0.0)
                .with_axis_at_rest_for_zero(),
            trigger,
            side,
            state: TriggerState::Unknown,
        })
    }

    /// Returns whether the input that has to be held is held.
    fn is_held(&self, input: &DeviceInput) -> bool {
        let is_held = |held| input.inputs.get(held).is_some_and(|value| value >= HELD);
        self.trigger.held.is_none_or(is_held)
    }

    fn source(&self) -> PressSource {
        PressSource::Part(self.trigger.target, self.side.index() as u8)
    }

    fn update(&mut self, measurement: f32, time: Timestamp, out: &mut DeviceOutput) {
        let Trigger { on, off, .. } = self.trigger;
        let is_past = |limit: f32| (measurement - limit) * (on - off).signum() >= 0.0;
        let is_back = measurement == off || !is_past(off);
        match self.state {
            TriggerState::Unknown if !is_back => return,
            TriggerState::Unknown => {
                self.state = TriggerState::Off;
                // The change since the measurement was lost is not emitted as motion or taps.
                self.emitter.restart_at(self.value(measurement), time, out);
            }
            TriggerState::Off if is_past(on) => self.switch_on(time, out),
            TriggerState::On if is_back => {
                out.release(self.source(), time);
                self.state = TriggerState::Off;
            }
            TriggerState::Off | TriggerState::On => {}
        }
        self.emitter.set(self.value(measurement), time, out);
    }

    /// Switches on, or stays off if the press does not fit into the event list.
    fn switch_on(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        let action = self.trigger.action;
        if action.is_none_or(|action| out.press(self.source(), action, time)) {
            self.state = TriggerState::On;
        }
    }

    fn reset(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        if self.state == TriggerState::Unknown && self.emitter.value() == 0.0 {
            return;
        }
        out.cancel(self.source(), time);
        self.state = TriggerState::Unknown;
        self.emitter.restart_at(0.0, time, out);
    }

    fn value(&self, measurement: f32) -> f32 {
        let Some((first, second)) = self.trigger.range else {
            return f32::from(u8::from(self.state == TriggerState::On));
        };
        let lowest = match self.trigger.measure {
            Measure::Input(_) => -1.0,
            Measure::Angle(_) | Measure::Pinch(_) => 0.0,
        };
        let fraction = ((measurement - first) / (second - first)).clamp(lowest, 1.0);
        (fraction * VALUE_STEPS).round() / VALUE_STEPS
    }
}

impl Measure {
    /// Returns the current measurement, or `None` if it is unknown.
    fn measurement(self, input: &DeviceInput) -> Option<f32> {
        let is_trusted = |finger: Finger| !input.pose.untrusted.contains(finger);
        // A button does not depend on the pose of the hand.
        if input.pose.jumped && !matches!(self, Self::Input(_)) {
            return None;
        }
        let measurement = match self {
            Self::Angle(dof) => {
                let is_known = input.angles.is_known(dof) && dof.finger().is_none_or(is_trusted);
                is_known.then(|| input.angles.get(dof) as f32)
            }
            Self::Pinch(finger) => {
                let tips = [Finger::Thumb, finger];
                let [thumb, tip] = tips.map(|finger| {
                    let tip = input.pose.fingertip(finger);
                    tip.filter(|_| is_trusted(finger))
                });
                Some(thumb?.distance(tip?))
            }
            Self::Input(own) => input.inputs.get(own),
        };
        measurement.filter(|measurement| measurement.is_finite())
    }
}
