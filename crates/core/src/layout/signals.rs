//! Signals: what controls send to music and stage programs.

use serde::Deserialize;

use super::builder::LayoutBuilder;
use super::quantity::{MidiChannel, MidiController, MidiNote, OscNumber};
use crate::device::signals::{MidiKind, Signal};
use crate::document::{DocumentError, Spanned, schema};

/// The maximum length of an OSC address, in characters.
const MAX_ADDRESS_LENGTH: usize = 100;

/// The characters that an OSC address cannot have, because receivers take them for patterns.
const PATTERN_CHARACTERS: &[char] = &[' ', '#', '*', ',', '?', '[', ']', '{', '}'];

schema! {
    /// The messages of a control to music and stage programs, through the outputs `osc` and `midi`.
    #[derive(Clone, Copy, Debug, Deserialize)]
    #[serde(rename = "Signal", deny_unknown_fields)]
    pub(super) struct SignalSchema<'a> {
        /// Address of its OSC messages, at most 100 characters: `"/mixer/1"`.
        #[serde(borrow, default)]
        osc: Option<Spanned<'a>>,
        /// Numbers of its OSC messages for the values 0 and 1. Default: `(0, 1)`.
        #[serde(default)]
        range: Option<(OscNumber, OscNumber)>,
        /// MIDI note that a key plays; 60 is middle C.
        #[serde(default)]
        note: Option<MidiNote>,
        /// MIDI controller that follows the value, or the depth of a key; 7 is the volume.
        #[serde(default)]
        control: Option<MidiController>,
        /// MIDI channel; 10 has the drums.
        #[serde(default)]
        channel: MidiChannel,
    }
}

impl<'a> SignalSchema<'a> {
    /// Adds the signal of the target with this name.
    pub fn build(
        &self,
        builder: &mut LayoutBuilder<'a>,
        name: Spanned<'a>,
    ) -> Result<(), DocumentError> {
        let (target, kind) = builder.target(name.text)?;
        let error = |message: String| Err(builder.error(name.text, message));
        if let [x, .., y] = builder.values_of(target) {
            return error(format!(
                "the {kind} `{}` has several values, set a signal for `{}` or `{}`",
                name.text, x.name, y.name
            ));
        }
        if let Some(address) = self.osc
            && let Err(message) = check_address(address.text)
        {
            return Err(builder.error(address.text, message));
        }
        let midi = match (self.note, self.control) {
            (None, None) if self.osc.is_none() => {
                return error(format!(
                    "the signal of `{}` sends nothing, set `osc`, `note` or `control`",
                    name.text
                ));
            }
            (None, None) => None,
            (Some(_), Some(_)) => {
                return error(format!(
                    "the signal of `{}` has both a `note` and a `control`",
                    name.text
                ));
            }
            (Some(_), None) if !matches!(kind, "key" | "target") => {
                return error(format!(
                    "a {kind} plays no note, set a `control` for `{}`",
                    name.text
                ));
            }
            (Some(note), None) => Some((note.get(), MidiKind::Note as fn(u8) -> _)),
            (None, Some(control)) => Some((control.get(), MidiKind::Control as fn(u8) -> _)),
        };
        let (low, high) = self
            .range
            .map_or((0.0, 1.0), |(low, high)| (low.get(), high.get()));
        let signal = Signal {
            address: self.osc.map(|address| address.text.to_owned()),
            range: (low as f32, high as f32),
            channel: self.channel.get() as u8 - 1,
            midi: midi.map(|(number, message)| message(number as u8)),
        };
        builder.add_signal(name, target, signal)
    }
}

/// Checks an OSC address: parts of printable ASCII characters, each after a slash.
fn check_address(address: &str) -> Result<(), String> {
    let is_valid = |part: &str| {
        let is_plain = |character: char| {
            (' '..='~').contains(&character) && !PATTERN_CHARACTERS.contains(&character)
        };
        !part.is_empty() && part.chars().all(is_plain)
    };
    let parts = address.strip_prefix('/');
    if parts.is_some_and(|parts| parts.split('/').all(is_valid))
        && address.len() <= MAX_ADDRESS_LENGTH
    {
        Ok(())
    } else {
        Err(format!(
            "an OSC address is a path such as `/mixer/1`, of at most {MAX_ADDRESS_LENGTH} letters, digits and signs other \
         than `# * , ? [ ] {{ }}` and blanks"
        ))
    }
}
