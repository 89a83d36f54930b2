//! The tasks of a trial while a session runs.

use ademan::contact::TargetId;
use ademan::device::{EventKind, KeyCode, OutputEvent};
use ademan::study::Trial;
use ademan::time::Timestamp;

use crate::practice::{PointingTask, PracticeLine, PracticeTask};

/// The time for which a value stays before it counts as set, in seconds.
const SET: f64 = 1.5;

/// The task of a trial.
pub enum StudyTask {
    /// A phrase, and the keys that went down for it.
    Phrase {
        line: Box<PracticeLine>,
        keystrokes: usize,
        backspaces: usize,
    },
    /// A ring of targets.
    Targets(Box<PointingTask>),
    /// A value to set.
    Value(ValueTask),
}

/// A control that is moved to a value.
pub struct ValueTask {
    target: TargetId,
    name: String,
    goal: f64,
    value: Option<f64>,
    /// The times of the first and of the last change.
    span: Option<(Timestamp, Timestamp)>,
    is_set: bool,
}

impl StudyTask {
    /// Creates the task of a phrase.
    pub fn phrase(text: &str) -> Self {
        Self::Phrase {
            line: Box::new(PracticeLine::new(text)),
            keystrokes: 0,
            backspaces: 0,
        }
    }

    /// Creates the task of a value.
    pub fn value(target: TargetId, name: &str, goal: f64) -> Self {
        Self::Value(ValueTask {
            target,
            name: name.to_owned(),
            goal,
            value: None,
            span: None,
            is_set: false,
        })
    }

    /// Writes the figures into a trial.
    pub fn measure(&self, trial: &mut Trial) {
        match self {
            Self::Phrase {
                line,
                keystrokes,
                backspaces,
            } => {
                trial.seconds = line.seconds();
                trial.set_typing(&line.score(true));
                trial.keystrokes = Some(*keystrokes);
                trial.backspaces = Some(*backspaces);
                trial.deleted = Some(line.deletions());
            }
            Self::Targets(task) => {
                let result = task.result();
                trial.seconds = result.movement_s * result.targets as f64;
                trial.pointing = Some(result);
            }
            Self::Value(task) => {
                let span = task.span.map(|(first, last)| last.since(first));
                trial.seconds = span.unwrap_or_default().as_secs_f64();
                trial.value = task.value.map(|value| [task.goal, value]);
            }
        }
    }
}

impl PracticeTask for StudyTask {
    fn handle(&mut self, event: &OutputEvent) -> bool {
        match self {
            Self::Phrase {
                line,
                keystrokes,
                backspaces,
            } => {
                if event.kind.is_press() && !line.is_complete() {
                    *keystrokes += 1;
                    *backspaces +=
                        usize::from(event.kind == EventKind::KeyDown(KeyCode::BACKSPACE));
                }
                line.handle(event)
            }
            Self::Targets(task) => task.handle(event),
            Self::Value(task) => task.handle(event),
        }
    }

    fn tick(&mut self, now: Timestamp) -> bool {
        match self {
            Self::Value(task) => task.tick(now),
            Self::Phrase { .. } | Self::Targets(_) => false,
        }
    }

    fn is_complete(&self) -> bool {
        match self {
            Self::Phrase { line, .. } => line.is_complete(),
            Self::Targets(task) => task.is_complete(),
            Self::Value(task) => task.is_set,
        }
    }

    fn lines(&self) -> Vec<String> {
        match self {
            Self::Phrase { line, .. } => line.lines(),
            Self::Targets(task) => task.lines(),
            Self::Value(task) => task.lines(),
        }
    }
}

impl ValueTask {
    fn handle(&mut self, event: &OutputEvent) -> bool {
        let EventKind::Value(target, value) = event.kind else {
            return false;
        };
        if target != self.target {
            return false;
        }
        self.value = Some(value.into());
        let first = self.span.map_or(event.time, |(first, _)| first);
        self.span = Some((first, event.time));
        true
    }

    fn tick(&mut self, now: Timestamp) -> bool {
        let rested = self.span.map(|(_, last)| now.since(last).as_secs_f64());
        self.is_set |= rested.is_some_and(|rested| rested >= SET);
        self.is_set
    }

    fn lines(&self) -> Vec<String> {
        let value = self.value.map_or("-".to_owned(), |it| format!("{it:.2}"));
        vec![
            format!("set `{}` to {:.2}", self.name, self.goal),
            format!("now {value}; leave it for a moment to end"),
        ]
    }
}
