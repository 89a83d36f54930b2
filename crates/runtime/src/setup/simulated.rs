//! The simulated hands of a setup, which type texts and play scripts.

use std::fmt;
use std::sync::Arc;
use std::time::Duration;

use super::{LoadedSetup, SetupError, TargetOutOfReach};
use crate::capture::{Hc11Format, SampleKind, StreamFormat};
use crate::sim::{
    self, ActionError, ActionErrorKind, HandAction, HandTask, Script, Sensor, SimulatedStream,
    SimulatedTypist, TourStop, TypingKeys, TypistError, TypistSettings, open_script,
};
use ademan_core::contact::TargetId;
use ademan_core::kinematics::ArmModel;
use ademan_core::layout::{Layout, Person};
use ademan_core::message::escape;

/// The name of the source of a [live hand](LoadedSetup::live_hand).
pub const SIMULATED_HAND: &str = "simulated hand";

/// The largest number of keys, and of other controls, of a layout whose presses are tried.
const MAX_TRIED: usize = 500;

/// The largest number of controls that a tour leaves out because they cannot be used after the others.
const MAX_LEFT_OUT: usize = 20;

/// A control within reach that the simulated hand cannot press. It is displayed in one line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnpressableControl {
    /// The target.
    pub target: TargetId,
    name: String,
    /// The reason and the remedy.
    reason: String,
}

impl fmt::Display for UnpressableControl {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, reason, .. } = self;
        write!(
            f,
            "`{}` cannot be pressed by the simulated hand: {reason}",
            escape(name)
        )
    }
}

impl LoadedSetup {
    /// Returns a simulated hand that types `text` on the layout and sends packets in `format`.
    pub fn typist(
        &self,
        text: &str,
        format: &Hc11Format,
        noise: f64,
        seed: u64,
    ) -> Result<SimulatedTypist, SetupError> {
        let name = format!("typist:{text}");
        let settings = self.typist_settings(name, format.packet_period(), noise, seed);
        let kind = self.simulated_kind(self.layout.follows_body());
        self.typist_with(text, &settings, kind)
    }

    /// Returns a simulated hand that types `text` on the layout through the bytes of a protocol.
    pub fn encoded_typist(
        &self,
        text: &str,
        format: &StreamFormat,
        noise: f64,
        seed: u64,
    ) -> Result<SimulatedStream, SetupError> {
        let name = format!("typist:{text}{format}");
        let settings = self.typist_settings(name, sim::packet_period(format), noise, seed);
        let typist = self.typist_with(text, &settings, format.protocol.sample)?;
        SimulatedStream::new(typist, format).map_err(|reason| {
            let typist_name = escape(&settings.name);
            SetupError::Value(format!("cannot use {typist_name}: {reason}"))
        })
    }

    fn typist_with(
        &self,
        text: &str,
        settings: &TypistSettings,
        kind: SampleKind,
    ) -> Result<SimulatedTypist, SetupError> {
        let finds_letters = self.finds_letters();
        let actions = sim::actions_for_text(text, &self.layout, finds_letters);
        let actions = actions.map_err(TypistError::from)?;
        let hands = self.hands(kind)?;
        let hands = borrowed(&hands);
        let typist = SimulatedTypist::with_hands(settings, &actions, &self.layout.scene, &hands);
        let typist = typist.map_err(|error| match self.reach_message(&error) {
            Some(_) if self.measures_no_arm() && kind == SampleKind::Channels => {
                SetupError::Value(format!(
                    "cannot type on {}: the glove does not measure the arm, so only keys below the fingers can be \
                         pressed; choose a layout of fingers that bend, such as `chords-bend`, or play a script",
                    escape(&self.layout.file),
                ))
            }
            Some(message) => SetupError::Value(format!(
                "cannot type on {}: key {}",
                escape(&self.layout.file),
                self.at_key(&error, &actions, message),
            )),
            None => error.into(),
        })?;
        let text = text.to_owned();
        let task = HandTask::Text {
            text,
            finds_letters,
        };
        Ok(self.following(typist, task))
    }

    fn following(&self, typist: SimulatedTypist, task: HandTask) -> SimulatedTypist {
        typist.following(task, Arc::new(self.layout.clone()), &self.layout_feed)
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
        let typist = self.planned(&script, format, noise, seed)?;
        let typist = typist.map_err(|error| {
            let message = self.reach_message(&error);
            script_error(&script, error, message)
        })?;
        Ok(self.following(typist, HandTask::Script(script)))
    }

