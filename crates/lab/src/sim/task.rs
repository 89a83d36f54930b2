//! Tasks of a simulated hand: a text, a script, or what suits the layout.

use super::action::HandAction;
use super::disturbance;
use super::script::Script;
use super::text_plan::actions_for_characters;
use super::tour::{tour, tour_text};
use crate::document::Document;
use crate::layout::Layout;
use crate::message::escape;

/// A task of a simulated hand, for any layout.
#[derive(Clone, Debug)]
pub enum HandTask {
    /// Types a text.
    Text {
        /// The text.
        text: String,
        /// `true` if a text decoder finds the letters of multitap keys: one tap for each.
        finds_letters: bool,
    },
    /// Plays a script.
    Script(Script),
    /// Does what the function returns for the active layout.
    Fitting(fn(&Layout) -> HandTask),
}

/// The part of a task that is done as a whole or not at all: a character of a text, a step of a script.
#[derive(Clone, Debug)]
pub(super) struct TaskStep {
    /// The actions; none if there is a problem.
    pub(super) actions: Vec<HandAction>,
    /// The reason why the layout does not permit it.
    pub(super) problem: Option<String>,
    /// The words, for messages.
    pub(super) name: String,
}

impl HandTask {
    /// Creates a task that types a text, of which no text decoder finds the letters.
    pub fn text(text: String) -> Self {
        Self::Text {
            text,
            finds_letters: false,
        }
    }

    /// Creates a tour of the controls of a layout.
    pub fn tour(layout: &Layout) -> Self {
        let text = tour_text(layout, &tour(layout));
        match Script::parse(Document::new("tour", text.as_str()), &layout.target_names()) {
            Ok(script) => Self::Script(script),
            // A tour is valid; without it the hand rests.
            Err(_) => Self::text(String::new()),
        }
    }

    /// Creates a task that plays a script on a layout, except what ends, pauses or resumes the session or changes the layout. Returns
    /// `None` if the script is for another layout.
    pub fn script(text: &str, layout: &Layout) -> Option<Self> {
        let script = Script::from_text(text, &layout.target_names()).ok()?;
        let disturbing = disturbance::targets(layout);
        let script = script.without(|target| disturbing.contains(&target))?;
        Some(Self::Script(script))
    }

    /// Returns the text or script for a layout.
    pub(super) fn resolve(&self, layout: &Layout) -> Self {
        match self {
            Self::Fitting(choose) => match choose(layout) {
                Self::Fitting(_) => Self::text(String::new()),
                chosen => chosen,
            },
            given => given.clone(),
        }
    }

    /// Returns `true` if two texts or scripts are the same.
    pub(super) fn is_same(&self, other: &Self) -> bool {
        match (self, other) {
            (
                Self::Text {
                    text,
                    finds_letters,
                },
                Self::Text {
                    text: other_text,
                    finds_letters: other_finds,
                },
            ) => text == other_text && finds_letters == other_finds,
            (Self::Script(script), Self::Script(other)) => script.text() == other.text(),
            _ => false,
        }
    }

    /// Returns the steps on a layout. A step has the same index on every layout.
    pub(super) fn steps(&self, layout: &Layout) -> Vec<TaskStep> {
        match self {
            Self::Text {
                text,
                finds_letters,
            } => text_steps(text, layout, *finds_letters),
            Self::Script(script) => script_steps(script, layout),
            Self::Fitting(_) => Vec::new(),
        }
    }
}

fn text_steps(text: &str, layout: &Layout, finds_letters: bool) -> Vec<TaskStep> {
    let planned = actions_for_characters(text, layout, finds_letters).into_iter();
    let steps = planned.map(|planned| TaskStep {
        // A message never contains what is typed.
        problem: planned
            .is_err()
            .then(|| "no key of the layout types it".to_owned()),
        actions: planned.unwrap_or_default(),
        name: "a character".to_owned(),
    });
    steps.collect()
}

fn script_steps(script: &Script, layout: &Layout) -> Vec<TaskStep> {
    let names = layout.target_names();
    let parsed = script.actions_for(&names);
    let step = |(name, action): (&str, Result<HandAction, String>)| {
        let (actions, problem) = match action {
            Ok(action) => (vec![action.placed(&layout.fit)], None),
            Err(problem) => (Vec::new(), Some(problem)),
        };
        TaskStep {
            actions,
            problem,
            name: format!("`{}`", escape(name)),
        }
    };
    parsed.map(step).collect()
}
