//! The result of a run, for figures, heat map and bars.

use super::run::LabRequest;
use ademan_core::layout::{Heat, Layout};
use ademan_lab::measures::{Comparison, PersonScore, Summary};
use ademan_lab::people::Participant;
use ademan_lab::report::heats;

/// One layout with what the people did on it.
#[derive(Clone, Debug)]
pub struct Scored {
    /// The name of the file.
    pub name: String,
    /// The text.
    pub text: String,
    /// The layout, for hands of average size.
    pub layout: Layout,
    /// The figures of each person.
    pub scores: Vec<PersonScore>,
    /// The figures of all people.
    pub summary: Summary,
}

/// The result of a run.
#[derive(Clone, Debug)]
pub struct LabOutcome {
    /// The layout and the people that were scored.
    pub request: LabRequest,
    /// The people.
    pub participants: Vec<Participant>,
    /// The layout of the editor.
    pub own: Scored,
    /// The layout that it is compared with.
    pub other: Option<Scored>,
    /// The layout of the editor minus the other one.
    pub comparison: Option<Comparison>,
}

/// A person in the list of the worst ones.
#[derive(Clone, Debug, PartialEq)]
pub struct PersonBar {
    /// The index of the person among the people of the run.
    pub index: usize,
    /// The number of the person.
    pub number: u32,
    /// The length of the hand, in millimetres.
    pub hand_mm: f64,
    /// The fingers, as a word.
    pub style: String,
    /// The failures: wrong characters, or tasks that were not done; 0..=1 and more.
    pub failure: f64,
    /// The readings of the person can be watched.
    pub can_be_watched: bool,
}

impl LabOutcome {
    /// Returns the people, the worst first.
    pub fn bars(&self) -> Vec<PersonBar> {
        let bar = |(index, score): (usize, &PersonScore)| {
            let (tries, done) = score.tasks.iter().fold((0, 0), |(tries, done), task| {
                (tries + task.tries, done + task.done)
            });
            PersonBar {
                index,
                number: score.number,
                hand_mm: score.hand_mm,
                style: score.style.clone(),
                failure: match score.characters {
                    0 => 1.0 - done as f64 / (tries.max(1)) as f64,
                    _ => score.cer(),
                },
                can_be_watched: score.characters > 0,
            }
        };
        let mut bars: Vec<PersonBar> = self.own.scores.iter().enumerate().map(bar).collect();
        bars.sort_by(|a, b| b.failure.total_cmp(&a.failure).then(a.index.cmp(&b.index)));
        bars
    }

    /// Returns the controls with the part of the strokes that did not press what was meant, or of the tasks that were not done.
    pub fn heats(&self) -> Vec<Heat> {
        heats(&self.own.layout, &self.own.scores)
    }

    /// Returns `true` if the run is of this text.
    pub fn is_of(&self, text: &str) -> bool {
        self.own.text == text
    }
}

#[cfg(test)]
mod tests {
    use super::super::LabRun;
    use super::super::run::tests::{finish, request};

    #[test]
    fn the_worst_person_is_first_and_every_letter_has_a_color() {
        let outcome = finish(&LabRun::start(request(None))).expect("a result");
        let bars = outcome.bars();
        assert_eq!(bars.len(), 3);
        assert!(bars.is_sorted_by(|a, b| a.failure >= b.failure));
        assert!(bars.iter().all(|bar| bar.can_be_watched));
        let heats = outcome.heats();
        assert!(heats.len() > 10 && heats.iter().any(|heat| heat.part > 0.0));
        let names = outcome.own.layout.target_names();
        let e = names.find("E").expect("a key");
        let heat = heats
            .iter()
            .find(|heat| heat.target == e)
            .expect("E is frequent");
        assert!(heat.words.starts_with("E: "), "{}", heat.words);
        assert!(outcome.is_of(&outcome.request.layout.text) && !outcome.is_of(""));
    }
}
