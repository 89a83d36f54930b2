//! The program in a window after a change of its setup, and after the pages of the first start.

use eframe::egui;

use super::StudioApp;
use crate::first_start::{Answers, FirstStart};
use crate::panels;
use crate::setup_change::SetupChange;

/// The session that is to be started.
#[derive(Clone, Copy, Debug)]
pub enum SessionRequest<'a> {
    /// A session with the answers of the first start.
    First(&'a Answers),
    /// A session with a changed setup in place of the present one, and whether it starts paused, as the present one is.
    Change(&'a SetupChange, bool),
}

/// Starts a session and returns the program for it, or the reason why there is none.
type OpenSession<'a> = Box<dyn FnMut(SessionRequest) -> Result<StudioApp, String> + 'a>;

/// The program in a window, or the pages of the first start before it.
pub struct StudioStart<'a> {
    first: Option<FirstStart>,
    app: Option<StudioApp>,
    open: Option<OpenSession<'a>>,
}

impl<'a> StudioStart<'a> {
    /// Shows the pages of the first start, and then the program that `open` returns for the answers, and for changes of the setup.
    pub fn first(
        first: FirstStart,
        open: impl FnMut(SessionRequest) -> Result<StudioApp, String> + 'a,
    ) -> Self {
        Self {
            first: Some(first),
            app: None,
            open: Some(Box::new(open)),
        }
    }

    /// Shows a program, and then those that `open` returns for changes of the setup.
    pub fn with_changes(
        mut app: StudioApp,
        open: impl FnMut(SessionRequest) -> Result<StudioApp, String> + 'a,
    ) -> Self {
        app.can_open = true;
        Self {
            first: None,
            app: Some(app),
            open: Some(Box::new(open)),
        }
    }

    /// Returns the program once its session has started.
    pub fn app(&mut self) -> Option<&mut StudioApp> {
        self.app.as_mut()
    }

    /// Draws one picture.
    pub fn show(&mut self, ui: &mut egui::Ui) {
        if let Some(app) = &mut self.app {
            app.show(ui);
            self.change_setup();
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
            Ok(mut app) => {
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
        match (saved.map_err(|error| error.to_string()), opened) {
            (saved, Ok(mut other)) => {
                other.can_open = true;
                other.sensors.keep_glove(&mut app.sensors);
                other.panels.keep_devices(&mut app.panels);
                other.panels.message = saved.err().or(other.panels.message);
                self.app = Some(other);
            }
            (_, Err(reason)) => app.panels.refuse(reason),
        }
    }
}

impl From<StudioApp> for StudioStart<'_> {
    fn from(app: StudioApp) -> Self {
        Self {
            first: None,
            app: Some(app),
            open: None,
        }
    }
}
