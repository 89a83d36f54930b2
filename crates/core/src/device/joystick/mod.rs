//! Joysticks: a cap that a fingertip deflects and that springs back.

mod stick;

use arrayvec::ArrayVec;
use parry3d::math::Vec2;

use self::stick::{PART_COUNT, Stick};
use super::target_index::TargetIndex;
use super::{Axis, Capabilities, Capability, DeviceInput, DeviceOutput, KeyAction, VirtualDevice};
use crate::contact::{Phase, TargetId, Touch};
use crate::hand::FINGERS_OF_BOTH_HANDS;
use crate::time::Timestamp;

/// A joystick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joystick {
    /// The target that is its cap.
    pub target: TargetId,
    /// The full deflection in every direction, in metres, more than 0.
    pub max_deflection: f32,
    /// Radius of the dead zone, as a fraction of the full deflection: 0..1.
    pub dead_zone: f32,
    /// Exponent of the response between the dead zone and full deflection: 1 is linear, more is finer near
    /// the center.
    pub curve: f32,
    /// The axes that it sets, to the right and away from the wearer.
    pub axes: Option<[Axis; 2]>,
    /// The actions held while it points up (away from the wearer), down, left and right.
    pub direction_keys: Option<[KeyAction; 4]>,
    /// The action held while it is pushed in.
    pub push_action: Option<KeyAction>,
    /// Speed of the pointer at full deflection, in pixels per second; 0 if it does not move the pointer.
    pub pointer_speed_px_s: f32,
}

impl Joystick {
    /// Returns the action of a part: up, down, left, right, push.
    fn action(&self, part: usize) -> Option<KeyAction> {
        match self.direction_keys.and_then(|keys| keys.get(part).copied()) {
            None if part == PART_COUNT - 1 => self.push_action,
            action => action,
        }
    }

    /// Returns its axis values, of length 1 at most, for a deflection given as a fraction of the full one.
    /// They are 0 in the dead zone, follow the curve outside, and saturate at full deflection.
    fn response(&self, deflection: Vec2) -> Vec2 {
        let length = deflection.length();
        if length <= self.dead_zone || !length.is_finite() {
            return Vec2::ZERO;
        }
        let t = ((length - self.dead_zone) / (1.0 - self.dead_zone)).min(1.0);
        let response = deflection / length * t.powf(self.curve);
        Vec2::select(
            response.abs().cmplt(Vec2::splat(ROUNDING)),
            Vec2::ZERO,
            response,
        )
    }
}

/// Axis values smaller than this are set to 0: a finger that moves straight up also moves sideways a little.
const ROUNDING: f32 = 1e-4;

/// Ten fingers, and as many released sticks whose return to the center is not emitted yet.
const MAX_STICKS: usize = 2 * FINGERS_OF_BOTH_HANDS;

/// The joysticks of a layout.
///
/// The fingertip that presses a cap deflects the stick by its distance from where it pressed, wherever on
/// the cap that was. Other fingertips are ignored. When the fingertip releases the cap, is lost or strays
/// off, and in [`VirtualDevice::release_all`], the stick returns to its center: axes are 0, no key is
/// pressed, and the pointer stops. A joystick has no value events.
#[derive(Clone, Debug)]
pub struct Joysticks {
    joysticks: Vec<Joystick>,
    index: TargetIndex,
    /// The sticks that are held, and those whose return to the center is not emitted yet.
    sticks: ArrayVec<Stick, MAX_STICKS>,
}

impl Joysticks {
    /// Creates the joysticks, all centered.
    pub fn new(joysticks: Vec<Joystick>) -> Self {
        Self {
            index: TargetIndex::new(joysticks.iter().map(|joystick| joystick.target)),
            joysticks,
            sticks: ArrayVec::new(),
        }
    }

    fn grab(&mut self, touch: &Touch, out: &mut DeviceOutput) {
        self.release(touch, out);
        let Some(index) = self.index.get(touch.target) else {
            return;
        };
        match self.sticks.iter_mut().find(|stick| stick.index == index) {
            Some(stick) if stick.is_held() => {}
            Some(stick) => stick.grab(touch),
            None => {
                // If the list is full, the press is ignored.
                let _ = self.sticks.try_push(Stick::new(index, touch));
            }
        }
    }

