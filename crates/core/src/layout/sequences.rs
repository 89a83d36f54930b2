//! Sequences: keys, texts and waits that one press starts.

use std::time::Duration;

use serde::Deserialize;

use super::builder::LayoutBuilder;
use super::quantity::{SequenceWait, duration};
use crate::device::key_arbiter::{MAX_SEQUENCE_KEYS, TIME_PER_CHARACTER};
use crate::device::{Sequence, SequenceStep};
use crate::document::{DocumentError, Spanned, schema};

/// The maximum number of sequences of a layout.
const MAX_SEQUENCES: usize = 256;

/// The maximum number of steps of a sequence.
const MAX_STEPS: usize = 32;

/// The maximum number of characters that a sequence types.
const MAX_CHARACTERS: usize = 256;

/// The maximum duration of a sequence at [`TIME_PER_PRESS`].
const MAX_DURATION: Duration = Duration::from_secs(10);

/// The time of a press of a sequence with the rate limit of a network source. Sources on this machine are faster.
const TIME_PER_PRESS: Duration = Duration::from_millis(100);

schema! {
    /// A step of a sequence.
    #[derive(Clone, Copy, Debug, Deserialize)]
    #[serde(rename = "Step")]
    pub(super) enum StepSchema<'a> {
        /// Presses 1 to 4 keys or buttons in this order, and releases them all: `Tap("ControlLeft C")`.
        #[serde(borrow)]
        Tap(Spanned<'a>),
        /// Types a text of 1 to 32 characters, whatever the receiver's keymap is.
        Text(Spanned<'a>),
        /// Waits for 1 to 5000 ms, beside the time that each press takes.
        Wait(SequenceWait),
    }
}

/// The characters and the time of the steps of a sequence so far.
#[derive(Default)]
struct Totals {
    characters: usize,
    time: Duration,
}

/// Adds the sequence with this name. It is declared in any case, so that the actions that name it have no errors of their own.
pub(super) fn build_sequence<'a>(
    builder: &mut LayoutBuilder<'a>,
    name: Spanned<'a>,
    steps: &[StepSchema<'a>],
) -> Result<(), DocumentError> {
    if builder.sequence_id(name.text).is_some() {
        let message = format!("duplicate sequence `{}`", name.text);
        return Err(builder.error(name.text, message));
    }
    if builder.sequences.len() == MAX_SEQUENCES {
        let message = format!("a layout has at most {MAX_SEQUENCES} sequences");
        return Err(builder.error(name.text, message));
    }
    let built = compile(builder, name, steps);
    builder.sequences.push(Sequence {
        name: name.text.to_owned(),
        steps: built.as_ref().map_or(Vec::new(), Vec::clone),
    });
    built.map(drop)
}

/// Checks the steps and returns what the sequence does in each reading.
fn compile<'a>(
    builder: &mut LayoutBuilder<'a>,
    name: Spanned<'a>,
    steps: &[StepSchema<'a>],
) -> Result<Vec<SequenceStep>, DocumentError> {
    if !(1..=MAX_STEPS).contains(&steps.len()) {
        let message = format!(
            "a sequence has 1 to {MAX_STEPS} steps, `{}` has {}",
            name.text,
            steps.len()
        );
        return Err(builder.error(name.text, message));
    }
    let mut compiled = Vec::new();
    let mut totals = Totals::default();
    for step in steps {
        match *step {
            StepSchema::Tap(keys) => add_tap(builder, keys, &mut compiled, &mut totals)?,
            StepSchema::Text(text) => {
                compiled.push(SequenceStep::Text(builder.text_id(text)?));
                let characters = text.text.chars().count();
                totals.characters += characters;
                totals.time += TIME_PER_PRESS.max(TIME_PER_CHARACTER * characters as u32);
            }
            StepSchema::Wait(wait) => {
                let wait = duration(wait.get());
                compiled.push(SequenceStep::Wait(wait));
                totals.time += wait;
            }
        }
    }
    if totals.characters > MAX_CHARACTERS {
        let message = format!(
            "a sequence types at most {MAX_CHARACTERS} characters, `{}` types {}",
            name.text, totals.characters
        );
        return Err(builder.error(name.text, message));
    }
    if totals.time > MAX_DURATION {
        let message = format!(
            "a sequence takes at most {} s, with {} ms for each press; `{}` takes {:.1} s: shorten its waits",
            MAX_DURATION.as_secs(),
            TIME_PER_PRESS.as_millis(),
            name.text,
            totals.time.as_secs_f64()
        );
        return Err(builder.error(name.text, message));
    }
    Ok(compiled)
}

/// Adds the presses of a tap, and their release.
fn add_tap<'a>(
    builder: &LayoutBuilder<'a>,
    keys: Spanned<'a>,
    compiled: &mut Vec<SequenceStep>,
    totals: &mut Totals,
) -> Result<(), DocumentError> {
    let first = compiled.len();
    for code in keys.text.split_whitespace() {
        let press = SequenceStep::Press(builder.key_code(Spanned { text: code })?);
        if compiled[first..].contains(&press) {
            return Err(builder.error(code, format!("duplicate key `{code}` in the tap")));
        }
        if compiled.len() - first == MAX_SEQUENCE_KEYS {
            let message = format!("a tap has at most {MAX_SEQUENCE_KEYS} keys");
            return Err(builder.error(keys.text, message));
        }
        compiled.push(press);
        totals.time += TIME_PER_PRESS;
    }
    compiled.push(SequenceStep::Release);
    totals.time += TIME_PER_PRESS;
    Ok(())
}
