//! Knobs and valves: turned by dragging along the rim, or by pinching and rotating the hand.

mod pinch;

use std::f32::consts::TAU;

use parry3d::math::Vec2;

use self::pinch::{Pinch, Tips};
use super::grips::Grips;
use super::pending_returns::Resting;
use super::steps::{nearest, step_to};
use super::target_index::Places;
use super::value_output::{Driver, ValueOutput};
use super::{Capabilities, DeviceInput, DeviceOutput, VirtualDevice};
use crate::contact::{Phase, TargetId, Touch};
use crate::hand::Side;
use crate::time::Timestamp;

/// The share of a knob's radius within which a fingertip turns nothing: so near to the middle a tremble
/// is a large angle.
const DEAD_CENTRE: f32 = 0.25;

/// One knob or valve. Clockwise, as seen from its front, is up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knob {
    /// The target that is its front, about whose middle it turns.
    pub target: TargetId,
    /// Its radius, in metres, more than 0.
    pub radius: f32,
    /// How far it turns.
    pub range: KnobRange,
    /// The value is on one of so many steps of the range, at least 1; anywhere when `None`.
    pub steps: Option<u16>,
    /// Where it stands at first: 0..=1 where it has ends.
    pub initial: f32,
    /// What its value drives.
    pub output: ValueOutput,
}

/// How far a knob turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum KnobRange {
    /// By this angle between its ends, in radians, more than 0, any number of turns; the value is 0..=1.
    Limited(f32),
    /// On and on; the value is the number of turns.
    Endless,
}

impl Knob {
    /// The value after the knob was turned counter-clockwise by an angle, in radians.
    fn turned(&self, value: f32, angle: f32) -> f32 {
        match self.range {
            KnobRange::Limited(range) => (value - angle / range).clamp(0.0, 1.0),
            KnobRange::Endless => value - angle / TAU,
        }
    }
}

/// How a fingertip holds a rim.
#[derive(Clone, Copy, Debug)]
struct Rim {
    /// Where it was about the middle, in metres; `None` in the dead centre.
    from: Option<Vec2>,
    /// The value without steps.
    value: f32,
}

/// The knobs and valves of a layout.
///
/// **Rim.** The fingertip that presses a knob turns it by the angle that it goes round the middle, until it
/// is released; others are ignored. It never jumps: not at the press, and not in the dead centre, a quarter
/// of the radius, where it turns nothing.
///
/// **Pinch.** Thumb and index fingertip that close over a knob, their middle inside its outline and at most
/// 40 mm from its front, take it, also from one of these two that held the rim. Until they open, the knob
/// turns as the hand does about the knob's normal.
///
/// Beyond its ends a knob does not turn, and comes back as soon as the hand does. It stays where it is when
/// it is let go of or the hand is lost. When everything is let go of, so does its value, but its axis goes
/// to 0 until it is next held.
#[derive(Clone, Debug)]
pub struct Knobs {
    knobs: Vec<(Knob, Driver)>,
    places: Places,
    rims: Grips<Rim>,
    pinches: [Pinch; Side::COUNT],
    resting: Resting,
}

impl Knobs {
    /// All where they stand at first.
    pub fn new(knobs: Vec<Knob>) -> Self {
        let with_driver = |knob: Knob| {
            let start = nearest(knob.initial, knob.steps);
            (knob, Driver::new(knob.target, knob.output, start))
        };
        Self {
            places: Places::new(knobs.iter().map(|knob| knob.target)),
            rims: Grips::none(),
            pinches: [Pinch::default(); Side::COUNT],
            resting: Resting::of(knobs.len()),
            knobs: knobs.into_iter().map(with_driver).collect(),
        }
    }

    fn grab(&mut self, touch: &Touch, out: &mut DeviceOutput) {
        self.rims.end(touch);
        let Some(place) = self.places.of(touch.target) else {
            return;
        };
        let is_pinched = self.pinches.iter().any(|pinch| pinch.is_on(place));
        if is_pinched || self.rims.on(place).is_some() {
            return;
        }
        let value = self.hold(place, touch.time, out);
        let from = self.off_centre(place, touch.position);
        self.rims.begin(touch, place, Rim { from, value });
    }

    /// Somebody takes a knob: an axis that went to 0 comes back. Gives the value that it stands at.
    fn hold(&mut self, place: usize, time: Timestamp, out: &mut DeviceOutput) -> f32 {
        self.resting.end(place);
        let (_, driver) = &mut self.knobs[place];
        driver.set(driver.value(), time, out);
        driver.value()
    }

