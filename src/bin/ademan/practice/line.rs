//! The practice line: the text to type, what is typed of it, and the scores so far.

use std::collections::BTreeMap;

use ademan::device::OutputEvent;
use ademan::hand::Finger;
use ademan::message::escape;
use ademan::session::counted;
use ademan::sim::{EditCounts, TypingScore, UsTextField, kept_characters, words_per_minute};
use ademan::time::Timestamp;

use super::PracticeTask;
use super::lesson::ChordLegend;

/// Columns of typed text that stay in view beside what follows.
const COLUMNS_BEFORE: usize = 30;

/// Chords whose progress is in view.
const CHORDS_SHOWN: usize = 9;

/// Columns of the text in view.
const COLUMNS: usize = 68;

/// The text to type and what is typed of it.
pub struct PracticeLine {
    text: Vec<char>,
    field: UsTextField,
    first: Option<Timestamp>,
    last: Timestamp,
    /// Characters that were deleted again, by the character that belongs in their place.
    corrected: BTreeMap<char, usize>,
    /// Characters that were deleted again.
    deletions: usize,
    /// The fingers of each character, if some are chords.
    fingers: ChordLegend,
    /// `true` in a lesson of chords, which shows the progress of each.
    rates_chords: bool,
    /// `true` if a text decoder finds the letters of multitap keys from one tap each.
    finds_letters: bool,
}

/// The times at which a character was to be typed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CharacterScore {
    pub character: char,
    /// Times at which it was typed or left out.
    pub attempts: usize,
    /// Times at which another one was typed or it was left out.
    pub errors: usize,
}

impl CharacterScore {
    /// Returns the number of attempts without an error.
    pub fn correct(&self) -> usize {
        self.attempts.saturating_sub(self.errors)
    }

    /// Returns the character with its correct and all attempts.
    pub fn correct_of(&self) -> String {
        let name = shown(self.character);
        format!("{name} {}/{}", self.correct(), self.attempts)
    }

    /// Returns the fraction of errors, 0..=1.
    pub fn error_rate(&self) -> f64 {
        self.errors as f64 / self.attempts.max(1) as f64
    }
}

impl PracticeLine {
    pub fn new(text: &str) -> Self {
        Self {
            text: text.chars().collect(),
            field: UsTextField::new(),
            first: None,
            last: Timestamp(0),
            corrected: BTreeMap::new(),
            deletions: 0,
            fingers: ChordLegend::new(),
            rates_chords: false,
            finds_letters: false,
        }
    }

    /// Shows the fingers of the next character, unless none are known.
    pub fn with_fingers(self, fingers: ChordLegend) -> Self {
        Self { fingers, ..self }
    }

    /// Shows the progress of each chord too.
    pub fn with_rated_chords(self, rates_chords: bool) -> Self {
        Self {
            rates_chords,
            ..self
        }
    }

    /// Counts no deleted letter as an error if a text decoder finds the letters: it changes them until the word ends.
    pub fn with_found_letters(self, finds_letters: bool) -> Self {
        Self {
            finds_letters,
            ..self
        }
    }

    /// Adds an event. Those after the end of the text change nothing.
    fn add(&mut self, event: &OutputEvent) {
        let before: Vec<char> = self.field.text().chars().collect();
        self.field.handle(event);
        let length = self.typed_length();
        if length == before.len() {
            return;
        }
        self.first.get_or_insert(event.time);
        self.last = event.time;
        self.deletions += before.len().saturating_sub(length);
        let deleted = before.get(length).filter(|_| length < before.len());
        let wanted = self.text.get(length).copied();
        if let (Some(deleted), Some(wanted)) = (deleted, wanted)
            && *deleted != wanted
            && !self.finds_letters
        {
            *self.corrected.entry(wanted).or_default() += 1;
        }
    }

    fn typed_length(&self) -> usize {
        self.field.text().chars().count()
    }

    /// Returns the part of the text that has been reached.
    fn reached(&self) -> String {
        self.text.iter().take(self.typed_length()).collect()
    }

    /// Returns the score of the part that has been reached, or of the whole text.
    pub fn score(&self, is_whole: bool) -> TypingScore {
        let presented: String = if is_whole {
            self.text.iter().collect()
        } else {
            self.reached()
        };
        let first = self.first.unwrap_or_default();
        TypingScore::new(&presented, self.field.text(), first, self.last)
    }

    /// Returns the seconds from the first to the last character.
    pub fn seconds(&self) -> f64 {
        self.last
            .since(self.first.unwrap_or_default())
            .as_secs_f64()
    }

    /// Returns the number of characters that were deleted again.
    pub fn deletions(&self) -> usize {
        self.deletions
    }

