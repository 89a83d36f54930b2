//! Triggers: an angle of a joint or a pinch as a control, without anything to touch.

use super::value_output::{Driver, ValueOutput};
use super::{Capabilities, DeviceInput, DeviceOutput, KeyAction, PressSource, VirtualDevice};
use crate::contact::TargetId;
use crate::hand::{Dof, Finger, Side};
use crate::time::Timestamp;

/// The most triggers that a layout has: each is looked at in each frame.
pub const MAX_TRIGGERS: usize = 64;

/// The steps in which a value is told, so that a tremble is no news.
const STEPS: f32 = 1000.0;

/// One trigger.
///
/// It goes on as what it measures reaches `on`, and off as that is back at `off`; which of the two is
/// more says which way is on. Where the measure is not known (the source lacks the joint, the finger is
/// lost or not to be believed, the hand jumped) it is off, and has to be seen off before it goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trigger {
    /// What its value is told of. Nothing of it is in the scene.
    pub target: TargetId,
    /// Of which hand; `None` for either, each for itself.
    pub side: Option<Side>,
    /// What it measures.
    pub measure: Measure,
    /// Where it goes on, in radians or metres.
    pub on: f32,
    /// Where it goes off, in radians or metres; not the same as `on`.
    pub off: f32,
    /// Where its value is 0 and where it is 1, in radians or metres: in between and beyond, the value is
    /// `clamp((measure − first) / (second − first), 0, 1)`. Without these the value is 1 as long as it is
    /// on, else 0.
    pub range: Option<(f32, f32)>,
    /// What is pressed as long as it is on.
    pub action: Option<KeyAction>,
    /// What its value drives.
    pub output: ValueOutput,
}

/// What a trigger measures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measure {
    /// An angle of a joint, in radians.
    Angle(Dof),
    /// How far the middle of the tip of the thumb is from that of a finger, in metres.
    Pinch(Finger),
}

/// The triggers of a layout.
#[derive(Clone, Debug)]
pub struct Triggers(Vec<Followed>);

/// A trigger on one hand.
#[derive(Clone, Debug)]
struct Followed {
    trigger: Trigger,
    side: Side,
    driver: Driver,
    state: State,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// Not seen off since it was lost.
    Lost,
    Off,
    On,
}

impl Triggers {
    /// All off; those after the first [`MOST_TRIGGERS`] are left out.
    pub fn new(triggers: impl IntoIterator<Item = Trigger>) -> Self {
        let triggers = triggers.into_iter().take(MAX_TRIGGERS);
        Self(triggers.flat_map(Followed::on_its_hands).collect())
    }
}

impl VirtualDevice for Triggers {
    fn add_capabilities(&self, needs: &mut Capabilities) {
        for Followed { trigger, .. } in &self.0 {
            needs.extend(trigger.action.and_then(KeyAction::required_capability));
            trigger.output.add_capabilities(needs);
        }
    }

    fn update(&mut self, seen: &DeviceInput, out: &mut DeviceOutput) {
        for followed in &mut self.0 {
            if followed.side != seen.pose.side {
                continue;
            }
            match followed.trigger.measure.of(seen) {
                Some(measured) => followed.follow(measured, seen.pose.time, out),
                None => followed.lose(seen.pose.time, out),
            }
        }
    }

    fn release_all(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        for followed in &mut self.0 {
            followed.lose(time, out);
        }
    }
}

impl Followed {
    fn on_its_hands(trigger: Trigger) -> impl Iterator<Item = Self> {
        let sides = Side::ALL.iter().copied();
        let sides = sides.filter(move |&side| trigger.side.is_none_or(|own| own == side));
        sides.map(move |side| Self {
            driver: Driver::new(trigger.target, trigger.output, 0.0),
            trigger,
            side,
            state: State::Lost,
        })
    }

    fn owner(&self) -> PressSource {
        PressSource::Part(self.trigger.target, self.side.index() as u8)
    }

    fn follow(&mut self, measured: f32, time: Timestamp, out: &mut DeviceOutput) {
        let Trigger { on, off, .. } = self.trigger;
        let is_past = |limit: f32| (measured - limit) * (on - off).signum() >= 0.0;
        let is_back = measured == off || !is_past(off);
        match self.state {
            State::Lost if !is_back => return,
            State::Lost => {
                self.state = State::Off;
                // What it stood at meanwhile is no way that it went.
                self.driver.stand(self.value(measured), time, out);
            }
            State::Off if is_past(on) => self.go_on(time, out),
            State::On if is_back => {
                out.release(self.owner(), time);
                self.state = State::Off;
            }
            State::Off | State::On => {}
        }
        self.driver.set(self.value(measured), time, out);
    }

    /// Goes on, or stays off until there is room.
    fn go_on(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        let action = self.trigger.action;
        if action.is_none_or(|action| out.press(self.owner(), action, time)) {
            self.state = State::On;
        }
    }

    fn lose(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        if self.state == State::Lost && self.driver.value() == 0.0 {
            return;
        }
        out.cancel(self.owner(), time);
        self.state = State::Lost;
        self.driver.stand(0.0, time, out);
    }

    fn value(&self, measured: f32) -> f32 {
        let Some((first, second)) = self.trigger.range else {
            return f32::from(u8::from(self.state == State::On));
        };
        let share = ((measured - first) / (second - first)).clamp(0.0, 1.0);
        (share * STEPS).round() / STEPS
    }
}

impl Measure {
    /// What it is now; `None` where that is not known.
    fn of(self, seen: &DeviceInput) -> Option<f32> {
        let untrusted = seen.pose.untrusted.union(seen.angles.untrusted);
        let is_believed = |finger: Finger| !untrusted.contains(finger);
        if seen.pose.jumped || seen.angles.jumped {
            return None;
        }
        let measured = match self {
            Self::Angle(dof) => {
                let is_seen = seen.angles.is_known(dof) && dof.finger().is_none_or(is_believed);
                is_seen.then(|| seen.angles.get(dof) as f32)
            }
            Self::Pinch(finger) => {
                let tips = [Finger::Thumb, finger];
                let [thumb, tip] = tips.map(|finger| {
                    let tip = seen.pose.fingertip(finger);
                    tip.filter(|_| is_believed(finger))
                });
                Some(thumb?.distance(tip?))
            }
        };
        measured.filter(|measured| measured.is_finite())
    }
}
