//! The simulated hands of a setup, which type texts and play scripts.

use super::{LoadedSetup, SetupError};
use crate::capture::{Hc11Format, SampleKind, StreamFormat};
use crate::kinematics::ArmModel;
use crate::message::escape;
use crate::sim::{
    self, ActionError, ActionErrorKind, HandAction, Sensor, SimulatedStream, SimulatedTypist,
    TypistError, TypistSettings, open_script,
};

impl LoadedSetup {
    /// Returns a simulated hand that types `text` on the layout and sends packets in `format`.
    pub fn typist(
        &self,
        text: &str,
        format: &Hc11Format,
        noise: f64,
        seed: u64,
    ) -> Result<SimulatedTypist, SetupError> {
        let settings = TypistSettings {
            name: format!("typist:{text}"),
            packet_period: format.packet_period(),
            noise,
            seed,
        };
        self.typist_with(text, &settings, SampleKind::Channels)
    }

    /// Returns a simulated hand that types `text` on the layout through the bytes of a protocol.
    pub fn encoded_typist(
        &self,
        text: &str,
        format: &StreamFormat,
        noise: f64,
        seed: u64,
    ) -> Result<SimulatedStream, SetupError> {
        let settings = TypistSettings {
            name: format!("typist:{text}{format}"),
            packet_period: sim::packet_period(format),
            noise,
            seed,
        };
        let typist = self.typist_with(text, &settings, format.protocol.sample)?;
        SimulatedStream::new(typist, format).map_err(|reason| {
            let name = escape(&settings.name);
            SetupError::Value(format!("cannot use {name}: {reason}"))
        })
    }

    fn typist_with(
        &self,
        text: &str,
        settings: &TypistSettings,
        kind: SampleKind,
    ) -> Result<SimulatedTypist, SetupError> {
        let actions =
            sim::taps_for_text(text, &self.layout.key_bindings(), self.layout.bend_chords());
        let actions = actions.map_err(TypistError::from)?;
        let hands = self.hands(kind)?;
        SimulatedTypist::with_hands(settings, &actions, &self.layout.scene, &hands).map_err(
            |error| match self.reach_message(&error) {
                Some(_) if self.measures_no_arm() && kind == SampleKind::Channels => {
                    SetupError::Value(format!(
                        "cannot type on {}: the glove does not measure the arm, so only keys below the fingers can be \
                         pressed; choose a layout of fingers that bend, such as `chords-bend`, or play a script",
                        escape(&self.layout.file),
                    ))
                }
                Some(message) => SetupError::Value(format!(
                    "cannot type on {}: key {message}",
                    escape(&self.layout.file),
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
        noise: f64,
        seed: u64,
    ) -> Result<SimulatedTypist, SetupError> {
        let script = open_script(path_or_text, &self.layout.target_names())?;
        let settings = TypistSettings {
            name: format!("script:{}", script.file()),
            packet_period: format.packet_period(),
            noise,
            seed,
        };
        let hands = self.hands(SampleKind::Channels)?;
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

    /// Returns the arms of the simulated hands with sensors whose samples are of this kind.
    fn hands(&self, kind: SampleKind) -> Result<Vec<(&ArmModel, Sensor<'_>)>, SetupError> {
        let other = self.other_hand.iter().map(|hand| (&hand.arm, &hand.glove));
        std::iter::once((&self.arm, &self.glove))
            .chain(other)
            .map(|(arm, glove)| {
                let map = glove.as_ref().map(|glove| &glove.map);
                let sensor = Sensor::for_kind(kind, map).ok_or_else(|| {
                    let message = "a simulated hand needs a glove; add `glove` to the setup";
                    SetupError::Value(message.into())
                })?;
                Ok((arm, sensor))
            })
            .collect()
    }

    /// Returns whether the first hand has a glove that measures its fingers only.
    fn measures_no_arm(&self) -> bool {
        let rows = self.glove.iter().flat_map(|glove| glove.map.rows());
        rows.clone().next().is_some() && rows.into_iter().all(|row| row.dof.finger().is_some())
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
        let name = names.get(*target).to_string();
        let name = escape(&name);
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

#[cfg(test)]
mod tests {
    use crate::capture::{Hc11Format, Reading, Source, SourceEvent};
    use crate::setup::Setup;
    use crate::sim::RepeatedTypist;

    #[test]
    fn a_repeated_typist_moves_as_at_first_and_time_goes_on() {
        let setup = Setup::default().load_files().unwrap();
        let typist = setup.typist("a", &Hc11Format::default(), 0.0, 0).unwrap();
        let count = typist.count_packets() as usize;
        let mut repeated = RepeatedTypist::new(typist);
        let next = || match repeated.next() {
            Ok(SourceEvent::Reading(reading)) => Some(reading),
            _ => None,
        };
        let readings: Vec<Reading> = std::iter::from_fn(next).take(3 * count).collect();
        assert!(readings.is_sorted_by(|one, next| one.time < next.time));
        let samples: Vec<_> = readings.iter().map(|reading| &reading.sample).collect();
        assert_eq!(samples[..count], samples[count..2 * count]);
        assert_eq!(samples[..count], samples[2 * count..]);
    }
}
