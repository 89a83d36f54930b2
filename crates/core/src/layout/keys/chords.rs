//! Chords: actions of keys that are pressed together.

use serde::Deserialize;

use super::activation::{
    ActivationFields, ActivationSchema, HoldSchema, check_action, check_unlocks,
};
use crate::contact::TargetId;
use crate::device::KeyAction;
use crate::device::keyboard::{Activation, Chord, MAX_CHORD_KEYS};
use crate::device::value_output::ValueOutput;
use crate::document::{DocumentError, Spanned, schema};
use crate::hand::FINGERS_OF_BOTH_HANDS;
use crate::layout::builder::LayoutBuilder;
use crate::layout::model::Key;
use crate::layout::quantity::HoldAfter;
use crate::layout::schema::{Action, LatchSchema};

/// The largest number of keys without an action that are reported: each searches the text for its line.
const MAX_IDLE: usize = 200;

/// The maximum number of chords of a layout. Each press compares all of them.
const MAX_CHORDS: usize = 512;

schema! {
    /// An action of several keys.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "Chord", deny_unknown_fields)]
    pub(in crate::layout) struct ChordSchema<'a> {
        /// Names of 2 to 10 keys, separated by blanks.
        #[serde(borrow)]
        keys: Spanned<'a>,
        /// Action, in the layers that define no other one.
        #[serde(borrow)]
        action: Action<'a>,
        /// Duration of a modifier or layer. Default: `Momentary`.
        #[serde(default)]
        latch: Option<LatchSchema>,
        /// Part of a press that activates the chord. Default: `Press`.
        #[serde(default)]
        activate_on: Option<ActivationSchema>,
        /// Action of a held chord.
        #[serde(borrow, default)]
        hold: Option<HoldSchema<'a>>,
        /// Time after the first press after which a chord counts as held; needs a `hold`.
        #[serde(default)]
        hold_after_ms: Option<HoldAfter>,
    }
}

impl<'a> ChordSchema<'a> {
    /// Adds the chord.
    pub fn build(&self, builder: &mut LayoutBuilder<'a>) -> Result<(), DocumentError> {
        let keys = self.targets(builder)?;
        if chord_index(builder, &keys).is_some() {
            return Err(builder.error(self.keys.text, "duplicate chord"));
        }
        let action = builder.action(self.action, self.latch)?;
        let activation = self.activation_fields().build(builder, Some(action))?;
        self.add(builder, keys, vec![Some(action)], activation)
    }

    /// Adds the action of the chord in the declared layer with this index.
    pub fn build_in_layer(
        &self,
        builder: &mut LayoutBuilder<'a>,
        layer: usize,
    ) -> Result<(), DocumentError> {
        let names = self.keys.text;
        if self.hold.is_some() || self.hold_after_ms.is_some() || self.activate_on.is_some() {
            let message = "a chord has `activate_on`, `hold` and `hold_after_ms` for all layers: write them in the `chords` of the layout";
            return Err(builder.error(names, message));
        }
        let keys = self.targets(builder)?;
        let action = builder.action(self.action, self.latch)?;
        let Some(index) = chord_index(builder, &keys) else {
            let mut actions = vec![None; layer];
            actions.push(Some(action));
            return self.add(builder, keys, actions, Activation::OnPress);
        };
        let Chord {
            ref actions,
            activation,
            ..
        } = builder.chords[index];
        if actions.len() > layer {
            let layer = &builder.layers[layer];
            let message = format!("duplicate chord in the layer `{layer}`");
            return Err(builder.error(names, message));
        }
        let in_base_layer = actions[0];
        check_unlocks(
            builder,
            names,
            &format!("chord `{names}`"),
            in_base_layer,
            layer,
        )?;
        check_action(builder, names, action, activation)?;
        let slots = &mut builder.chords[index].actions;
        slots.resize(layer, None);
        slots.push(Some(action));
        Ok(())
    }

    fn activation_fields(&self) -> ActivationFields<'a> {
        ActivationFields {
            kind: "chord",
            name: self.keys.text,
            activate_on: self.activate_on,
            hold: self.hold,
            hold_after_ms: self.hold_after_ms,
            dwell_ms: None,
        }
    }

    fn add(
        &self,
        builder: &mut LayoutBuilder<'a>,
        keys: Vec<TargetId>,
        actions: Vec<Option<KeyAction>>,
        activation: Activation,
    ) -> Result<(), DocumentError> {
        if builder.chords.len() == MAX_CHORDS {
            let message = format!("a layout has at most {MAX_CHORDS} chords");
            return Err(builder.error(self.keys.text, message));
        }
        builder.chords.push(Chord {
            keys,
            actions,
            activation,
        });
        if chord_keys(builder) > MAX_CHORD_KEYS {
            let message =
                format!("at most {MAX_CHORD_KEYS} keys of a layout can take part in chords");
            return Err(builder.error(self.keys.text, message));
        }
        Ok(())
    }

    /// Returns the targets of the keys, sorted. Rejects duplicates and keys that activate by dwelling.
    fn targets(&self, builder: &LayoutBuilder<'a>) -> Result<Vec<TargetId>, DocumentError> {
        let mut keys: Vec<TargetId> = Vec::new();
        for name in self.keys.text.split_whitespace() {
            let key = &builder.keys[builder.key_index(name)?];
            if let Activation::Dwell(_) = key.activation {
                let message = format!(
                    "the key `{name}` activates by dwelling and cannot take part in chords"
                );
                return Err(builder.error(name, message));
            }
            if keys.contains(&key.face.target) {
                return Err(builder.error(name, format!("duplicate key `{name}` in the chord")));
            }
            keys.push(key.face.target);
        }
        if !(2..=FINGERS_OF_BOTH_HANDS).contains(&keys.len()) {
            let message = format!(
                "a chord has 2 to {FINGERS_OF_BOTH_HANDS} keys, this one has {}",
                keys.len()
            );
            return Err(builder.error(self.keys.text, message));
        }
        keys.sort_unstable();
        Ok(keys)
    }
}

/// Returns the index of the chord with these keys, which are sorted.
fn chord_index(builder: &LayoutBuilder, keys: &[TargetId]) -> Option<usize> {
    let mut chords = builder.chords.iter();
    chords.position(|chord| chord.keys == keys)
}

/// Returns the number of keys that take part in chords.
fn chord_keys(builder: &LayoutBuilder) -> usize {
    let chords = builder.chords.iter();
    let mut keys: Vec<&TargetId> = chords.flat_map(|chord| &chord.keys).collect();
    keys.sort_unstable();
    keys.dedup();
    keys.len()
}

/// Reports keys that have no action in any layer and take part in no chord.
pub(in crate::layout) fn report_idle_keys(builder: &mut LayoutBuilder) {
    let is_idle = |key: &&Key| {
        let mut chords = builder.chords.iter();
        key.actions.iter().all(Option::is_none)
            && key.output == ValueOutput::ValueOnly
            && builder
                .signals
                .iter()
                .all(|(other, _)| *other != key.face.target)
            && !chords.any(|chord| chord.keys.contains(&key.face.target))
    };
    let idle = builder.keys.iter().filter(is_idle);
    let error = |key: &Key| {
        let message = format!(
            "the key `{}` has no action and takes part in no chord, remove it",
            key.face.name
        );
        let error = builder.error(builder.key_source(key), message);
        (error, key.face.target)
    };
    let errors: Vec<_> = idle.take(MAX_IDLE).map(error).collect();
    for (idle_error, target) in errors {
        builder.report(idle_error, &[target]);
    }
}
