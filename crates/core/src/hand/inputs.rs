//! Sticks, triggers and buttons on a glove, and angles of the body as inputs.

use super::BodyAngle;
use crate::names::named_enum;

named_enum! {
    /// A stick, trigger or button on a glove, or a gesture that the glove itself detects.
    pub enum Input ("input of a glove") {
        /// The stick, −1..=1: to the right.
        StickX = "stick-x",
        /// The stick, −1..=1: away from the wearer.
        StickY = "stick-y",
        /// The stick pushed in.
        StickButton = "stick-button",
        /// The analogue trigger, 0..=1.
        Trigger = "trigger",
        /// The trigger pulled to its end.
        TriggerButton = "trigger-button",
        /// Button A.
        ButtonA = "button-a",
        /// Button B.
        ButtonB = "button-b",
        /// The gesture of a fist.
        Grab = "grab",
        /// The gesture of a pinch.
        Pinch = "pinch",
        /// The menu button.
        Menu = "menu",
        /// The calibration button.
        Calibrate = "calibrate",
    }
}

/// The values of the inputs of a glove and the angles of the body, some of which may not be known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InputValues {
    values: [f32; Input::COUNT],
    known: u16,
    /// The angles of the body, in radians.
    angles: [f32; BodyAngle::COUNT],
    known_angles: u8,
}

impl InputValues {
    /// Sets a value, −1..=1; a button is 1 while it is down.
    pub fn set(&mut self, input: Input, value: f32) {
        self.values[input.index()] = value;
        self.known |= 1 << input.index();
    }

    /// Sets an angle of the body, in radians.
    pub fn set_angle(&mut self, angle: BodyAngle, radians: f32) {
        self.angles[angle.index()] = radians;
        self.known_angles |= 1 << angle.index();
    }

    /// Returns an angle of the body in radians, or `None` if it is not known.
    pub fn angle(&self, angle: BodyAngle) -> Option<f32> {
        (self.known_angles & (1 << angle.index()) != 0).then(|| self.angles[angle.index()])
    }

    /// Returns `true` if an angle of the body is known.
    pub fn has_angles(&self) -> bool {
        self.known_angles != 0
    }

    /// Takes the angles of the body from `other`, if it knows any.
    pub(crate) fn add_angles_of(&mut self, other: &Self) {
        if other.has_angles() {
            self.angles = other.angles;
            self.known_angles = other.known_angles;
        }
    }

    /// Returns a value, −1..=1, or `None` if it is not known.
    pub fn get(&self, input: Input) -> Option<f32> {
        (self.known & (1 << input.index()) != 0).then(|| self.values[input.index()])
    }
}