    /// Returns a simulated hand that plays a script, and does not follow the layout.
    fn planned(
        &self,
        script: &Script,
        format: &Hc11Format,
        noise: f64,
        seed: u64,
    ) -> Result<Result<SimulatedTypist, TypistError>, SetupError> {
        let name = format!("script:{}", script.file());
        let settings = self.typist_settings(name, format.packet_period(), noise, seed);
        let hands = self.hands(self.scripted_kind())?;
        let hands = borrowed(&hands);
        let scene = &self.layout.scene;
        let fit = &self.layout.fit;
        let actions = script.actions().iter().cloned();
        let actions: Vec<HandAction> = actions.map(|action| action.placed(fit)).collect();
        Ok(SimulatedTypist::with_hands(
            &settings, &actions, scene, &hands,
        ))
    }

    /// Returns a simulated hand that repeats a task as far as the layout permits, and sends packets in `format`. It reports the parts
    /// that it leaves out.
    pub fn live_hand(
        &self,
        task: HandTask,
        format: &Hc11Format,
    ) -> Result<SimulatedTypist, SetupError> {
        let settings = self.live_settings(format.packet_period(), 0.0);
        let hands = self.hands(self.scripted_kind())?;
        let hands = borrowed(&hands);
        let layout = Arc::new(self.layout.clone());
        let typist = SimulatedTypist::live(&settings, task, layout, &self.layout_feed, &hands)?;
        Ok(typist.repeated())
    }

    /// Gives a [live hand](Self::live_hand) of this setup its simulated person, with sensors of this noise: a standard
    /// deviation in counts of a glove, or in millimetres of a camera. The hand continues with its task.
    pub fn change_live_hand(
        &self,
        hand: &mut SimulatedTypist,
        noise: f64,
    ) -> Result<(), SetupError> {
        let settings = self.live_settings(hand.packet_period(), noise);
        let hands = self.hands(self.scripted_kind())?;
        Ok(hand.change(&settings, &borrowed(&hands))?)
    }

    /// Replaces the simulated person, whose arm stays: the boards were placed for it. Refuses a person with other hands than the setup.
    pub fn simulate(&mut self, person: &Person) -> Result<(), SetupError> {
        let side = self.arm.side();
        self.setup
            .check_person(person, self.glove.is_some(), side)?;
        self.simulated_person = Person {
            bones: self.simulated_person.bones,
            ..person.clone()
        };
        Ok(())
    }

    fn live_settings(&self, packet_period: Duration, noise: f64) -> TypistSettings {
        self.typist_settings(SIMULATED_HAND.to_owned(), packet_period, noise, 0)
    }

    /// Returns the settings of the simulated person on the active layout.
    fn typist_settings(
        &self,
        name: String,
        packet_period: Duration,
        noise: f64,
        seed: u64,
    ) -> TypistSettings {
        TypistSettings {
            name,
            packet_period,
            noise,
            seed,
            person: self.simulated_person.clone(),
            keys: TypingKeys::new(&self.layout),
        }
    }

    /// Returns a script that uses each control of the layout once, as far as the simulated hands can. Comments name what it leaves out.
    pub fn tour(&self) -> String {
        let names = self.layout.target_names();
        // The advice about reach is not shown; for each one the layout is built again.
        let play = |text: &str| -> Result<(), SetupError> {
            let script = open_script(text, &names)?;
            let planned = self.planned(&script, &Hc11Format::default(), 0.0, 0)?;
            planned
                .map(drop)
                .map_err(|error| script_error(&script, error, None))
        };
        let (mut stops, mut others): (Vec<TourStop>, Vec<TourStop>) = sim::aimed_tour(&self.layout)
            .into_iter()
            .partition(|stop| play(&stop.actions).is_ok());
        // From where the hand is after another control, a raised one may be in the way, or the end of the reach a little nearer.
        for _ in 0..MAX_LEFT_OUT {
            let text = sim::tour_text(&self.layout, &stops);
            let Err(SetupError::File(error)) = play(&text) else {
                break;
            };
            // The first line is the title.
            let failed = error.line().and_then(|line| line.checked_sub(2));
            let Some(failed) = failed.filter(|index| *index < stops.len()) else {
                break;
            };
            others.push(stops.remove(failed));
        }
        let mut text = sim::tour_text(&self.layout, &stops);
        for stop in others {
            let name = escape(&stop.name);
            text.push_str(&format!(
                "# left out, as the simulated hand cannot use it: {name}\n"
            ));
        }
        text
    }

