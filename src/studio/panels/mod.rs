//! The panels of the window, one file each, and the part of the window that each fills.

mod fonts;
mod recording;
mod scope;
mod sensors;
mod space;
mod status;
mod toolbar;

use eframe::egui;

use self::recording::RecordingState;
use self::scope::ScopeState;
use super::camera::Camera;
use super::model::StudioModel;
use super::playback::{Move, Player};
use super::scene::SceneOptions;
use super::texts::text;
use crate::command::Command;

pub use self::fonts::fonts;

/// The state of the session, and commands to it, for a panel.
pub struct PanelContext<'a> {
    /// The state to show.
    pub model: &'a StudioModel,
    /// Commands that are sent after the picture.
    pub sent: &'a mut Vec<Command>,
    /// The recording that is shown, if any.
    pub player: Option<&'a Player>,
    /// Moves within the recording, which follow the picture.
    pub moves: &'a mut Vec<Move>,
}

/// The state of the panels between two pictures.
pub struct PanelState {
    /// Panels beside the 3D view that are shown, by [`PanelKind`].
    shown: [bool; PanelKind::ALL.len()],
    camera: Camera,
    /// The camera has been pointed at the boards.
    is_camera_placed: bool,
    scene: SceneOptions,
    scope: ScopeState,
    recording: RecordingState,
    /// Reason why the last command was not sent.
    pub message: Option<String>,
}

/// A panel that can be hidden.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PanelKind {
    /// Channels of the glove, and statistics.
    Sensors,
    /// Time plots.
    Scope,
}

impl PanelKind {
    const ALL: [Self; 2] = [Self::Sensors, Self::Scope];

    fn name(self) -> &'static str {
        match self {
            Self::Sensors => text("panel-sensors"),
            Self::Scope => text("panel-scope"),
        }
    }
}

impl Default for PanelState {
    fn default() -> Self {
        Self {
            shown: [true; PanelKind::ALL.len()],
            camera: Camera::default(),
            is_camera_placed: false,
            scene: SceneOptions::default(),
            scope: ScopeState::default(),
            recording: RecordingState::default(),
            message: None,
        }
    }
}

/// Draws all panels.
pub fn show(ui: &mut egui::Ui, state: &mut PanelState, context: &mut PanelContext) {
    egui::Panel::top("toolbar").show(ui, |ui| toolbar::show(ui, state, context));
    egui::Panel::bottom("status").show(ui, |ui| status::show(ui, state, context));
    if let Some(player) = context.player {
        let panel = egui::Panel::bottom("recording");
        panel.show(ui, |ui| {
            recording::show(ui, &mut state.recording, player, context.moves)
        });
    }
    if state.shown[PanelKind::Sensors as usize] {
        let panel = egui::Panel::right("sensors")
            .default_size(330.0)
            .min_size(260.0);
        panel.show(ui, |ui| sensors::show(ui, context));
    }
    if state.shown[PanelKind::Scope as usize] {
        let panel = egui::Panel::bottom("scope")
            .resizable(true)
            .default_size(230.0)
            .min_size(90.0);
        panel.show(ui, |ui| scope::show(ui, &mut state.scope, context));
    }
    let space = egui::CentralPanel::default().frame(egui::Frame::NONE);
    space.show(ui, |ui| space::show(ui, state, context));
}
