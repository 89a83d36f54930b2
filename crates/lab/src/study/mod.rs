//! A small study with real people: the tasks, the trials, and the same measures as for simulated people.
//!
//! The order of the layouts differs from participant to participant (a cyclic Latin square), so that practice and fatigue do not favor
//! one layout.

mod page;
mod report;
mod trial;

use serde::{Deserialize, Serialize};

pub use page::{study_curves, study_to_html};
pub use report::{LayoutFigures, figures, trials_to_csv};
pub use trial::{Trial, TrialKind};

use crate::layout::{ControlKind, Handle, Layout};
use crate::measures::ReadError;
use crate::message::{escape, escape_line};
use crate::people::Draw;
use crate::phrases::Corpus;
use crate::trials::{Station, TrialError};

/// The name of the format.
const FORMAT: &str = "ademan-lab-study";
/// The version of the format.
const VERSION: u32 = 1;
/// The longest pseudonym, in characters.
const MAX_PSEUDONYM: usize = 32;

/// A study: layouts, and the tasks on each of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Study {
    /// The name of the format.
    format: String,
    /// The version of the format.
    format_version: u32,
    /// The version of the program.
    program_version: String,
    /// The seed of the phrases and values.
    pub seed: u64,
    /// The layouts.
    pub layouts: Vec<StudyLayout>,
}

/// A layout of a study.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StudyLayout {
    /// The name in tables: the file as its user named it.
    pub name: String,
    /// The text of the file.
    pub text: String,
    /// The tasks, in their order.
    pub tasks: Vec<Task>,
}

/// The task of a participant in a trial.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Task {
    /// Types a phrase.
    Phrase(String),
    /// Clicks on the targets of a ring.
    Targets,
    /// Moves a slider or knob to a value.
    Value {
        /// The name of the control.
        control: String,
        /// The value, as a part of the range or in turns from the start.
        goal: f64,
    },
}

/// Reason why a study or a name cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// The file is damaged, or no file of a study.
    #[error("it cannot be read: {}", escape_line(.0))]
    Unreadable(String),
    /// Another version wrote the file.
    #[error(transparent)]
    Other(#[from] ReadError),
    /// A layout cannot be used.
    #[error(transparent)]
    Layout(#[from] TrialError),
    /// A layout has nothing to do for a participant.
    #[error(
        "{} types no phrase, moves no cursor and has no slider or knob, so that there is nothing to measure",
        escape(.0)
    )]
    NoTask(String),
    /// A name may identify somebody, or cannot be part of a file name.
    #[error(
        "`{}` is not a pseudonym: use 1 to {MAX_PSEUDONYM} letters, digits, `-` and `_`, such as P01, and not the name of a person",
        escape(.0)
    )]
    NoPseudonym(String),
}

/// The tasks that a study has of each kind.
#[derive(Clone, Copy, Debug)]
pub struct Counts {
    /// Phrases on each layout that types.
    pub phrases: usize,
    /// Rings on each layout with a pointer.
    pub rings: usize,
    /// Values of each slider and knob.
    pub values: usize,
}

impl Study {
    /// Creates a study without layouts. `own` is the version of the program.
    pub fn new(seed: u64, own: &str) -> Self {
        Self {
            format: FORMAT.to_owned(),
            format_version: VERSION,
            program_version: own.to_owned(),
            seed,
            layouts: Vec::new(),
        }
    }

    /// Adds a layout with its tasks: phrases that it can type, or else rings and values. All layouts get the same phrases of a corpus that
    /// [`typable_by_all`] has returned. `station` is a person in front of the layout.
    pub fn add_layout(
        &mut self,
        name: &str,
        text: &str,
        station: &mut Station,
        corpus: &Corpus,
        counts: Counts,
    ) -> Result<(), StudyError> {
        let mut draw = Draw::new(self.seed, 0x57d1);
        let mut order: Vec<usize> = (0..corpus.phrases.len()).collect();
        for index in (1..order.len()).rev() {
            order.swap(index, draw.index(index + 1));
        }
        let phrases = order.iter().map(|&index| corpus.phrases[index].as_str());
        let strokes = station.strokes_for(corpus.phrases.iter().map(String::as_str));
        let mut tasks = Vec::new();
        if strokes.can_type() {
            let typable = phrases.map(|phrase| strokes.typable(phrase).trim().to_owned());
            let typable = typable.filter(|phrase| !phrase.is_empty());
            tasks.extend(typable.take(counts.phrases).map(Task::Phrase));
        } else {
            let has_cursor = station.layout().pointer.is_some();
            let rings = if has_cursor { counts.rings } else { 0 };
            tasks.extend(std::iter::repeat_n(Task::Targets, rings));
            add_values(station.layout(), counts.values, &mut draw, &mut tasks);
        }
        if tasks.is_empty() {
            return Err(StudyError::NoTask(name.to_owned()));
        }
        self.layouts.push(StudyLayout {
            name: name.to_owned(),
            text: text.to_owned(),
            tasks,
        });
        Ok(())
    }

    /// Returns the trials of a participant in their order: the indices of the layout and of its task. `participant` is the number of
    /// participants before.
    pub fn order(&self, participant: usize) -> Vec<(usize, usize)> {
        let count = self.layouts.len();
        let layouts = (0..count).map(|place| (place + participant) % count);
        let tasks = layouts.flat_map(|layout| {
            let tasks = 0..self.layouts[layout].tasks.len();
            tasks.map(move |task| (layout, task))
        });
        tasks.collect()
    }

