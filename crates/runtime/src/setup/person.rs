//! The person of a setup: agreement with its gloves and sources, and the simulated person.

use super::{ArmSetup, LoadedSetup, Setup, SetupError};
use ademan_core::hand::Side;
use ademan_core::layout::{HandUse, Person};
use ademan_core::message::escape;

impl Setup {
    /// Refuses a person whose hands do not match the gloves and sources.
    pub(super) fn check_person(
        &self,
        person: &Person,
        has_glove: bool,
        side: Side,
    ) -> Result<(), SetupError> {
        if let Some(own) = person.side.filter(|own| *own != side) {
            let message = if has_glove {
                format!(
                    "`person` types with the {own} hand, but the glove is for the {side} hand; choose a glove for the {own} hand, or set `side: \"{side}\"` in the file of the person"
                )
            } else {
                format!(
                    "`person` types with the {own} hand, but the source shows the {side} hand; add the option `hand={own}` to the source, or set `side: \"{side}\"` in the file of the person"
                )
            };
            return Err(SetupError::Value(message));
        }
        if person.hands == HandUse::One && self.other_hand.is_some() {
            let message = "`person` uses one hand, but the setup has two; remove `other_hand`, or set `hands: Both` in the file of the person";
            return Err(SetupError::Value(message.into()));
        }
        Ok(())
    }
}

impl LoadedSetup {
    /// Returns a note if the arm of the setup replaces the lengths of its person.
    pub fn person_note(&self) -> Option<String> {
        self.person.bones.as_ref()?;
        let arm = match &self.setup.arm {
            ArmSetup::Person => return None,
            ArmSetup::Model(name) => {
                format!("the arm model `{}` of the setup applies", escape(name))
            }
            ArmSetup::Measured { .. } => "the lengths in `arm` of the setup apply".to_owned(),
        };
        let person = self.setup.person.as_deref().unwrap_or_default();
        Some(format!(
            "{arm}, not the lengths of the person {}; remove `arm` to use those",
            escape(person)
        ))
    }
}