    fn deflect(&mut self, touch: &Touch, out: &mut DeviceOutput) {
        let joysticks = &self.joysticks;
        if let Some(stick) = self.sticks.iter_mut().find(|it| it.is_held_by(touch)) {
            stick.deflect(&joysticks[stick.index], touch, out);
        }
    }

    fn release(&mut self, touch: &Touch, out: &mut DeviceOutput) {
        let joysticks = &self.joysticks;
        for stick in &mut self.sticks {
            if stick.is_held_by(touch) {
                stick.release(&joysticks[stick.index], touch, out);
            }
        }
    }

    /// Emits axes and pointer motion up to `time`, and removes the sticks that are back at the center.
    fn emit(&mut self, time: Timestamp, input: Option<&DeviceInput>, out: &mut DeviceOutput) {
        let joysticks = &self.joysticks;
        self.sticks.retain(|stick| {
            let joystick = &joysticks[stick.index];
            let is_centered = stick.emit_axes(joystick, time, out);
            if input.is_some_and(|input| stick.is_held_by_hand(input.pose.side)) {
                stick.move_pointer(joystick, time, out);
            }
            stick.is_held() || !is_centered
        });
    }
}

impl VirtualDevice for Joysticks {
    fn add_capabilities(&self, required: &mut Capabilities) {
        for joystick in &self.joysticks {
            let keys = joystick.direction_keys.into_iter().flatten();
            let actions = keys.chain(joystick.push_action);
            required.extend(actions.filter_map(KeyAction::required_capability));
            required.extend(joystick.axes.into_iter().flatten().map(Capability::Axis));
            let moves_pointer = joystick.pointer_speed_px_s > 0.0;
            required.extend(moves_pointer.then_some(Capability::RelativeMotion));
        }
    }

    fn update(&mut self, input: &DeviceInput, out: &mut DeviceOutput) {
        for touch in input.touches {
            match touch.phase {
                Phase::Touched => {}
                Phase::Pressed => self.grab(touch, out),
                Phase::Moved => self.deflect(touch, out),
                Phase::Released | Phase::Left | Phase::Cancelled => self.release(touch, out),
            }
        }
        self.emit(input.pose.time, Some(input), out);
    }

    fn release_all(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        for stick in &mut self.sticks {
            stick.reset();
        }
        self.emit(time, None, out);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn joystick(dead_zone: f32, curve: f32) -> Joystick {
        Joystick {
            target: TargetId(0),
            max_deflection: 0.02,
            dead_zone,
            curve,
            axes: None,
            direction_keys: None,
            push_action: None,
            pointer_speed_px_s: 0.0,
        }
    }

    #[test]
    fn the_response_starts_at_the_dead_zone_and_saturates_at_full_deflection() {
        let stick = joystick(0.2, 2.0);
        for (deflection, expected) in [(0.1, 0.0), (0.2, 0.0), (0.6, 0.25), (1.0, 1.0), (9.0, 1.0)]
        {
            let found = stick.response(Vec2::new(0.0, -deflection));
            assert!((found.y + expected).abs() < 1e-6, "{deflection}: {found}");
            assert_eq!(found.x, 0.0);
        }
        assert_eq!(joystick(0.0, 1.0).response(Vec2::ZERO), Vec2::ZERO);
        let almost_straight = stick.response(Vec2::new(1e-8, 1.0));
        assert_eq!(almost_straight, Vec2::Y, "the other axis stays at 0");
        assert_eq!(stick.response(Vec2::NAN), Vec2::ZERO);
    }

    #[test]
    fn a_diagonal_deflection_is_limited_to_length_1() {
        let found = joystick(0.1, 1.0).response(Vec2::new(3.0, 3.0));
        assert!((found.length() - 1.0).abs() < 1e-6 && found.x == found.y);
    }
}