    /// Returns the text of the file.
    pub fn to_json(&self) -> String {
        let text = serde_json::to_string_pretty(self);
        text.expect("the fields of a study have names") + "\n"
    }

    /// Reads the text of a file. A study may be continued with a newer version of the program; each trial names its version.
    pub fn from_json(text: &str) -> Result<Self, StudyError> {
        let unreadable = |error: serde_json::Error| StudyError::Unreadable(error.to_string());
        let value: serde_json::Value = serde_json::from_str(text).map_err(unreadable)?;
        if value["format"] != FORMAT {
            let error = format!("its format is not `{FORMAT}`");
            return Err(ReadError::NoResult(error).into());
        }
        if value["format_version"] != VERSION {
            let found = value["format_version"].as_u64().unwrap_or_default();
            let found = u32::try_from(found).unwrap_or(u32::MAX);
            return Err(ReadError::OtherFormat { found }.into());
        }
        let study: Self = serde_json::from_value(value).map_err(unreadable)?;
        match study.layouts.iter().find(|it| it.tasks.is_empty()) {
            Some(layout) => Err(StudyError::NoTask(layout.name.clone())),
            None if study.layouts.is_empty() => Err(StudyError::NoTask("the study".to_owned())),
            None => Ok(study),
        }
    }
}

fn add_values(layout: &Layout, count: usize, draw: &mut Draw, tasks: &mut Vec<Task>) {
    for control in &layout.controls {
        let range = match (&control.kind, control.kind.handle()) {
            (
                ControlKind::Knob(_),
                Handle::Turn {
                    is_endless: true, ..
                },
            ) => (-0.4, 0.4),
            (ControlKind::Slider(_) | ControlKind::Knob(_), _) => (0.05, 0.95),
            _ => continue,
        };
        let Some(face) = control.faces.first() else {
            continue;
        };
        for _ in 0..count {
            let goal = draw.between(range.0, range.1);
            tasks.push(Task::Value {
                control: face.name.clone(),
                goal: (goal * 100.0).round() / 100.0,
            });
        }
    }
}

/// Returns a corpus without the characters that one of the layouts that type cannot type, and these characters. Each station is a person in
/// front of a layout.
pub fn typable_by_all(stations: &mut [Station], corpus: &Corpus) -> (Corpus, Vec<char>) {
    let mut left_out: Vec<char> = Vec::new();
    for station in stations {
        let strokes = station.strokes_for(corpus.phrases.iter().map(String::as_str));
        if strokes.can_type() {
            left_out.extend(&strokes.untypable);
        }
    }
    left_out.sort_unstable();
    left_out.dedup();
    let is_kept = |character: &char| !left_out.contains(character);
    let phrases = corpus.phrases.iter();
    let phrases = phrases.map(|phrase| {
        let kept: String = phrase.chars().filter(is_kept).collect();
        // People do not see that two blanks are left around a word.
        kept.split_whitespace().collect::<Vec<_>>().join(" ")
    });
    let typable = Corpus {
        name: corpus.name.clone(),
        phrases: phrases.collect(),
    };
    (typable, left_out)
}

/// Checks that a name is a pseudonym.
pub fn check_pseudonym(name: &str) -> Result<(), StudyError> {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_');
    if (1..=MAX_PSEUDONYM).contains(&name.len()) && name.chars().all(is_plain) {
        Ok(())
    } else {
        Err(StudyError::NoPseudonym(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Document;
    use crate::people::{People, population};
    use crate::sim::fluent::SourceKind;

    #[test]
    fn a_word_that_is_left_out_leaves_one_blank() {
        let document = Document::shipped("webcam-qwerty").expect("a shipped layout");
        let person = population(&People::Drawn(1), None, 0).remove(0);
        let station = Station::new(&document, &person, SourceKind::Ideal).expect("a station");
        let corpus = Corpus::from_text("numbers", "go 5 up\n5 see - it").expect("phrases");
        let (typable, left_out) = typable_by_all(&mut [station], &corpus);
        assert_eq!(typable.phrases, ["go up", "see it"]);
        assert_eq!(left_out, ['-', '5']);
    }

    #[test]
    fn each_layout_is_first_for_one_of_as_many_participants() {
        let layout = |name: &str| StudyLayout {
            name: name.to_owned(),
            text: String::new(),
            tasks: vec![Task::Targets; 2],
        };
        let study = Study {
            layouts: ["a", "b", "c"].map(layout).into(),
            ..Study::new(1, "0")
        };
        let firsts: Vec<usize> = (0..3).map(|it| study.order(it)[0].0).collect();
        assert_eq!(firsts, [0, 1, 2]);
        assert_eq!(study.order(3), study.order(0));
        assert_eq!(study.order(1).len(), 6);
        let again = Study::from_json(&study.to_json()).expect("a study");
        assert_eq!(again, study);
    }

    #[test]
    fn names_that_are_no_file_names_are_no_pseudonyms() {
        assert!(check_pseudonym("P01").is_ok());
        for name in ["", "../x", "Ana María", "a.b", &"x".repeat(33)] {
            assert!(check_pseudonym(name).is_err(), "{name}");
        }
    }
}
