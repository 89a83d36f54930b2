//! The task of the simulated hand, a text or a script, and its result.

use std::io::{self, Write};

use ademan::contact::TargetNames;
use ademan::device::OutputEvent;
use ademan::layout::Layout;
use ademan::output::transcript::EventLine;
use ademan::sim::{PlaybackStats, TypingScore, UsTextField};
use ademan::snapshot::Snapshot;
use ademan::time::Timestamp;

/// Longest excerpt of a script in one line, in characters.
const MAX_EXCERPT: usize = 60;

/// A task and its result so far.
pub enum Task {
    /// Types a text, which a text field with a US keymap receives.
    Type {
        text: String,
        field: UsTextField,
        first: Option<Timestamp>,
        last: Timestamp,
    },
    /// Plays a script and collects all events.
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
        let mut short: String = script.chars().take(MAX_EXCERPT).collect();
        if short.len() < script.len() {
            short.push('…');
        }
        Self::Play {
            script: short,
            names: layout.target_names(),
            events: Vec::new(),
        }
    }

    /// The predicate of a sentence about the hand.
    pub fn description(&self) -> String {
        match self {
            Self::Type { text, .. } => format!("types {text:?}"),
            Self::Play { script, .. } => format!("plays {script:?}"),
        }
    }

    /// The goal in one line.
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
                field, first, last, ..
            } => {
                for event in &snapshot.events {
                    field.handle(event);
                    first.get_or_insert(event.time);
                    *last = event.time;
                }
            }
            Self::Play { events, .. } => events.extend(snapshot.events.iter().copied()),
        }
    }

    /// The result so far in one line.
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
            } => {
                let first = first.unwrap_or_default();
                let score = TypingScore::new(text, field.text(), first, *last);
                writeln!(out, "typed      {:?}", score.typed)?;
                if playback.is_cancelled {
                    return Ok(());
                }
                writeln!(
                    out,
                    "quality    {:.1} words/min (simulated), {:.2} % character error rate",
                    score.words_per_minute,
                    score.error_rate * 100.0
                )
            }
            Self::Play { names, events, .. } => {
                for event in events.iter().filter(|_| !is_printed) {
                    writeln!(out, "{}", EventLine(event, names))?;
                }
                writeln!(out, "played     {} events sent", events.len())
            }
        }
    }
}