    /// Returns each character of the presented text with its errors, the worst first.
    pub fn characters(&self, presented: &str) -> Vec<CharacterScore> {
        let kept = kept_characters(presented, self.field.text());
        let mut counts: BTreeMap<char, (usize, usize)> = BTreeMap::new();
        for (character, is_kept) in presented.chars().zip(kept) {
            let (attempts, errors) = counts.entry(character).or_default();
            *attempts += 1;
            *errors += usize::from(!is_kept);
        }
        for (character, corrected) in &self.corrected {
            if let Some((attempts, errors)) = counts.get_mut(character) {
                *attempts += corrected;
                *errors += corrected;
            }
        }
        let scores = counts
            .into_iter()
            .map(|(character, (attempts, errors))| CharacterScore {
                character,
                attempts,
                errors,
            });
        let mut scores: Vec<CharacterScore> = scores.collect();
        scores.sort_by(|one, other| {
            let by_rate = other.error_rate().total_cmp(&one.error_rate());
            by_rate.then(other.errors.cmp(&one.errors))
        });
        scores
    }

    /// Returns the fingers to bend for the next character.
    fn hold_line(&self, typed: usize) -> String {
        let wanted = self.text.get(typed);
        match wanted.map(|it| (it, self.fingers.get(it))) {
            Some((next, Some(fingers))) => {
                format!("hold     {} for {}", names(fingers), shown(*next))
            }
            Some((next, None)) => format!("hold     several chords for {}", shown(*next)),
            None => "hold     nothing more".to_owned(),
        }
    }

    /// Returns the correct and all attempts of the latest chords.
    fn progress_line(&self, typed: usize) -> String {
        let mut latest: Vec<char> = Vec::new();
        for &character in self.text.iter().take(typed).rev() {
            if !latest.contains(&character) && character != ' ' {
                latest.push(character);
            }
        }
        latest.truncate(CHORDS_SHOWN);
        let scores = self.characters(&self.reached());
        let progress = latest.iter().rev().filter_map(|character| {
            let score = scores.iter().find(|score| score.character == *character)?;
            Some(score.correct_of())
        });
        let progress: Vec<String> = progress.collect();
        format!("chords   {}", progress.join("  "))
    }
}

impl PracticeTask for PracticeLine {
    fn handle(&mut self, event: &OutputEvent) -> bool {
        if self.is_complete() {
            return false;
        }
        self.add(event);
        true
    }

    /// Returns `true` if as many characters are typed as the text has.
    fn is_complete(&self) -> bool {
        self.typed_length() >= self.text.len()
    }

    /// Returns the lines of the view: the text, what is typed of it below, and the scores so far.
    fn lines(&self) -> Vec<String> {
        let typed: Vec<char> = self.field.text().chars().collect();
        let start = typed.len().saturating_sub(COLUMNS_BEFORE);
        let window = |text: &[char]| -> String {
            let text: String = text.iter().skip(start).take(COLUMNS).collect();
            // A space at the end, or a wrong one, is seen too.
            escape(&text.replace(' ', "·").replace(['\n', '\t'], "↵")).into_owned()
        };
        let edits = EditCounts::new(&self.reached(), self.field.text());
        let speed = words_per_minute(edits.correct, self.seconds());
        let rate = edits.errors() as f64 / typed.len().max(1) as f64;
        let mut lines = vec![
            format!("to type  {}", window(&self.text)),
            format!("typed    {}", window(&typed)),
            format!(
                "{} of {} · {speed:.1} words/min · {}",
                typed.len(),
                counted(self.text.len() as u64, "character"),
                errors(rate, edits)
            ),
        ];
        if !self.fingers.is_empty() {
            lines.push(self.hold_line(typed.len()));
        }
        if self.rates_chords {
            lines.push(self.progress_line(typed.len()));
        }
        lines
    }
}

/// Returns the names of fingers.
pub fn names(fingers: &[Finger]) -> String {
    let names: Vec<String> = fingers.iter().map(Finger::to_string).collect();
    names.join(" + ")
}

/// Returns a character as it is written in a list.
pub fn shown(character: char) -> String {
    match character {
        ' ' => "space".to_owned(),
        character => escape(&character.to_string()).into_owned(),
    }
}

