//! What the hand of the demo does: it types a text, or plays a script; and what came of it.

use std::io::{self, Write};

use ademan::contact::TargetNames;
use ademan::device::OutputEvent;
use ademan::layout::Layout;
use ademan::output::transcript::EventLine;
use ademan::sim::{PlaybackStats, TypingScore, UsTextField};
use ademan::snapshot::Snapshot;
use ademan::time::Timestamp;

/// The longest piece of a script that is shown in one line, in characters.
const EXCERPT: usize = 60;

/// What is to be done, and what came out so far.
pub enum Task {
    /// A text, as a receiver with a US keymap reads it.
    Type {
        text: String,
        field: UsTextField,
        first: Option<Timestamp>,
        last: Timestamp,
    },
    /// A script, and every event.
    Play {
        script: String,
        names: TargetNames,
        events: Vec<OutputEvent>,
    },
}

impl Task {
    pub fn type_text(text: String) -> Self {
        Self::Type {
            text,
            field: UsTextField::new(),
            first: None,
            last: Timestamp(0),
        }
    }

    pub fn play(script: &str, layout: &Layout) -> Self {
        let mut short: String = script.chars().take(EXCERPT).collect();
        if short.len() < script.len() {
            short.push('…');
        }
        Self::Play {
            script: short,
            names: layout.target_names(),
            events: Vec::new(),
        }
    }

    /// What the hand does, as part of a sentence.
    pub fn told(&self) -> String {
        match self {
            Self::Type { text, .. } => format!("types {text:?}"),
            Self::Play { script, .. } => format!("plays {script:?}"),
        }
    }

    /// What is wanted, in one line.
    pub fn wanted(&self) -> String {
        match self {
            Self::Type { text, .. } => format!("to type  {text:?}"),
            Self::Play { script, .. } => format!("to play  {script:?}"),
        }
    }

    /// Takes what went out in a frame.
    pub fn take(&mut self, frame: &Snapshot) {
        match self {
            Self::Type {
                field, first, last, ..
            } => {
                for event in &frame.events {
                    field.handle(event);
                    first.get_or_insert(event.time);
                    *last = event.time;
                }
            }
            Self::Play { events, .. } => events.extend(frame.events.iter().copied()),
        }
    }

    /// What came out so far, in one line.
    pub fn outcome(&self) -> String {
        match self {
            Self::Type { field, .. } => format!("typed    {:?}", field.text()),
            Self::Play { names, events, .. } => {
                let last = events
                    .last()
                    .map(|event| EventLine(event, names).to_string());
                format!("went out {}", last.unwrap_or_default().trim_start())
            }
        }
    }

    /// Whether that is what was wanted; a script wants nothing but to be played to its end.
    pub fn is_done(&self, played: &PlaybackStats) -> bool {
        match self {
            Self::Type { text, field, .. } => field.text() == text,
            Self::Play { .. } => !played.is_cancelled,
        }
    }

    /// Writes what came out; without the events of a script where they are written already.
    pub fn report(&self, out: &mut impl Write, is_written: bool) -> io::Result<()> {
        match self {
            Self::Type {
                text,
                field,
                first,
                last,
            } => {
                let first = first.unwrap_or_default();
                let score = TypingScore::new(text, field.text(), first, *last);
                writeln!(out, "typed      {:?}", score.typed)?;
                writeln!(
                    out,
                    "quality    {:.1} words/min (simulated), {:.2} % character error rate",
                    score.words_per_minute,
                    score.error_rate * 100.0
                )
            }
            Self::Play { names, events, .. } => {
                for event in events.iter().filter(|_| !is_written) {
                    writeln!(out, "{}", EventLine(event, names))?;
                }
                writeln!(out, "played     {} events went out", events.len())
            }
        }
    }
}
