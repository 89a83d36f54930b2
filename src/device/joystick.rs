//! Joysticks: a cap that a fingertip pushes aside and that springs back.

mod stick;

use arrayvec::ArrayVec;
use parry3d::math::Vec2;

use self::stick::{PARTS, Stick};
use super::target_index::Places;
use super::{Axis, Capabilities, Capability, DeviceInput, DeviceOutput, KeyAction, VirtualDevice};
use crate::contact::{Phase, TargetId, Touch};
use crate::hand::FINGERS_OF_BOTH_HANDS;
use crate::time::Timestamp;

/// One joystick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joystick {
    /// The target that is its cap.
    pub target: TargetId,
    /// How far it goes to every side, in metres, more than 0.
    pub max_deflection: f32,
    /// The share of the reach within which it stands in the middle, 0..1.
    pub dead_zone: f32,
    /// The exponent of the way from the dead zone to the full throw: 1 is in proportion, more is finer near
    /// the middle.
    pub curve: f32,
    /// What it drives to the right and away from the wearer.
    pub axes: Option<[Axis; 2]>,
    /// What is pressed while it points up (away from the wearer), down, left and right.
    pub direction_keys: Option<[KeyAction; 4]>,
    /// What is pressed while it is pushed in deep.
    pub push_action: Option<KeyAction>,
    /// How fast it moves the pointer at full throw, in pixels a second; 0 for a joystick that does not.
    pub pointer_speed_px_s: f32,
}

impl Joystick {
    /// What a part presses: up, down, left, right and the push.
    fn action(&self, part: usize) -> Option<KeyAction> {
        match self.direction_keys.and_then(|keys| keys.get(part).copied()) {
            None if part == PARTS - 1 => self.push_action,
            action => action,
        }
    }

    /// Where it stands, at most 1 from the middle, when the fingertip is at `throw`, a share of the reach to
    /// each side: in the middle within the dead zone, beyond it by the curve, at the end from 1 on.
    fn response(&self, throw: Vec2) -> Vec2 {
        let length = throw.length();
        if length <= self.dead_zone || !length.is_finite() {
            return Vec2::ZERO;
        }
        let share = ((length - self.dead_zone) / (1.0 - self.dead_zone)).min(1.0);
        let response = throw / length * share.powf(self.curve);
        Vec2::select(
            response.abs().cmplt(Vec2::splat(ROUNDING)),
            Vec2::ZERO,
            response,
        )
    }
}

/// Nearer to 0 than this an axis stands at 0: a finger that goes straight up does not go exactly straight.
const ROUNDING: f32 = 1e-4;

/// Ten fingers, and as many sticks that still wait for room to tell that they are back in the middle.
const MOST_STICKS: usize = 2 * FINGERS_OF_BOTH_HANDS;

/// The joysticks of a layout.
///
/// The fingertip that presses a cap pushes it from there: how far it is from where it pressed counts, and
/// not where on the cap that was. Others are ignored. When it is released, is lost or strays off, and when
/// everything is let go of, the stick is in the middle: axes are at 0, nothing is pressed, the pointer
/// stands. Positions are not told, other than by what they drive.
#[derive(Clone, Debug)]
pub struct Joysticks {
    joysticks: Vec<Joystick>,
    places: Places,
    /// Those that are held, and those that are not back in the middle yet.
    sticks: ArrayVec<Stick, MOST_STICKS>,
}

impl Joysticks {
    /// All in the middle.
    pub fn new(joysticks: Vec<Joystick>) -> Self {
        Self {
            places: Places::new(joysticks.iter().map(|joystick| joystick.target)),
            joysticks,
            sticks: ArrayVec::new(),
        }
    }

    fn grab(&mut self, touch: &Touch, out: &mut DeviceOutput) {
        self.let_go(touch, out);
        let Some(place) = self.places.of(touch.target) else {
            return;
        };
        let of_place = self.sticks.iter_mut().find(|stick| stick.place == place);
        match of_place {
            Some(stick) if stick.is_held() => {}
            Some(stick) => stick.grab(touch),
            None => {
                // Without room for another it is not held: a missed push.
                let _ = self.sticks.try_push(Stick::new(place, touch));
            }
        }
    }

    fn push(&mut self, touch: &Touch, out: &mut DeviceOutput) {
        let joysticks = &self.joysticks;
        let of_finger = self.sticks.iter_mut().find(|stick| stick.is_of(touch));
        if let Some(stick) = of_finger {
            stick.push(&joysticks[stick.place], touch, out);
        }
    }

    fn let_go(&mut self, touch: &Touch, out: &mut DeviceOutput) {
        let joysticks = &self.joysticks;
        for stick in &mut self.sticks {
            if stick.is_of(touch) {
                stick.let_go(&joysticks[stick.place], touch, out);
            }
        }
    }

    /// Drives what the sticks drive by `time`, and forgets those that are back in the middle.
    fn drive(&mut self, time: Timestamp, seen: Option<&DeviceInput>, out: &mut DeviceOutput) {
        let joysticks = &self.joysticks;
        self.sticks.retain(|stick| {
            let joystick = &joysticks[stick.place];
            let is_in_the_middle = stick.stand(joystick, time, out);
            if seen.is_some_and(|seen| stick.is_of_hand(seen.pose.side)) {
                stick.move_pointer(joystick, time, out);
            }
            stick.is_held() || !is_in_the_middle
        });
    }
}

impl VirtualDevice for Joysticks {
    fn add_capabilities(&self, needs: &mut Capabilities) {
        for stick in &self.joysticks {
            let actions = stick
                .direction_keys
                .into_iter()
                .flatten()
                .chain(stick.push_action);
            needs.extend(actions.filter_map(KeyAction::required_capability));
            needs.extend(stick.axes.into_iter().flatten().map(Capability::Axis));
            needs.extend((stick.pointer_speed_px_s > 0.0).then_some(Capability::RelativeMotion));
        }
    }

    fn update(&mut self, seen: &DeviceInput, out: &mut DeviceOutput) {
        for touch in seen.touches {
            match touch.phase {
                Phase::Touched => {}
                Phase::Pressed => self.grab(touch, out),
                Phase::Moved => self.push(touch, out),
                Phase::Released | Phase::Left | Phase::Cancelled => self.let_go(touch, out),
            }
        }
        self.drive(seen.pose.time, Some(seen), out);
    }

    fn release_all(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        for stick in &mut self.sticks {
            stick.forget();
        }
        self.drive(time, None, out);
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
    fn the_response_begins_at_the_dead_zone_and_ends_at_the_reach() {
        let stick = joystick(0.2, 2.0);
        for (throw, expected) in [(0.1, 0.0), (0.2, 0.0), (0.6, 0.25), (1.0, 1.0), (9.0, 1.0)] {
            let found = stick.response(Vec2::new(0.0, -throw));
            assert!((found.y + expected).abs() < 1e-6, "{throw}: {found}");
            assert_eq!(found.x, 0.0);
        }
        assert_eq!(joystick(0.0, 1.0).response(Vec2::ZERO), Vec2::ZERO);
        let almost_straight = stick.response(Vec2::new(1e-8, 1.0));
        assert_eq!(almost_straight, Vec2::Y, "the other axis stays at 0");
        assert_eq!(stick.response(Vec2::NAN), Vec2::ZERO);
    }

    #[test]
    fn a_diagonal_is_no_longer_than_the_sides() {
        let found = joystick(0.1, 1.0).response(Vec2::new(3.0, 3.0));
        assert!((found.length() - 1.0).abs() < 1e-6 && found.x == found.y);
    }
}
