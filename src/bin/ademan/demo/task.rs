//! The task of the simulated hand, a text or a script, and its result.

use std::io::{self, Write};

use ademan::contact::TargetNames;
use ademan::device::{EventKind, OutputEvent};
use ademan::layout::Layout;
use ademan::output::transcript::EventLine;
use ademan::session::counted;
use ademan::sim::{PlaybackStats, TypingScore, UsTextField};
use ademan::snapshot::Snapshot;
use ademan::time::Timestamp;

use crate::messages;

/// Longest excerpt of a script in one line, in characters.
const MAX_EXCERPT: usize = 60;

/// Events of a repeated script that are kept.
const MAX_EVENTS: usize = 1000;

/// A task and its result so far.
pub enum Task {
    /// Types a text, which a text field with a US keymap receives.
    Type {
        text: String,
        field: Box<UsTextField>,
        first: Option<Timestamp>,
        last: Timestamp,
        /// The noise of the sensors and its seed, on which the quality depends.
        conditions: String,
        is_repeated: bool,
    },
    /// Plays a script and collects all events.
    Play {
        script: String,
        names: TargetNames,
        events: Vec<OutputEvent>,
        is_repeated: bool,
    },
}

impl Task {
    pub fn type_text(text: String, conditions: String) -> Self {
        Self::Type {
            text,
            field: Box::default(),
            first: None,
            last: Timestamp(0),
            conditions,
            is_repeated: false,
        }
    }

    pub fn play(script: &str, layout: &Layout) -> Self {
        let mut short: String = script.chars().take(MAX_EXCERPT).collect();
        if short.len() < script.len() {
            short.push('…');
        }
        Self::Play {
            script: short,
            names: layout.target_names(),
            events: Vec::new(),
            is_repeated: false,
        }
    }

    /// Becomes a task that starts again at its end: only the last result is kept.
    pub fn repeated(mut self, repeats: bool) -> Self {
        let (Self::Type { is_repeated, .. } | Self::Play { is_repeated, .. }) = &mut self;
        *is_repeated = repeats;
        self
    }

    /// Returns the predicate of a sentence about the hand.
    pub fn description(&self) -> String {
        match self {
            Self::Type { text, .. } => format!("types {text:?}"),
            Self::Play { script, .. } => format!("plays {script:?}"),
        }
    }

    /// Returns the goal in one line.
    pub fn goal(&self) -> String {
        match self {
            Self::Type { text, .. } => format!("to type  {text:?}"),
            Self::Play { script, .. } => format!("to play  {script:?}"),
        }
    }

    /// Adds the events of a step.
    pub fn update(&mut self, snapshot: &Snapshot) {
        match self {
            Self::Type {
                text,
                field,
                first,
                last,
                is_repeated,
                ..
            } => {
                for event in &snapshot.events {
                    if *is_repeated
                        && field.text().len() >= text.len()
                        && field.pressed().is_empty()
                    {
                        (**field, *first) = (UsTextField::new(), None);
                    }
                    field.handle(event);
                    first.get_or_insert(event.time);
                    *last = event.time;
                }
            }
            Self::Play {
                events,
                is_repeated,
                ..
            } => {
                if *is_repeated && events.len() > MAX_EVENTS {
                    events.drain(..MAX_EVENTS / 2);
                }
                events.extend(snapshot.events.iter().copied());
            }
        }
    }

    /// Returns the result so far in one line.
    pub fn result(&self) -> String {
        match self {
            Self::Type { field, .. } => format!("typed    {:?}", field.text()),
            Self::Play { names, events, .. } => {
                let last = events
                    .last()
                    .map(|event| EventLine(event, names).to_string());
                format!("sent     {}", last.unwrap_or_default().trim_start())
            }
        }
    }

    /// Returns `true` if the text is complete and correct, or the script was played to its end.
    pub fn is_done(&self, playback: &PlaybackStats) -> bool {
        match self {
            Self::Type { text, field, .. } => field.text() == text,
            Self::Play { .. } => !playback.is_cancelled,
        }
    }