    /// Returns the controls of another layout that the simulated hand cannot press. Leaves out the
    /// targets [out of reach](super::HandReach::on_boards) of the hands of the setup, keys that are pressed by bending, and keys of
    /// chords.
    pub fn controls_without_press(
        &self,
        layout: &Layout,
        out_of_reach: &[TargetOutOfReach],
    ) -> Vec<UnpressableControl> {
        let mut own = self.clone();
        own.layout = layout.clone();
        let Ok(hands) = own.hands(own.scripted_kind()) else {
            return Vec::new();
        };
        let hands = borrowed(&hands);
        let settings = own.live_settings(Hc11Format::default().packet_period(), 0.0);
        let failure = |actions: &[HandAction]| {
            let planned = SimulatedTypist::with_hands(&settings, actions, &layout.scene, &hands);
            match planned {
                Err(TypistError::Action(error)) => Some(error.kind),
                _ => None,
            }
        };
        let is_tried = |target: &TargetId| {
            let found = layout.scene.target(*target);
            let is_bent = found.is_none_or(|(surface, _)| surface.is_bent());
            let is_reached = out_of_reach.iter().all(|other| other.target != *target);
            is_reached && !is_bent && !layout.is_chord_key(*target)
        };
        let keys = layout.keys.iter().map(|key| key.face.target);
        let keys = keys
            .filter(is_tried)
            .map(|key| (key, vec![HandAction::tap(key)]));
        let keys = keys.take(MAX_TRIED);
        let failed_keys = keys.filter_map(|(key, actions)| Some((key, failure(&actions)?)));
        let uses = control_uses(layout).filter(|(control, _)| is_tried(control));
        let uses = uses.take(MAX_TRIED);
        let failed = uses.filter_map(|(control, actions)| Some((control, failure(&actions)?)));
        // A track out of reach is a matter of reach.
        let failed = failed.filter(|(_, kind)| matches!(kind, ActionErrorKind::WouldPress { .. }));
        let names = layout.target_names();
        let found = failed_keys.chain(failed).filter_map(|(target, kind)| {
            Some(UnpressableControl {
                target,
                name: names.get(target).to_string(),
                reason: reason_without_press(kind, layout)?,
            })
        });
        found.collect()
    }

    /// Returns what a script moves.
    fn scripted_kind(&self) -> SampleKind {
        let layout = &self.layout;
        self.simulated_kind(layout.uses_body() || layout.follows_body())
    }

    /// Returns what the simulated person moves: a camera that sees the person if the body counts, a headset that sees both hands in
    /// one room if one carries a board of the other, else a glove.
    fn simulated_kind(&self, sees_body: bool) -> SampleKind {
        if sees_body {
            SampleKind::Body
        } else if self.layout.follows_other_hand() {
            SampleKind::Joints
        } else {
            SampleKind::Channels
        }
    }

    /// Returns the arm of the simulated person in place of an arm of the setup.
    fn simulated_arm(&self, assumed: &ArmModel) -> Result<ArmModel, SetupError> {
        match self.simulated_person.arm(assumed.side()) {
            Some(own) => own.map_err(|error| SetupError::Value(error.to_string())),
            None => Ok(assumed.clone()),
        }
    }

    /// Returns the arms of the simulated hands with sensors whose samples are of this kind.
    fn hands(&self, kind: SampleKind) -> Result<Vec<(ArmModel, Sensor<'_>)>, SetupError> {
        let other = self.other_hand.iter().map(|hand| (&hand.arm, &hand.glove));
        std::iter::once((&self.arm, &self.glove))
            .chain(other)
            .map(|(arm, glove)| {
                let map = glove.as_ref().map(|glove| &glove.map);
                let sensor = Sensor::for_kind(kind, map).ok_or_else(|| {
                    let message = "a simulated hand needs a glove; add `glove` to the setup";
                    SetupError::Value(message.into())
                })?;
                Ok((self.simulated_arm(arm)?, sensor))
            })
            .collect()
    }

    /// Returns `true` if the first hand has a glove that measures its fingers only, and no source measures its arm.
    pub(super) fn measures_no_arm(&self) -> bool {
        if self.setup.arm_source.is_some() {
            return false;
        }
        let rows = self.glove.iter().flat_map(|glove| glove.map.rows());
        rows.clone().next().is_some() && rows.into_iter().all(|row| row.dof.finger().is_some())
    }

    /// Returns a message that begins with the key that is meant, from the message for an action of a text.
    fn at_key(&self, error: &TypistError, actions: &[HandAction], message: String) -> String {
        let TypistError::Action(ActionError {
            index,
            kind: ActionErrorKind::WouldPress { .. },
        }) = error
        else {
            return message;
        };
        let Some(target) = actions.get(*index).and_then(HandAction::target) else {
            return message;
        };
        let name = self.layout.target_names().get(target).to_string();
        format!("`{}` cannot be pressed: {message}", escape(&name))
    }