/// Returns the error rate and its kinds in words.
pub fn errors(rate: f64, edits: EditCounts) -> String {
    format!(
        "{:.1} % errors: {}, {}, {}",
        rate * 100.0,
        counted(edits.substitutions as u64, "substitution"),
        counted(edits.insertions as u64, "insertion"),
        counted(edits.deletions as u64, "deletion")
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use ademan::device::{EventKind, KeyCode};

    fn typed(text: &str, keys: &[&str]) -> PracticeLine {
        let mut line = PracticeLine::new(text);
        type_keys(&mut line, keys);
        line
    }

    /// Types names of keys, one each second.
    fn type_keys(line: &mut PracticeLine, keys: &[&str]) {
        for (second, name) in keys.iter().enumerate() {
            let key: KeyCode = name.parse().unwrap();
            for kind in [EventKind::KeyDown(key), EventKind::KeyUp(key)] {
                let time = Timestamp(second as u64 * 1_000_000);
                line.handle(&OutputEvent { time, kind });
            }
        }
    }

    fn worst(line: &PracticeLine, presented: &str) -> Vec<(char, usize, usize)> {
        let scores = line.characters(presented).into_iter();
        let with_errors = scores.filter(|score| score.errors > 0);
        with_errors
            .map(|score| (score.character, score.errors, score.attempts))
            .collect()
    }

    #[test]
    fn the_line_ends_with_as_many_characters_as_the_text_has() {
        let line = typed("hola", &["H", "O", "K"]);
        assert!(!line.is_complete());
        let mut wrong_end = typed("hola", &["H", "O", "K", "A", "Z"]);
        assert!(wrong_end.is_complete());
        wrong_end.handle(&OutputEvent {
            time: Timestamp(9_000_000),
            kind: EventKind::KeyDown(KeyCode::BACKSPACE),
        });
        let score = wrong_end.score(true);
        assert_eq!(score.typed, "hoka");
        assert_eq!(score.error_rate, 0.25);
        // Three correct characters, of which the first starts the clock: 2 in 3 s.
        assert!((score.words_per_minute - 8.0).abs() < 1e-9, "{score:?}");
        assert_eq!(worst(&wrong_end, "hola"), [('l', 1, 1)]);
    }

    #[test]
    fn a_corrected_error_counts_for_its_key_and_not_for_the_text() {
        let line = typed("hola", &["H", "P", "Backspace", "O", "L", "A"]);
        assert_eq!(line.score(true).error_rate, 0.0);
        assert_eq!(worst(&line, "hola"), [('o', 1, 2)]);
        // A correct character that is deleted is not an error.
        let retyped = typed("hola", &["H", "O", "Backspace", "O", "L", "A"]);
        assert_eq!(worst(&retyped, "hola"), []);
    }

    #[test]
    fn a_letter_that_a_decoder_changes_is_no_error() {
        let mut line = PracticeLine::new("he").with_found_letters(true);
        type_keys(&mut line, &["I", "Backspace", "H", "E"]);
        assert_eq!(line.score(true).error_rate, 0.0);
        assert_eq!(worst(&line, "he"), []);
        let mut wrong = PracticeLine::new("he").with_found_letters(true);
        type_keys(&mut wrong, &["I", "E"]);
        assert_eq!(worst(&wrong, "he"), [('h', 1, 1)]);
    }

    #[test]
    fn what_was_not_reached_is_no_error_until_the_end() {
        let line = typed("hola que tal", &["H", "O"]);
        assert_eq!(line.score(false).error_rate, 0.0);
        assert!(line.score(true).error_rate > 0.8);
        let lines = line.lines();
        assert_eq!(lines[0], "to type  hola·que·tal");
        assert_eq!(lines[1], "typed    ho");
        assert!(lines[2].starts_with("2 of 12 characters · "), "{lines:?}");
        assert!(lines[2].contains("0.0 % errors"), "{lines:?}");
    }

    #[test]
    fn the_fingers_of_the_next_character_are_shown() {
        let fingers: ChordLegend = [('h', vec![Finger::Middle, Finger::Ring])].into();
        let mut line = PracticeLine::new("hH").with_fingers(fingers);
        assert_eq!(line.lines()[3..], ["hold     middle + ring for h"]);
        type_keys(&mut line, &["H"]);
        assert_eq!(line.lines()[3..], ["hold     several chords for H"]);
        let mut rated = PracticeLine::new("h").with_rated_chords(true);
        type_keys(&mut rated, &["H"]);
        assert_eq!(rated.lines()[3..], ["chords   h 1/1"]);
    }

    #[test]
    fn a_long_text_moves_under_what_is_typed() {
        let text = "abcdefghij".repeat(10);
        let keys = ["A", "B", "C", "D", "E", "F", "G", "H", "I", "J"].repeat(5);
        let lines = typed(&text, &keys).lines();
        // The last 30 of 50 characters, and below them the same columns.
        assert_eq!(lines[1], format!("typed    {}", "abcdefghij".repeat(3)));
        assert!(lines[0].starts_with("to type  abcdefghij"), "{lines:?}");
        assert_eq!(lines[0].len(), "to type  ".len() + COLUMNS);
    }
}