    /// Writes the result. The quality of a text is left out if the hand did not come to its end, and the events of a
    /// script if a transcript has printed them.
    pub fn report(
        &self,
        out: &mut impl Write,
        playback: &PlaybackStats,
        is_printed: bool,
    ) -> io::Result<()> {
        match self {
            Self::Type {
                text,
                field,
                first,
                last,
                conditions,
                ..
            } => {
                let first = first.unwrap_or_default();
                let score = TypingScore::new(text, field.text(), first, *last);
                writeln!(out, "typed      {:?}", score.typed)?;
                if playback.is_cancelled {
                    return Ok(());
                }
                let edits = score.edits;
                let quality = format!(
                    "{:.1} words/min of correct text (simulated), {:.2} % character error rate",
                    score.words_per_minute,
                    score.error_rate * 100.0
                );
                write_row(out, "quality    ", &quality)?;
                writeln!(
                    out,
                    "errors     {}, {}, {}",
                    counted(edits.substitutions as u64, "substitution"),
                    counted(edits.insertions as u64, "insertion"),
                    counted(edits.deletions as u64, "deletion")
                )?;
                write_row(out, "rests on   ", &format!("1 run with {conditions}"))
            }
            Self::Play { names, events, .. } => {
                for event in merge(events).iter().filter(|_| !is_printed) {
                    writeln!(out, "{}", EventLine(event, names))?;
                }
                writeln!(out, "played     {} events sent", events.len())
            }
        }
    }
}

/// Writes a row of the result. In a terminal that is narrower, its words go on below their beginning.
pub fn write_row(out: &mut impl Write, first: &str, words: &str) -> io::Result<()> {
    let columns = messages::output_columns().unwrap_or_default();
    writeln!(out, "{}", messages::row(first, words, columns))
}

/// Merges each run of motions, scrolls, values or positions of one control: hundreds of them hide the other events.
fn merge(events: &[OutputEvent]) -> Vec<OutputEvent> {
    let mut merged: Vec<OutputEvent> = Vec::new();
    for event in events {
        let last = merged.last_mut();
        match last.and_then(|last| Some((merge_kinds(last.kind, event.kind)?, last))) {
            Some((kind, last)) => {
                *last = OutputEvent {
                    kind,
                    time: event.time,
                };
            }
            None => merged.push(*event),
        }
    }
    merged
}

/// Returns one event for two in a row, if they have the same subject.
fn merge_kinds(first: EventKind, second: EventKind) -> Option<EventKind> {
    use EventKind::{Axis, Depth, MoveBy, MoveTo, Scroll, Value};
    match (first, second) {
        (MoveBy(x, y), MoveBy(right, down)) => Some(MoveBy(x + right, y + down)),
        (Scroll(x, y), Scroll(right, up)) => Some(Scroll(x + right, y + up)),
        (MoveTo(..), MoveTo(..)) => Some(second),
        (Axis(axis, _), Axis(other, _)) if axis == other => Some(second),
        (Value(target, _), Value(other, _)) | (Depth(target, _), Depth(other, _))
            if target == other =>
        {
            Some(second)
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use ademan::device::Axis;

    use super::*;

    #[test]
    fn runs_of_one_control_are_merged_and_keep_their_order() {
        let event = |time, kind| OutputEvent {
            time: Timestamp(time),
            kind,
        };
        let events = [
            event(1, EventKind::MoveBy(1, 0)),
            event(2, EventKind::MoveBy(2, -1)),
            event(3, EventKind::Axis(Axis::LeftX, 0.5)),
            event(4, EventKind::Axis(Axis::LeftX, 1.0)),
            event(5, EventKind::Axis(Axis::LeftY, 0.1)),
            event(6, EventKind::MoveBy(1, 1)),
        ];
        let merged = [
            event(2, EventKind::MoveBy(3, -1)),
            event(4, EventKind::Axis(Axis::LeftX, 1.0)),
            event(5, EventKind::Axis(Axis::LeftY, 0.1)),
            event(6, EventKind::MoveBy(1, 1)),
        ];
        assert_eq!(merge(&events), merged);
    }
}
