//! The simulated hands of a setup: typing, scripts, and the targets out of their reach.

use parry3d::math::Vec2;

use super::{LoadedSetup, SetupError};
use crate::capture::Hc11Format;
use crate::contact::TargetId;
use crate::estimate::ChannelMap;
use crate::hand::Side;
use crate::kinematics::ArmModel;
use crate::layout::{ControlKind, SpaceTargets};
use crate::sim::{
    self, ActionError, ActionErrorKind, HandAction, REACH_TOLERANCE, Script, SimulatedTypist,
    TypingHand, TypistError, TypistSettings,
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

    /// Returns the names of the targets that no simulated hand can press, with the distance beyond its reach in metres.
    ///
    /// Includes both ends of the track of a slider or lever, and the centers of targets in space that a fingertip selects.
    /// Excludes keys of chords, because each has a finger of its own and the simulated hand reaches with one finger.
    pub fn out_of_reach(&self) -> Vec<(&str, f64)> {
        let side = self.arm.side();
        let hands = [side, side.opposite()].map(|side| self.typing_hand(side));
        let keys = self.layout.keys.iter().map(|key| &key.face);
        let keys = keys.filter(|face| !self.layout.is_chord_key(face.target));
        let keys = keys.map(|face| (face, 0.0));
        let controls = self.layout.controls.iter().flat_map(|control| {
            let half_length = match &control.kind {
                ControlKind::Slider(slider) => slider.half_length,
                _ => 0.0,
            };
            control.faces.iter().map(move |face| (face, half_length))
        });
        keys.chain(controls)
            .filter_map(|(face, half_length)| {
                let ends = [-half_length, half_length].map(|x| Vec2::X * x);
                let distances = ends.map(|end| self.distance_beyond(&hands, face.target, end));
                let distance = distances.into_iter().flatten().reduce(f64::max)?;
                Some((face.name.as_str(), distance))
            })
            .chain(self.spaces_out_of_reach(&hands))
            .collect()
    }

    /// As [`out_of_reach`](Self::out_of_reach), for targets in space. A pointer reaches all that it selects.
    fn spaces_out_of_reach(&self, hands: &[TypingHand]) -> Vec<(&str, f64)> {
        let mut found = Vec::new();
        if self.layout.pointer.is_some() {
            return found;
        }
        for SpaceTargets { names, space } in &self.layout.spaces {
            for (name, volume) in names.iter().zip(space.volumes.iter()) {
                let distances = hands.iter().map(|hand| {
                    let pose = hand.pose(&hand.rest_values());
                    let center = space.frame.world_from_frame(&pose)? * volume.center;
                    Some(hand.reach(center, &mut hand.rest_values(), &[]))
                });
                let nearest = distances.flatten().fold(f64::INFINITY, f64::min);
                if nearest > REACH_TOLERANCE {
                    found.push((name.as_str(), nearest));
                }
            }
        }
        found
    }

    /// Returns the distance of a position on a target beyond the reach of the nearer hand, in metres, or `None` if one reaches it.
    fn distance_beyond(
        &self,
        hands: &[TypingHand],
        target: TargetId,
        position: Vec2,
    ) -> Option<f64> {
        let mut nearest = f64::INFINITY;
        for hand in hands {
            match hand.tap_path_at(&self.layout.scene, target, position) {
                Ok(_) => return None,
                Err(distance) => nearest = nearest.min(distance),
            }
        }
        Some(nearest)
    }

    /// Returns the simulated hand of a side. Without a hand on that side, it is the mirrored other hand.
    pub(super) fn typing_hand(&self, side: Side) -> TypingHand {
        let other = self.other_hand.as_ref();
        let other = other.filter(|other| other.arm.side() == side);
        let (arm, glove): (ArmModel, _) = match other {
            Some(other) => (other.arm.clone(), &other.glove),
            None => (self.arm.clone().for_side(side), &self.glove),
        };
        match glove {
            Some(glove) => TypingHand::new(&arm, &glove.map),
            None => TypingHand::new(&arm, &ChannelMap::new(Vec::new(), 255)),
        }
    }
}
