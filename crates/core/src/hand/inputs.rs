//! Sticks, triggers and buttons on a glove.

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

/// The values of the inputs of a glove, some of which may not be known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InputValues {
    values: [f32; Input::COUNT],
    known: u16,
}

impl InputValues {
    /// Sets a value, −1..=1; a button is 1 while it is down.
    pub fn set(&mut self, input: Input, value: f32) {
        self.values[input.index()] = value;
        self.known |= 1 << input.index();
    }

    /// Returns a value, −1..=1, or `None` if it is not known.
    pub fn get(&self, input: Input) -> Option<f32> {
        (self.known & (1 << input.index()) != 0).then(|| self.values[input.index()])
    }
}
