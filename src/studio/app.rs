//! The window: receives what the session shows, and lays out the panels.

use std::time::Duration;

use crossbeam_channel::{Receiver, TryRecvError};
use eframe::egui;

use super::model::StudioModel;
use super::panels::{self, PanelContext, PanelState};
use super::playback::Player;
use super::sensors::SensorTable;
use super::texts::text;
use crate::command::Command;
use crate::session::view::Viewer;
use crate::session::{CommandSender, SessionHandle};
use crate::snapshot::Snapshot;

/// Time between two pictures.
const PICTURE_PERIOD: Duration = Duration::from_millis(16);

/// Size of the window at the first start, in points.
const WINDOW_SIZE: [f32; 2] = [1280.0, 800.0];

/// Smallest size of the window, in points.
const MIN_WINDOW_SIZE: [f32; 2] = [640.0, 400.0];

/// Reason why there is no window.
#[derive(Debug, thiserror::Error)]
pub enum StudioError {
    /// The session ended before the window was opened.
    #[error("the session ended before the window was opened")]
    Ended,
    /// The desktop or the graphics driver refuses a window.
    #[error("cannot open a window: {0}; `ademan run --view board` shows the board in a terminal")]
    Window(String),
}

/// The program in the window.
pub struct StudioApp {
    model: StudioModel,
    snapshots: Receiver<Snapshot>,
    viewer: Viewer,
    commands: CommandSender,
    /// The recording that is shown in place of the session.
    player: Option<Player>,
    panels: PanelState,
}

impl StudioApp {
    /// Creates the program for a session, whose glove has these channels.
    pub fn new(session: &SessionHandle, sensors: SensorTable) -> Result<Self, StudioError> {
        let viewer = session.add_viewer();
        let view = viewer.views().recv().map_err(|_| StudioError::Ended)?;
        Ok(Self {
            model: StudioModel::new(view, sensors),
            snapshots: session.snapshots().clone(),
            viewer,
            commands: session.commands().clone(),
            player: None,
            panels: PanelState::default(),
        })
    }

    /// Prepares a window for the first picture.
    pub fn prepare(context: &egui::Context) {
        context.set_fonts(panels::fonts());
    }

    /// The state that the window shows.
    pub fn model(&self) -> &StudioModel {
        &self.model
    }

    /// Shows a recording in place of what the session sends.
    #[must_use]
    pub fn with_player(mut self, player: Player) -> Self {
        self.player = Some(player);
        self
    }

    /// Draws one picture.
    pub fn show(&mut self, ui: &mut egui::Ui) {
        match &mut self.player {
            Some(player) => {
                let elapsed = ui.input(|input| input.unstable_dt);
                player.advance(Duration::from_secs_f32(elapsed), &mut self.model);
            }
            None => self.receive(),
        }
        let mut sent = Vec::new();
        let mut moves = Vec::new();
        let mut context = PanelContext {
            model: &self.model,
            sent: &mut sent,
            player: self.player.as_ref(),
            moves: &mut moves,
        };
        panels::show(ui, &mut self.panels, &mut context);
        for command in sent {
            self.send(command);
        }
        if let Some(player) = &mut self.player {
            moves.into_iter().for_each(|change| player.apply(change));
        }
    }

    /// Receives what the session has sent since the last picture. Does not wait.
    fn receive(&mut self) {
        for snapshot in self.snapshots.try_iter() {
            self.model.update(&snapshot);
        }
        match self.viewer.views().try_recv() {
            Ok(view) => self.model.view = view,
            Err(TryRecvError::Disconnected) => self.model.has_ended = true,
            Err(TryRecvError::Empty) => {}
        }
    }

    fn send(&mut self, command: Command) {
        if let Err(error) = self.commands.send(command) {
            self.panels.message = Some(error.to_string());
        }
    }
}

/// A [`StudioApp`] in a window of the desktop.
struct Window {
    app: StudioApp,
    should_close: fn() -> bool,
}

impl eframe::App for Window {
    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        self.app.show(ui);
        let context = ui.ctx();
        if (self.should_close)() {
            context.send_viewport_cmd(egui::ViewportCommand::Close);
        }
        context.request_repaint_after(PICTURE_PERIOD);
    }
}

/// Shows the program in a window until that is closed, or `should_close` returns `true`. On the main thread only, as desktops
/// require.
pub fn open_window(app: StudioApp, should_close: fn() -> bool) -> Result<(), StudioError> {
    let viewport = egui::ViewportBuilder::default()
        .with_title(text("window-title"))
        .with_app_id("ademan-studio")
        .with_inner_size(WINDOW_SIZE)
        .with_min_inner_size(MIN_WINDOW_SIZE);
    let options = eframe::NativeOptions {
        viewport,
        renderer: eframe::Renderer::Glow,
        ..eframe::NativeOptions::default()
    };
    let window = Window { app, should_close };
    let create: eframe::AppCreator = Box::new(|creation| {
        StudioApp::prepare(&creation.egui_ctx);
        Ok(Box::new(window))
    });
    let opened = eframe::run_native(text("window-title"), options, create);
    opened.map_err(|error| StudioError::Window(error.to_string()))
}
