//! What keys do together, as written → checked.

use super::Checked;
use crate::contact::TargetId;
use crate::device::keyboard::{Chord, Fires, MOST_CHORD_KEYS};
use crate::hand::FINGERS;
use crate::layout::LayoutError;
use crate::layout::text::Word;
use crate::layout::written;

/// The most chords of a layout: a press looks at each.
const MOST_CHORDS: usize = 512;

impl<'a> Checked<'a> {
    pub(super) fn add_chord(&mut self, written: &written::Chord<'a>) -> Result<(), LayoutError> {
        let word = written.keys.0;
        let document = self.document;
        let refuse = |place: &str, message: String| Err(document.error(place, message));
        let mut keys: Vec<TargetId> = Vec::new();
        for name in word.split_whitespace() {
            let key = &self.keys[self.place_of(Word(name))?];
            if let Fires::Dwell(_) = key.fires {
                return refuse(
                    name,
                    format!("the key `{name}` fires by dwelling, so it cannot take part in chords"),
                );
            }
            if keys.contains(&key.front.target) {
                return refuse(
                    name,
                    format!("the key `{name}` is in the chord for the second time"),
                );
            }
            keys.push(key.front.target);
        }
        if !(2..=FINGERS).contains(&keys.len()) {
            let message = format!(
                "a chord has 2 to {FINGERS} keys, this one has {}",
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
        if of_chords.len() > MOST_CHORD_KEYS {
            return refuse(
                word,
                format!("at most {MOST_CHORD_KEYS} keys of a layout can take part in chords"),
            );
        }
        Ok(())
    }

    /// Refuses keys that can do nothing at all.
    pub(super) fn refuse_idle_keys(&self) -> Result<(), LayoutError> {
        for key in &self.keys {
            let target = key.front.target;
            let is_idle = key.actions.iter().all(Option::is_none)
                && !self.chords.iter().any(|chord| chord.keys.contains(&target));
            if is_idle {
                let name = key.front.name.as_str();
                let word = self.names.get(name).map_or(self.name.0, |(_, word)| *word);
                let message = format!(
                    "the key `{name}` does nothing and takes part in no chord, leave it out"
                );
                return Err(self.document.error(word, message));
            }
        }
        Ok(())
    }
}
