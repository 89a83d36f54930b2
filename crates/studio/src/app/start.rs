//! The program in a window after a change of its setup, and after the pages of the first start.

use std::mem;

use eframe::egui;

use super::StudioApp;
use crate::first_start::{Answers, FirstStart};
use crate::panels;
use crate::setup_change::SetupChange;
use crate::texts::text;
use ademan_core::command::Command;

/// The session that is to be started.
#[derive(Clone, Copy, Debug)]
pub enum SessionRequest<'a> {
    /// A session with the answers of the first start.
    First(&'a Answers),
    /// A session with a changed setup in place of the present one, and whether it starts paused, as the present one is.
    Change(&'a SetupChange, bool),
    /// The session that was asked for before, which has not started.
    Wait,
    /// A session on the setup before in place of one that has not started.
    Cancel,
}

/// The program for a session, or the reason why there is none. `None` while the session has not started.
type Opened = Result<Option<StudioApp>, String>;

/// Starts a session, and may wait for it as long as a frame may take.
type OpenSession<'a> = Box<dyn FnMut(SessionRequest) -> Opened + 'a>;

/// The program in a window, or the pages of the first start before it.
pub struct StudioStart<'a> {
    first: Option<FirstStart>,
    app: Option<StudioApp>,
    open: Option<OpenSession<'a>>,
    /// The session of the program has ended, and the next one has not started.
    is_waiting: bool,
    /// The next session is to be paused once it has started.
    is_pause_wanted: bool,
    /// Reason why the settings were not written before the next session.
    unsaved: Option<String>,
}

impl<'a> StudioStart<'a> {
    /// Shows the pages of the first start, and then the program that `open` returns for the answers, and for changes of the setup.
    pub fn first(
        first: FirstStart,
        open: impl FnMut(SessionRequest) -> Result<Option<StudioApp>, String> + 'a,
    ) -> Self {
        Self::new(Some(first), None, Some(Box::new(open)))
    }

    /// Shows a program, and then those that `open` returns for changes of the setup.
    pub fn with_changes(
        mut app: StudioApp,
        open: impl FnMut(SessionRequest) -> Result<Option<StudioApp>, String> + 'a,
    ) -> Self {
        app.can_open = true;
        Self::new(None, Some(app), Some(Box::new(open)))
    }

    fn new(
        first: Option<FirstStart>,
        app: Option<StudioApp>,
        open: Option<OpenSession<'a>>,
    ) -> Self {
        Self {
            first,
            app,
            open,
            is_waiting: false,
            is_pause_wanted: false,
            unsaved: None,
        }
    }

    /// Returns the program once its session has started.
    pub fn app(&mut self) -> Option<&mut StudioApp> {
        self.app.as_mut()
    }

    /// Draws one frame.
    pub fn show(&mut self, ui: &mut egui::Ui) {
        if let Some(app) = &mut self.app {
            // The key of a pause: the program takes it, and its session has ended.
            self.is_pause_wanted |=
                self.is_waiting && ui.input(|input| input.key_pressed(egui::Key::P));
            app.show(ui);
            if self.is_waiting {
                self.wait(ui);
            } else {
                self.change_setup();
            }
            return;
        }
        let (Some(first), Some(open)) = (&mut self.first, &mut self.open) else {
            return;
        };
        first.update();
        let Some(answers) = panels::show_first_start(ui, first) else {
            return;
        };
        match open(SessionRequest::First(&answers)) {
            Ok(None) => {}
            Ok(Some(mut app)) => {
                if answers.is_calibrated {
                    app.panels.show_calibration();
                }
                app.can_open = true;
                self.app = Some(app);
                self.first = None;
            }
            Err(reason) => first.error = Some(reason),
        }
    }

    /// Replaces the program by one with the change that was chosen, if any. Without it the present one stays.
    fn change_setup(&mut self) {
        let (Some(app), Some(open)) = (&mut self.app, &mut self.open) else {
            return;
        };
        let Some(change) = app.panels.take_setup(&app.sensors) else {
            return;
        };
        // The next program reads them.
        let kept = app.kept_settings();
        let saved = app.settings_file.save(&kept);
        let is_paused = app.model.view.state.paused_by.is_some();
        let opened = open(SessionRequest::Change(&change, is_paused));
        self.unsaved = saved.err().map(|error| error.to_string());
        self.adopt(opened);
    }

    /// Shows that the next session has not started, and a button that leads back to the setup before.
    fn wait(&mut self, ui: &egui::Ui) {
        let Some(open) = &mut self.open else {
            return;
        };
        let request = if is_cancelled(ui) {
            SessionRequest::Cancel
        } else {
            SessionRequest::Wait
        };
        let opened = open(request);
        self.adopt(opened);
    }

    /// Replaces the program by the one for the next session, if that has started.
    fn adopt(&mut self, opened: Opened) {
        self.is_waiting = matches!(opened, Ok(None));
        let Some(app) = &mut self.app else {
            return;
        };
        // The next frame comes soon.
        app.has_changed = true;
        match opened {
            Ok(None) => {}
            Ok(Some(mut other)) => {
                other.can_open = true;
                other.sensors.keep_glove(&mut app.sensors);
                other.sensors.keep_smoothing(&app.sensors);
                other.panels.keep_choices(&mut app.panels);
                other.panels.message = self.unsaved.take().or(other.panels.message);
                if mem::take(&mut self.is_pause_wanted) {
                    other.send(Command::Pause);
                }
                self.app = Some(other);
            }
            Err(reason) => {
                self.is_pause_wanted = false;
                app.panels.refuse(reason);
            }
        }
    }
}

/// Shows that a session has not started. Returns `true` if the person cancels it.
fn is_cancelled(ui: &egui::Ui) -> bool {
    let modal = egui::Modal::new(egui::Id::unique("session-waiting"));
    let shown = modal.show(ui.ctx(), |content| {
        content.strong(text("devices-waiting"));
        content.label(text("devices-waiting-words"));
        content.add_space(8.0);
        content.button(text("editor-cancel")).clicked()
    });
    shown.inner || ui.input(|input| input.key_pressed(egui::Key::Escape))
}

impl From<StudioApp> for StudioStart<'_> {
    fn from(app: StudioApp) -> Self {
        Self::new(None, Some(app), None)
    }
}
