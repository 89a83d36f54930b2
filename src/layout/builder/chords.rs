//! What keys do together, as written → checked.

use super::Checked;
use crate::contact::TargetId;
use crate::device::keyboard::{Activation, Chord, MAX_CHORD_KEYS};
use crate::document::DocumentError;
use crate::hand::FINGERS_OF_BOTH_HANDS;
use crate::layout::schema;
use crate::layout::text::Spanned;

/// The most chords of a layout: a press looks at each.
const MOST_CHORDS: usize = 512;

impl<'a> Checked<'a> {
    pub(super) fn add_chord(&mut self, written: &schema::Chord<'a>) -> Result<(), DocumentError> {
        let word = written.keys.0;
        let document = self.document;
        let refuse = |place: &str, message: String| Err(document.error_at(place, message));
        let mut keys: Vec<TargetId> = Vec::new();
        for name in word.split_whitespace() {
            let key = &self.keys[self.place_of(Spanned(name))?];
            if let Activation::Dwell(_) = key.fires {
                return refuse(
                    name,
                    format!("the key `{name}` fires by dwelling, so it cannot take part in chords"),
                );
            }
            if keys.contains(&key.face.target) {
                return refuse(
                    name,
                    format!("the key `{name}` is in the chord for the second time"),
                );
            }
            keys.push(key.face.target);
        }
        if !(2..=FINGERS_OF_BOTH_HANDS).contains(&keys.len()) {
            let message = format!(
                "a chord has 2 to {FINGERS_OF_BOTH_HANDS} keys, this one has {}",
                keys.len()
            );
            return refuse(word, message);
        }
        keys.sort_unstable();
        if self.chords.iter().any(|chord| chord.keys == keys) {
            return refuse(word, "these keys are a chord already".to_owned());
        }
        if self.chords.len() == MOST_CHORDS {
            return refuse(word, format!("a layout has at most {MOST_CHORDS} chords"));
        }
        let action = self.action(written.does, written.latch)?;
        self.chords.push(Chord { keys, action });
        let mut of_chords: Vec<&TargetId> =
            self.chords.iter().flat_map(|chord| &chord.keys).collect();
        of_chords.sort_unstable();
        of_chords.dedup();
        if of_chords.len() > MAX_CHORD_KEYS {
            return refuse(
                word,
                format!("at most {MAX_CHORD_KEYS} keys of a layout can take part in chords"),
            );
        }
        Ok(())
    }

    /// Refuses keys that can do nothing at all.
    pub(super) fn refuse_idle_keys(&self) -> Result<(), DocumentError> {
        for key in &self.keys {
            let target = key.face.target;
            let is_idle = key.actions.iter().all(Option::is_none)
                && !self.chords.iter().any(|chord| chord.keys.contains(&target));
            if is_idle {
                let name = key.face.name.as_str();
                let word = self.names.get(name).map_or(self.name.0, |(_, word)| *word);
                let message = format!(
                    "the key `{name}` does nothing and takes part in no chord, leave it out"
                );
                return Err(self.document.error_at(word, message));
            }
        }
        Ok(())
    }
}
