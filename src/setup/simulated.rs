//! The simulated hands of a setup, which type texts and play scripts.

use super::{LoadedSetup, SetupError};
use crate::capture::Hc11Format;
use crate::estimate::ChannelMap;
use crate::kinematics::ArmModel;
use crate::sim::{
    self, ActionError, ActionErrorKind, HandAction, Script, SimulatedTypist, TypistError,
    TypistSettings,
};

impl LoadedSetup {
    /// Returns a simulated hand that types `text` on the layout and sends packets in `format`.
    pub fn typist(
        &self,
        text: &str,
        format: &Hc11Format,
        noise_counts: f64,
        seed: u64,
    ) -> Result<SimulatedTypist, SetupError> {
        let actions = sim::taps_for_text(text, &self.layout.key_bindings());
        let actions = actions.map_err(TypistError::from)?;
        let settings = TypistSettings {
            name: format!("typist:{text}"),
            packet_period: format.packet_period(),
            noise_counts,
            seed,
        };
        let hands = self.hands()?;
        SimulatedTypist::with_hands(&settings, &actions, &self.layout.scene, &hands).map_err(
            |error| match self.reach_message(&error) {
                Some(message) => SetupError::Value(format!(
                    "cannot type on {}: key {message}",
                    self.layout.file,
                )),
                None => error.into(),
            },
        )
    }

    /// Returns a simulated hand that plays a script, a path or the text itself, and sends packets in `format`.
    pub fn scripted(
        &self,
        path_or_text: &str,
        format: &Hc11Format,
        noise_counts: f64,
        seed: u64,
    ) -> Result<SimulatedTypist, SetupError> {
        let script = Script::open(path_or_text, &self.layout.target_names())?;
        let settings = TypistSettings {
            name: format!("script:{}", script.file()),
            packet_period: format.packet_period(),
            noise_counts,
            seed,
        };
        let hands = self.hands()?;
        let scene = &self.layout.scene;
        let actions = self.placed(script.actions());
        SimulatedTypist::with_hands(&settings, &actions, scene, &hands).map_err(
            |error| match &error {
                TypistError::Action(action_error) => {
                    let message = self.reach_message(&error);
                    let message = message.unwrap_or_else(|| error.to_string());
                    script.error(action_error.index, message).into()
                }
                TypistError::CannotType(_) => error.into(),
            },
        )
    }

    /// Returns the actions with the positions in space where the first hand finds them, as it finds targets in space.
    fn placed(&self, actions: &[HandAction]) -> Vec<HandAction> {
        let fit = &self.layout.fit;
        let place = |action: &HandAction| match action {
            HandAction::Point(position, time) => {
                HandAction::Point(fit.position_from_elbow(*position), *time)
            }
            other => other.clone(),
        };
        actions.iter().map(place).collect()
    }

    /// Returns the arms and channel maps of the simulated hands, which move the channels of gloves.
    fn hands(&self) -> Result<Vec<(&ArmModel, &ChannelMap)>, SetupError> {
        let other = self.other_hand.iter().map(|hand| (&hand.arm, &hand.glove));
        std::iter::once((&self.arm, &self.glove))
            .chain(other)
            .map(|(arm, glove)| match glove {
                Some(glove) => Ok((arm, &glove.map)),
                None => Err(SetupError::Value(
                    "a simulated hand needs a glove; add `glove` to the setup".into(),
                )),
            })
            .collect()
    }

    /// Returns the message for a target out of reach, with its name.
    fn reach_message(&self, error: &TypistError) -> Option<String> {
        let TypistError::Action(ActionError {
            kind:
                ActionErrorKind::OutOfReach {
                    target: Some(target),
                    metres,
                },
            ..
        }) = error
        else {
            return None;
        };
        let names = self.layout.target_names();
        let name = names.get(*target);
        Some(match metres.is_finite() {
            true => format!(
                "`{name}` is {:.0} mm out of reach of the simulated hand; move the board nearer or make it smaller",
                metres * 1e3
            ),
            false => {
                format!("`{name}` is reserved for the other hand; add an `other_hand` to the setup")
            }
        })
    }
}