    /// Returns the message for a target that no finger presses alone, with its name.
    fn reach_message(&self, error: &TypistError) -> Option<String> {
        let TypistError::Action(ActionError { kind, .. }) = error else {
            return None;
        };
        let names = self.layout.target_names();
        let name = |target| escape(&names.get(target).to_string()).to_string();
        Some(match kind {
            ActionErrorKind::OutOfReach {
                target: Some(target),
                metres,
            } if metres.is_finite() => {
                let report = self.reach_report(&self.layout);
                // A script may push beyond what a tap needs.
                let advice = report.map(|report| report.advice);
                format!(
                    "`{}` is {:.0} mm out of reach of the simulated hand; {}",
                    name(*target),
                    metres * 1e3,
                    advice
                        .as_deref()
                        .unwrap_or("move the board, or change the script")
                )
            }
            ActionErrorKind::OutOfReach {
                target: Some(target),
                ..
            } => format!(
                "`{}` is reserved for the other hand; name a glove of that hand, such as `unam-hc11-left`, or add an \
                 `other_hand` to the setup",
                name(*target)
            ),
            ActionErrorKind::WouldPress { finger, target } => format!(
                "the {} of the simulated hand would press `{}`; make the keys smaller or move them apart",
                finger.in_words(),
                name(*target)
            ),
            ActionErrorKind::WouldMiss(target) => format!(
                "`{}` cannot be pressed: another control is in front of it",
                name(*target)
            ),
            _ => return None,
        })
    }
}

/// Iterates over the controls that are no keys, with actions that use each one.
fn control_uses(layout: &Layout) -> impl Iterator<Item = (TargetId, Vec<HandAction>)> {
    let names = layout.target_names();
    let faces = layout.controls.iter().flat_map(|control| &control.faces);
    let controls: Vec<TargetId> = faces.map(|face| face.target).collect();
    sim::tour(layout).into_iter().filter_map(move |stop| {
        let script = open_script(&stop.actions, &names).ok()?;
        let actions = script.actions().to_vec();
        let target = actions.first()?.target()?;
        controls.contains(&target).then_some((target, actions))
    })
}

/// Returns the reason why a target is not pressed, and the remedy; `None` if it needs another hand or other actions.
fn reason_without_press(kind: ActionErrorKind, layout: &Layout) -> Option<String> {
    match kind {
        ActionErrorKind::WouldPress { finger, target } => {
            let name = layout.target_names().get(target).to_string();
            Some(format!(
                "its {} would press `{}`; make the keys smaller or move them apart",
                finger.in_words(),
                escape(&name)
            ))
        }
        ActionErrorKind::OutOfReach { metres, .. } if metres.is_finite() => Some(format!(
            "its finger stays {:.0} mm away; move it or its board",
            metres * 1e3
        )),
        other @ (ActionErrorKind::WouldMiss(_) | ActionErrorKind::NoWay) => {
            Some(format!("{other}; move it or its board"))
        }
        _ => None,
    }
}

/// Returns the error at the action of a script that cannot be performed; `message` takes the place of its own message.
fn script_error(script: &Script, error: TypistError, message: Option<String>) -> SetupError {
    match &error {
        TypistError::Action(action_error) => {
            let message = message.unwrap_or_else(|| error.to_string());
            script.error(action_error.index, message).into()
        }
        TypistError::CannotType(_) => error.into(),
    }
}

fn borrowed<'a>(hands: &'a [(ArmModel, Sensor<'a>)]) -> Vec<(&'a ArmModel, Sensor<'a>)> {
    hands.iter().map(|(arm, sensor)| (arm, *sensor)).collect()
}

#[cfg(test)]
mod tests {
    use crate::capture::{Hc11Format, Reading, Source, SourceEvent};
    use crate::setup::Setup;

    #[test]
    fn a_repeated_typist_moves_as_at_first_and_time_goes_on() {
        let setup = Setup::default().load_files().unwrap();
        let typist = setup.typist("a", &Hc11Format::default(), 0.0, 0).unwrap();
        let count = typist.count_packets() as usize;
        let mut repeated = typist.repeated();
        let next = || match repeated.next() {
            Ok(SourceEvent::Reading(reading)) => Some(reading),
            _ => None,
        };
        let readings: Vec<Reading> = std::iter::from_fn(next).take(3 * count).collect();
        assert!(readings.is_sorted_by(|one, other| one.time < other.time));
        let samples: Vec<_> = readings.iter().map(|reading| &reading.sample).collect();
        assert_eq!(samples[..count], samples[count..2 * count]);
        assert_eq!(samples[..count], samples[2 * count..]);
    }
}
