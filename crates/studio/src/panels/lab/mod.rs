//! The lab: simulated people use the layout of the editor. Conditions, figures, a heat map over the keys, and the worst people.

mod controls;
mod heat;
mod people;
mod results;
mod watch;

use std::path::Path;
use std::sync::Arc;

use eframe::egui;

use super::editor::EditorPanel;
use super::{PanelContext, PanelState, Workspace};
use crate::lab::{LabOutcome, LabRequest, LabRun, LabSettings, PersonBar, WatchedPerson};
use crate::playback::{Job, Player, Recording};
use crate::texts::text;
use ademan_core::document::Document;
use ademan_core::layout::Heat;

pub(super) use self::watch::show as show_watched;

/// The layout that the one of the editor is compared with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Other {
    #[default]
    Nothing,
    /// The text of the editor as it was saved last.
    Saved,
    /// A layout that comes with the program, or a file.
    File,
}

/// The lab between two frames.
#[derive(Default)]
pub struct LabState {
    settings: LabSettings,
    other: Other,
    other_name: String,
    run: Option<LabRun>,
    /// The last result, with what is drawn of it.
    shown: Option<Shown>,
    /// The reason why the last run or the last watching failed.
    error: Option<String>,
    watching: Option<Job<Watched>>,
}

/// A person with the recording, or the reason why there is none.
type Watched = Result<(WatchedPerson, Recording), String>;

/// A result, and what follows from it.
struct Shown {
    outcome: Arc<LabOutcome>,
    heats: Vec<Heat>,
    bars: Vec<PersonBar>,
}

/// A change of who is watched.
pub enum WatchChange {
    /// A person is watched in place of the session.
    Start(Box<(WatchedPerson, Player)>),
    /// The session is shown again.
    End,
}

impl LabState {
    /// Returns `true` if a thread is at work.
    pub fn is_busy(&self) -> bool {
        self.run.is_some() || self.watching.is_some()
    }

    /// Receives results. Does not wait.
    fn receive(&mut self, watch: &mut Option<WatchChange>) {
        if let Some(result) = self.run.as_ref().and_then(LabRun::poll) {
            self.run = None;
            match result {
                Ok(outcome) => {
                    self.shown = Some(Shown {
                        heats: outcome.heats(),
                        bars: outcome.bars(),
                        outcome: Arc::new(outcome),
                    });
                }
                // A run that was cancelled has no reason.
                Err(reason) => self.error = Some(reason).filter(|it| !it.is_empty()),
            }
        }
        if let Some(result) = self.watching.as_ref().and_then(Job::poll) {
            self.watching = None;
            let outcome = result.unwrap_or_else(|lost| Err(lost.to_string()));
            let opened = outcome.and_then(|(person, recording)| {
                let player = Player::open(recording).map_err(|error| error.to_string())?;
                Ok(Box::new((person, player)))
            });
            match opened {
                Ok(watched) => *watch = Some(WatchChange::Start(watched)),
                Err(reason) => self.error = Some(reason),
            }
        }
    }

    /// Starts a run of the layout of the editor.
    fn start(&mut self, editor: &EditorPanel) {
        let editor = &editor.editor;
        let other = match self.other {
            Other::Nothing => Ok(None),
            Other::Saved => {
                let name = format!("{} ({})", editor.name(), text("lab-saved"));
                Ok(Some(Document::new(name, editor.saved_text())))
            }
            Other::File => LabRequest::open_other(self.other_name.trim()).map(Some),
        };
        match other {
            Ok(other) => {
                self.error = None;
                self.run = Some(LabRun::start(LabRequest {
                    settings: self.settings.clone(),
                    layout: Document {
                        path: editor.path().map(Path::to_owned),
                        ..Document::new(editor.name(), editor.text())
                    },
                    other,
                }));
            }
            Err(reason) => self.error = Some(reason),
        }
    }

    /// Starts the replay of a person of the last result.
    fn watch(&mut self, index: usize) {
        let Some((request, people, score)) = self
            .shown
            .as_ref()
            .and_then(|it| it.outcome.to_watch(index))
        else {
            return;
        };
        self.error = None;
        self.watching = Some(Job::start(move || {
            crate::lab::watch(&request, &people, (index, &score))
        }));
    }
}

/// Receives what the threads of the lab have done, whatever is shown.
pub(super) fn advance(state: &mut PanelState, context: &mut PanelContext) {
    state.lab.receive(context.watch);
    if let Some(WatchChange::Start(_)) = context.watch {
        state.workspace = Workspace::Hand;
        state.next_viewpoint = Some(crate::camera::Viewpoint::Eye);
    }
}

/// Draws the conditions of a run.
pub(super) fn show_controls(ui: &mut egui::Ui, state: &mut PanelState) {
    let Some(Ok(editor)) = &state.editor else {
        return;
    };
    let area = egui::ScrollArea::vertical().auto_shrink(false);
    area.show(ui, |ui| controls::show(ui, &mut state.lab, editor));
}

/// Draws the figures of the last run, and the people of it.
pub(super) fn show_results(ui: &mut egui::Ui, state: &mut PanelState) {
    let Some(Ok(editor)) = &state.editor else {
        return;
    };
    let area = egui::ScrollArea::vertical().auto_shrink(false);
    area.show(ui, |ui| {
        results::show(ui, &state.lab, editor);
        if let Some(index) = people::show(ui, &state.lab) {
            state.lab.watch(index);
        }
    });
}

/// Draws the keys with what was tapped there.
pub(super) fn show_board(ui: &mut egui::Ui, state: &mut PanelState, context: &mut PanelContext) {
    if let Some(Ok(editor)) = &mut state.editor {
        heat::show(ui, &state.lab, editor, context);
    }
}
