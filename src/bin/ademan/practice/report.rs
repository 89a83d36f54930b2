//! The result of one practice.

use std::io::{self, IsTerminal, Write};
use std::time::SystemTime;

use ademan::layout::Layout;
use ademan::message::escape;
use ademan::sim::TypingScore;
use serde_json::json;

use super::heat;
use super::history::{Progress, SessionResult, rounded};
use super::lesson::{ChordLegend, Lesson};
use super::line::{CharacterScore, PracticeLine, errors, names, shown};
use crate::failure::Failure;
use crate::messages;

/// Characters of the list of the worst ones.
const MAX_WORST: usize = 5;

/// The result of one practice.
pub struct Report {
    lesson: &'static str,
    layout: Layout,
    score: TypingScore,
    seconds: f64,
    characters: Vec<CharacterScore>,
    /// The fingers of each character of a lesson of chords; otherwise empty.
    chords: ChordLegend,
    finds_letters: bool,
    /// `true` if the whole text was typed.
    pub is_complete: bool,
    is_simulated: bool,
    /// The latest results, this one included; `None` if it is not kept.
    pub progress: Option<Progress>,
}

impl Report {
    pub fn new(
        lesson: &Lesson,
        layout: Layout,
        line: &PracticeLine,
        is_complete: bool,
        is_simulated: bool,
    ) -> Self {
        let score = line.score(is_complete);
        Self {
            lesson: lesson.name,
            layout,
            seconds: line.seconds(),
            characters: line.characters(&score.presented),
            chords: if lesson.rates_chords {
                lesson.fingers.clone()
            } else {
                ChordLegend::new()
            },
            finds_letters: lesson.finds_letters,
            score,
            is_complete,
            is_simulated,
            progress: None,
        }
    }

    /// Returns the result for the history.
    pub fn session(&self) -> SessionResult {
        let edits = self.score.edits;
        SessionResult {
            time: now(),
            lesson: self.lesson.to_owned(),
            layout: self.layout.name.clone(),
            is_simulated: self.is_simulated,
            characters: self.score.presented.chars().count(),
            seconds: rounded(self.seconds, 10.0),
            words_per_minute: rounded(self.score.words_per_minute, 10.0),
            error_rate: rounded(self.score.error_rate, 1e4),
            substitutions: edits.substitutions,
            insertions: edits.insertions,
            deletions: edits.deletions,
            pointing: None,
            chords: self
                .chord_scores()
                .map(|it| (it.character, [it.correct(), it.attempts]))
                .collect(),
        }
    }

    /// Returns the scores of the chords of a lesson of chords, in the order of the text.
    fn chord_scores(&self) -> impl Iterator<Item = &CharacterScore> {
        let mut found: Vec<&CharacterScore> = Vec::new();
        for character in self.score.presented.chars() {
            let is_chord = character != ' ' && self.chords.contains_key(&character);
            let is_new = found.iter().all(|score| score.character != character);
            let score = self.characters.iter().find(|it| it.character == character);
            found.extend(score.filter(|_| is_chord && is_new));
        }
        found.into_iter()
    }

    /// Prints the result as text or as JSON.
    pub fn print(&self, is_json: bool) -> Result<(), Failure> {
        let mut out = io::stdout().lock();
        if is_json {
            writeln!(out, "{}", self.json())?
        } else {
            self.write(&mut out)?
        }
        Ok(())
    }

    /// Returns the characters with errors, the worst first.
    fn worst(&self) -> impl Iterator<Item = &CharacterScore> {
        let with_errors = self.characters.iter().filter(|score| score.errors > 0);
        with_errors.take(MAX_WORST)
    }

    fn json(&self) -> serde_json::Value {
        let session = self.session();
        let worst = self.worst().map(|score| {
            json!({
                "character": score.character,
                "attempts": score.attempts,
                "errors": score.errors,
            })
        });
        let chords = self.chord_scores().map(|score| {
            json!({
                "character": score.character,
                "fingers": self.chords.get(&score.character).map(|it| names(it)),
                "attempts": score.attempts,
                "errors": score.errors,
            })
        });
        json!({
            "lesson": session.lesson,
            "layout": session.layout,
            "text": self.score.presented,
            "typed": self.score.typed,
            "is_complete": self.is_complete,
            "is_simulated": session.is_simulated,
            "seconds": session.seconds,
            "words_per_minute": session.words_per_minute,
            "error_rate": session.error_rate,
            "substitutions": session.substitutions,
            "insertions": session.insertions,
            "deletions": session.deletions,
            "worst": worst.collect::<Vec<_>>(),
            "chords": chords.collect::<Vec<_>>(),
        })
    }

    fn write(&self, out: &mut impl Write) -> io::Result<()> {
        let score = &self.score;
        let is_simulated = if self.is_simulated {
            " (a simulated hand)"
        } else {
            ""
        };
        let columns = messages::output_columns().unwrap_or_default();
        let row = |name: &str, words: &str| messages::row(name, words, columns);
        writeln!(out, "text       {}", escape(&score.presented))?;
        writeln!(out, "typed      {}", escape(&score.typed))?;
        let speed = format!(
            "{:.1} words/min of correct text in {:.1} s{is_simulated}",
            score.words_per_minute, self.seconds
        );
        writeln!(out, "{}", row("speed      ", &speed))?;
        let quality = errors(score.error_rate, score.edits);
        writeln!(out, "{}", row("quality    ", &quality))?;
        let worst: Vec<String> = self.worst().map(in_words).collect();
        if worst.is_empty() {
            writeln!(out, "worst keys none")?
        } else {
            writeln!(out, "{}", row("worst keys ", &worst.join(", ")))?
        }
        let chords: Vec<String> = self
            .chord_scores()
            .map(CharacterScore::correct_of)
            .collect();
        if !chords.is_empty() {
            let chords = format!("{} (correct of all)", chords.join(", "));
            writeln!(out, "{}", row("chords     ", &chords))?;
        }
        if io::stdout().is_terminal() && !worst.is_empty() {
            let drawing = heat::draw(&self.layout, &self.characters, self.finds_letters);
            out.write_all(drawing.as_bytes())?;
        }
        match &self.progress {
            Some(progress) => write!(out, "{progress}"),
            None if !self.is_complete => {
                writeln!(out, "kept       no: the text was not completed")
            }
            None => Ok(()),
        }
    }
}

/// Returns the time of a result, in UTC.
pub fn now() -> String {
    humantime::format_rfc3339_seconds(SystemTime::now()).to_string()
}

fn in_words(score: &CharacterScore) -> String {
    let name = shown(score.character);
    format!("{name} {} of {}", score.errors, score.attempts)
}
