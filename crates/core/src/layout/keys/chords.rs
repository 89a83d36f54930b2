//! Chords: actions of keys that are pressed together.

use serde::Deserialize;

use crate::contact::TargetId;
use crate::device::keyboard::{Activation, Chord, MAX_CHORD_KEYS};
use crate::document::{DocumentError, Spanned, schema};
use crate::hand::FINGERS_OF_BOTH_HANDS;
use crate::layout::builder::LayoutBuilder;
use crate::layout::schema::{Action, LatchSchema};

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
        /// Action, in every layer.
        #[serde(borrow)]
        action: Action<'a>,
        /// Duration of a modifier or layer. Default: `Momentary`.
        #[serde(default)]
        latch: Option<LatchSchema>,
    }
}

impl<'a> ChordSchema<'a> {
    /// Adds the chord.
    pub fn build(&self, builder: &mut LayoutBuilder<'a>) -> Result<(), DocumentError> {
        let names = self.keys.text;
        let mut keys = self.targets(builder)?;
        if !(2..=FINGERS_OF_BOTH_HANDS).contains(&keys.len()) {
            let message = format!(
                "a chord has 2 to {FINGERS_OF_BOTH_HANDS} keys, this one has {}",
                keys.len()
            );
            return Err(builder.error(names, message));
        }
        keys.sort_unstable();
        if builder.chords().iter().any(|chord| chord.keys == keys) {
            return Err(builder.error(names, "duplicate chord"));
        }
        if builder.chords().len() == MAX_CHORDS {
            let message = format!("a layout has at most {MAX_CHORDS} chords");
            return Err(builder.error(names, message));
        }
        let action = builder.action(self.action, self.latch)?;
        builder.add_chord(Chord { keys, action });
        if chord_keys(builder) > MAX_CHORD_KEYS {
            let message =
                format!("at most {MAX_CHORD_KEYS} keys of a layout can take part in chords");
            return Err(builder.error(names, message));
        }
        Ok(())
    }

    /// Returns the targets of the keys. Rejects duplicates and keys that activate by dwelling.
    fn targets(&self, builder: &LayoutBuilder<'a>) -> Result<Vec<TargetId>, DocumentError> {
        let mut keys: Vec<TargetId> = Vec::new();
        for name in self.keys.text.split_whitespace() {
            let key = &builder.keys()[builder.key_index(name)?];
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
        Ok(keys)
    }
}

/// Returns the number of keys that take part in chords.
fn chord_keys(builder: &LayoutBuilder) -> usize {
    let chords = builder.chords().iter();
    let mut keys: Vec<&TargetId> = chords.flat_map(|chord| &chord.keys).collect();
    keys.sort_unstable();
    keys.dedup();
    keys.len()
}

/// Rejects keys that have no action in any layer and take part in no chord.
pub(in crate::layout) fn reject_idle_keys(builder: &LayoutBuilder) -> Result<(), DocumentError> {
    for key in builder.keys() {
        let target = key.face.target;
        let is_idle = key.actions.iter().all(Option::is_none)
            && !builder
                .chords()
                .iter()
                .any(|chord| chord.keys.contains(&target));
        if is_idle {
            let message = format!(
                "the key `{}` has no action and takes part in no chord, remove it",
                key.face.name
            );
            return Err(builder.error(builder.key_source(key), message));
        }
    }
    Ok(())
}
