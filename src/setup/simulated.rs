//! The simulated hand of a setup: what it types and plays, and what it cannot reach.

use parry3d::math::Vec2;

use super::{LoadedSetup, SetupError};
use crate::capture::Hc11Format;
use crate::contact::TargetId;
use crate::hand::Side;
use crate::layout::{ControlKind, SpaceTargets};
use crate::sim::{
    self, ActionError, ActionErrorKind, HandAction, REACH_TOLERANCE, Script, SimulatedTypist,
    TypingHand, TypistError, TypistSettings,
};

impl LoadedSetup {
    /// A simulated hand that types `text` on this layout with this glove, at the pace of `line`.
    pub fn typist(
        &self,
        text: &str,
        line: &Hc11Format,
        noise_counts: f64,
        seed: u64,
    ) -> Result<SimulatedTypist, SetupError> {
        let orders = sim::taps_for_text(text, &self.layout.key_bindings());
        let orders = orders.map_err(TypistError::from)?;
        let settings = TypistSettings {
            name: format!("typist:{text}"),
            packet_period: line.packet_period(),
            noise_counts,
            seed,
        };
        self.hand_that_plays(&orders, &settings)
            .map_err(|error| match self.told(&error) {
                Some(message) => SetupError::Value(format!(
                    "cannot type on {}: key {message}",
                    self.layout.file,
                )),
                None => error.into(),
            })
    }

    /// A simulated hand that plays a script, in a file or as it stands, on this layout with this glove,
    /// at the pace of `line`.
    pub fn scripted(
        &self,
        path_or_text: &str,
        line: &Hc11Format,
        noise_counts: f64,
        seed: u64,
    ) -> Result<SimulatedTypist, SetupError> {
        let script = Script::open(path_or_text, &self.layout.target_names())?;
        let settings = TypistSettings {
            name: format!("script:{}", script.file()),
            packet_period: line.packet_period(),
            noise_counts,
            seed,
        };
        self.hand_that_plays(script.actions(), &settings)
            .map_err(|error| match &error {
                TypistError::Action(refusal) => {
                    let message = self.told(&error).unwrap_or_else(|| error.to_string());
                    script.error(refusal.index, message).into()
                }
                TypistError::CannotType(_) => error.into(),
            })
    }

    fn hand_that_plays(
        &self,
        orders: &[HandAction],
        settings: &TypistSettings,
    ) -> Result<SimulatedTypist, TypistError> {
        let mut hands = vec![(&self.arm, &self.glove.map)];
        hands.extend(
            self.other_hand
                .iter()
                .map(|worn| (&worn.arm, &worn.glove.map)),
        );
        SimulatedTypist::with_hands(settings, orders, &self.layout.scene, &hands)
    }

    /// What a person reads of an error about a target: its name instead of its number.
    fn told(&self, error: &TypistError) -> Option<String> {
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
                "`{name}` is {:.0} mm out of reach of the simulated hand; move the board nearer or make \
                 it smaller",
                metres * 1e3
            ),
            false => {
                format!("`{name}` is there for the other hand; give the setup an `other_hand`")
            }
        })
    }

    /// What the simulated hand cannot press, keys and other controls, and how far beyond its reach each
    /// is, in metres. Of a slider or lever the ends of its track count too. Keys of chords are left out:
    /// each is for a finger of its own, and the hand reaches with one only. Of targets in space that a
    /// fingertip selects the middle has to be within reach.
    pub fn out_of_reach(&self) -> Vec<(&str, f64)> {
        let hands =
            [self.glove.side, self.glove.side.opposite()].map(|side| self.typing_hand(side));
        let keys = self.layout.keys.iter().map(|key| &key.face);
        let keys = keys.filter(|front| !self.layout.is_chord_key(front.target));
        let keys = keys.map(|front| (front, 0.0));
        let controls = self.layout.controls.iter().flat_map(|control| {
            let half_length = match &control.kind {
                ControlKind::Slider(slider) => slider.half_length,
                _ => 0.0,
            };
            control.faces.iter().map(move |front| (front, half_length))
        });
        keys.chain(controls)
            .filter_map(|(front, half_length)| {
                let ends = [-half_length, half_length].map(|x| Vec2::X * x);
                let beyond = ends.map(|end| self.beyond(&hands, front.target, end));
                let beyond = beyond.into_iter().flatten().reduce(f64::max)?;
                Some((front.name.as_str(), beyond))
            })
            .chain(self.spaces_out_of_reach(&hands))
            .collect()
    }

    /// Targets in space; those that a pointer selects are reached by the pointer.
    fn spaces_out_of_reach(&self, hands: &[TypingHand]) -> Vec<(&str, f64)> {
        let mut found = Vec::new();
        if self.layout.pointer.is_some() {
            return found;
        }
        for SpaceTargets { names, space } in &self.layout.spaces {
            for (name, volume) in names.iter().zip(space.volumes.iter()) {
                let beyond = hands.iter().map(|hand| {
                    let world_from_space = space
                        .frame
                        .world_from_frame(&hand.pose(&hand.rest_values()));
                    let tip = world_from_space? * volume.center;
                    Some(hand.reach(tip, &mut hand.rest_values(), &[]))
                });
                let nearest = beyond.flatten().fold(f64::INFINITY, f64::min);
                if nearest > REACH_TOLERANCE {
                    found.push((name.as_str(), nearest));
                }
            }
        }
        found
    }

    /// How far beyond the reach of the nearer hand a place on a target is, in metres.
    fn beyond(&self, hands: &[TypingHand], target: TargetId, at: Vec2) -> Option<f64> {
        let mut nearest = f64::INFINITY;
        for hand in hands {
            match hand.tap_path_at(&self.layout.scene, target, at) {
                Ok(_) => return None,
                Err(distance) => nearest = nearest.min(distance),
            }
        }
        Some(nearest)
    }

    /// The simulated hand of a side: with the glove of this setup where there is one for it, else in a
    /// mirror.
    fn typing_hand(&self, side: Side) -> TypingHand {
        match &self.other_hand {
            Some(other) if other.glove.side == side => {
                TypingHand::new(&other.arm, &other.glove.map)
            }
            _ => TypingHand::new(&self.arm.clone().for_side(side), &self.glove.map),
        }
    }
}