    fn off_centre(&self, place: usize, at: Vec2) -> Option<Vec2> {
        let dead = self.knobs[place].0.radius * DEAD_CENTRE;
        (at.length_squared() > dead * dead).then_some(at)
    }

    fn follow(&mut self, touch: &Touch, out: &mut DeviceOutput) {
        let Some(grip) = self.rims.of(touch) else {
            return;
        };
        let (place, before) = (grip.place, grip.state.from);
        let now = self.off_centre(place, touch.position);
        let angle = match (before, now) {
            (Some(before), Some(now)) => before.angle_to(now),
            _ => 0.0,
        };
        let Some(grip) = self.rims.of(touch) else {
            return;
        };
        grip.state.from = now;
        turn(
            &mut self.knobs[place],
            &mut grip.state.value,
            angle,
            touch.time,
            out,
        );
    }

    fn take_pinch(&mut self, seen: &DeviceInput, out: &mut DeviceOutput) {
        let pose = seen.pose;
        let hand = pose.side.index();
        let tips = Tips::of(pose);
        self.pinches[hand] = match (self.pinches[hand], tips) {
            (_, None) => Pinch::Closed,
            (_, Some(tips)) if tips.are_open() => Pinch::Open,
            (Pinch::Open, Some(tips)) if tips.are_closed() => self.pinch(&tips, seen, out),
            (Pinch::On(held), Some(_)) => self.rotate(held, seen, out),
            (pinch, Some(_)) => pinch,
        };
    }

    /// Thumb and index finger close: takes the knob under them.
    fn pinch(&mut self, tips: &Tips, seen: &DeviceInput, out: &mut DeviceOutput) -> Pinch {
        let pose = seen.pose;
        let Some(mut held) = pinch::knob_under(tips, pose, seen.scene, &self.places) else {
            return Pinch::Closed;
        };
        let is_pinched = self.pinches.iter().any(|pinch| pinch.is_on(held.place));
        let is_anothers = |place| {
            let grip = self.rims.on(place);
            grip.is_some_and(|grip| grip.side != pose.side || !Tips::FINGERS.contains(&grip.finger))
        };
        if is_pinched || is_anothers(held.place) {
            return Pinch::Closed;
        }
        self.rims.end_on(held.place);
        held.value = self.hold(held.place, pose.time, out);
        Pinch::On(held)
    }

    fn rotate(
        &mut self,
        mut held: pinch::Held,
        seen: &DeviceInput,
        out: &mut DeviceOutput,
    ) -> Pinch {
        let Some(angle) = held.turn(seen.pose, seen.scene) else {
            return Pinch::Closed;
        };
        let knob = &mut self.knobs[held.place];
        turn(knob, &mut held.value, angle, seen.pose.time, out);
        Pinch::On(held)
    }
}

/// Turns a knob counter-clockwise by an angle, in radians; `value` is its own without steps.
fn turn(
    (knob, driver): &mut (Knob, Driver),
    value: &mut f32,
    angle: f32,
    time: Timestamp,
    out: &mut DeviceOutput,
) {
    // A hand at an impossible angle turns nothing.
    if !angle.is_finite() || angle == 0.0 {
        return;
    }
    *value = knob.turned(*value, angle);
    driver.set(step_to(*value, knob.steps, driver.value()), time, out);
}

impl VirtualDevice for Knobs {
    fn add_capabilities(&self, needs: &mut Capabilities) {
        for (knob, _) in &self.knobs {
            knob.output.add_capabilities(needs);
        }
    }

    fn update(&mut self, seen: &DeviceInput, out: &mut DeviceOutput) {
        self.resting.go_on(&mut self.knobs, seen.pose.time, out);
        for touch in seen.touches {
            match touch.phase {
                Phase::Touched => {}
                Phase::Pressed => self.grab(touch, out),
                Phase::Moved => self.follow(touch, out),
                Phase::Released | Phase::Left | Phase::Cancelled => {
                    self.rims.end(touch);
                }
            }
        }
        self.take_pinch(seen, out);
    }

    fn release_all(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        self.rims.clear();
        self.pinches = [Pinch::default(); Side::COUNT];
        for (place, (_, driver)) in self.knobs.iter_mut().enumerate() {
            self.resting.begin(place, driver, time, out);
        }
    }
}
