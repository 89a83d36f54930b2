//! The window of the overlay.

use std::path::PathBuf;
use std::time::Duration;

use crossbeam_channel::{Receiver, TryRecvError};
use eframe::egui::{self, Align2, Color32, FontId, Pos2, Rect, ViewportCommand, WindowLevel};
use parry3d::math::Vec2;

use super::desktop::{self, Ability};
use super::{CANDIDATES_HEIGHT, OverlayBoards, STATE_HEIGHT};
use crate::app::{StudioApp, run_window, window_options};
use crate::error::StudioError;
use crate::panels;
use crate::picture::Color;
use crate::scene::SceneColors;
use crate::settings::{MIN_OPACITY, Settings, Theme};
use crate::settings_file::SettingsFile;
use crate::sound::Sound;
use crate::texts::{set_language, text};
use crate::typing::Typing;
use ademan_core::snapshot::Snapshot;
use ademan_runtime::session::SessionHandle;
use ademan_runtime::session::view::{View, Viewer};

/// Time between two frames, equal to the time between two views.
const PICTURE_PERIOD: Duration = Duration::from_millis(33);

/// Distance to the lower edge of the screen before the overlay was placed, in points.
const SCREEN_EDGE: f32 = 48.0;

/// Frames after which the window has its level and lets clicks through: some desktops forget what is asked before.
const SETTLED: u32 = 3;

/// The overlay of a session.
pub struct Overlay {
    view: View,
    viewer: Viewer,
    has_ended: bool,
    boards: OverlayBoards,
    settings: Settings,
    settings_file: SettingsFile,
    /// The clicks, and what they pass on to a window that shows poses.
    sound: Option<(Sound, Receiver<Snapshot>)>,
    ability: Ability,
    /// The window has a title bar and takes clicks, so that it can be moved.
    is_being_placed: bool,
    frames: u32,
    size: Vec2,
}

impl Overlay {
    /// Creates the overlay of a session. `is_being_placed` gives it a title bar, so that it can be moved.
    pub fn new(session: &SessionHandle, is_being_placed: bool) -> Result<Self, StudioError> {
        let viewer = session.add_viewer();
        let view = viewer.views().recv().map_err(|_| StudioError::Ended)?;
        let boards = OverlayBoards::new(&view.layout);
        let ability = desktop::ability();
        Ok(Self {
            size: window_size(&boards, ability, is_being_placed),
            view,
            viewer,
            has_ended: false,
            boards,
            settings: Settings::default(),
            settings_file: SettingsFile::default(),
            sound: Sound::start(session.snapshots().clone(), session.add_viewer()).ok(),
            ability,
            is_being_placed,
            frames: 0,
        })
    }

    /// Restores position, opacity and colors from the settings of Studio. Returns the reason if they cannot be read.
    pub fn restore(&mut self, path: PathBuf) -> Option<String> {
        let (file, settings, error) = SettingsFile::open(path);
        self.settings_file = file;
        self.settings = settings;
        if let Some(language) = self.settings.language {
            set_language(language);
        }
        error.map(|error| error.to_string())
    }

    /// Returns words for the terminal if the desktop cannot show what was asked for.
    pub fn limitation(&self) -> Option<&'static str> {
        self.ability.limitation()
    }

    fn colors(&self) -> SceneColors {
        let is_dark = self.settings.theme != Theme::Light;
        SceneColors::new(is_dark, self.settings.has_high_contrast)
    }

    /// Receives the latest view. Does not wait.
    fn receive(&mut self) {
        match self.viewer.views().try_recv() {
            Ok(view) => self.view = view,
            Err(TryRecvError::Disconnected) => self.has_ended = true,
            Err(TryRecvError::Empty) => {}
        }
    }

    /// Applies the settings of the clicks, and prints once why none are heard.
    fn apply_sound(&mut self) {
        if let Some((sound, _)) = &mut self.sound
            && sound.apply(self.settings.sound)
            && let Some(error) = sound.error()
        {
            tracing::warn!("{error}");
        }
    }

    /// Fits the boards and the window to another layout.
    fn follow_layout(&mut self, context: &egui::Context) {
        if !self.boards.are_of(&self.view.layout) {
            self.boards = OverlayBoards::new(&self.view.layout);
            self.size = window_size(&self.boards, self.ability, self.is_being_placed);
            let size = egui::vec2(self.size.x, self.size.y);
            context.send_viewport_cmd(ViewportCommand::InnerSize(size));
        }
    }

    /// Asks the desktop to keep the window above the others, to let clicks through, and, before it was placed, to put it at the
    /// lower edge of the screen.
    fn settle(&mut self, context: &egui::Context) {
        self.frames = self.frames.saturating_add(1);
        if self.is_being_placed || self.frames > SETTLED {
            return;
        }
        context.send_viewport_cmd(ViewportCommand::WindowLevel(WindowLevel::AlwaysOnTop));
        context.send_viewport_cmd(ViewportCommand::MousePassthrough(
            self.ability != Ability::None,
        ));
        if self.settings.overlay.position.is_none()
            && let Some(screen) = context.input(|input| input.viewport().monitor_size)
        {
            let left = (screen.x - self.size.x) / 2.0;
            let top = screen.y - self.size.y - SCREEN_EDGE;
            let position = Pos2::new(left.max(0.0), top.max(0.0));
            context.send_viewport_cmd(ViewportCommand::OuterPosition(position));
        }
    }

    fn show(&mut self, ui: &mut egui::Ui) {
        let area = ui.ctx().content_rect();
        let (colors, opacity) = (self.colors(), self.settings.overlay.opacity);
        let top = area.min + egui::vec2(0.0, CANDIDATES_HEIGHT);
        let bottom = area.max - egui::vec2(0.0, STATE_HEIGHT);
        let boards = Rect::from_min_max(top, bottom);
        let size = Vec2::new(boards.width(), boards.height()).max(Vec2::ONE);
        let is_opaque = self.ability != Ability::Transparent || self.is_being_placed;
        let opacity = if is_opaque { 1.0 } else { opacity };
        let picture = self.boards.picture(&self.view, size, &colors, opacity);
        let painter = ui.painter().with_clip_rect(area);
        if is_opaque {
            painter.rect_filled(area, 0.0, panels::color32(colors.background));
        }
        panels::paint(&painter, boards, &picture, Color([0; 4]));
        self.show_state(&painter, area, opacity);
        if self.is_being_placed {
            self.show_placing(ui, area)
        } else {
            self.show_candidates(&painter, area, opacity)
        }
    }

    /// Shows the state of the session at the lower edge, as a word on a color.
    fn show_state(&self, painter: &egui::Painter, area: Rect, opacity: f32) {
        let state = &self.view.state;
        let typing = if self.has_ended {
            Typing::Ended
        } else {
            Typing::with_output(&state.output, state.state)
        };
        let color = match typing {
            Typing::Into(_) => Color32::from_rgb(0x12, 0x6b, 0x3f),
            Typing::Suppressed => Color32::from_rgb(0x8a, 0x4b, 0x00),
            Typing::Nowhere | Typing::Ended => Color32::from_gray(0x40),
        };
        let font = FontId::proportional(13.0);
        let words = painter.layout_no_wrap(typing.words(), font, Color32::WHITE);
        let strip = Rect::from_min_max(
            Pos2::new(area.min.x, area.max.y - STATE_HEIGHT + 2.0),
            Pos2::new(area.min.x + words.size().x + 16.0, area.max.y),
        );
        painter.rect_filled(strip, 4.0, color.gamma_multiply(opacity.max(0.5)));
        let at = Align2::CENTER_CENTER.anchor_size(strip.center(), words.size());
        painter.galley(at.min, words, Color32::WHITE);
        self.show_typed(painter, area, strip.max.x + 8.0, opacity);
    }

    /// Shows the end of the text so far at the lower edge, from a position on.
    fn show_typed(&self, painter: &egui::Painter, area: Rect, left: f32, opacity: f32) {
        let room = ((area.max.x - left - 16.0) / TYPED_WIDTH).max(0.0);
        let typed = self.view.state.typed_end(room as usize);
        if typed.is_empty() {
            return;
        }
        let font = FontId::monospace(13.0);
        let words = painter.layout_no_wrap(typed, font, Color32::WHITE);
        let strip = Rect::from_min_max(
            Pos2::new(left, area.max.y - STATE_HEIGHT + 2.0),
            Pos2::new(left + words.size().x + 16.0, area.max.y),
        );
        let color = Color32::from_gray(0x20).gamma_multiply(opacity.max(0.5));
        painter.rect_filled(strip, 4.0, color);
        let at = Align2::CENTER_CENTER.anchor_size(strip.center(), words.size());
        painter.galley(at.min, words, Color32::WHITE);
    }

    /// Shows the candidates of the text decoder above the boards. Clicks pass through the window, so a key or a gesture takes one.
    fn show_candidates(&self, painter: &egui::Painter, area: Rect, opacity: f32) {
        let words = self.view.state.candidates.iter().zip(1..);
        let words: Vec<_> = words
            .map(|(word, number)| format!("{number} {word}"))
            .collect();
        if words.is_empty() {
            return;
        }
        let font = FontId::proportional(15.0);
        let words = painter.layout_no_wrap(words.join("    "), font, Color32::WHITE);
        let size = egui::vec2(words.size().x + 16.0, CANDIDATES_HEIGHT - 2.0);
        let strip = Align2::CENTER_TOP.anchor_size(area.center_top(), size);
        let color = Color32::from_gray(0x20).gamma_multiply(opacity.max(0.5));
        painter.rect_filled(strip, 4.0, color);
        let at = Align2::CENTER_CENTER.anchor_size(strip.center(), words.size());
        painter.galley(at.min, words, Color32::WHITE);
    }

    /// Shows the opacity, and what to do with the window.
    fn show_placing(&mut self, ui: &mut egui::Ui, area: Rect) {
        let strip = Rect::from_min_size(area.min, egui::vec2(area.width(), CANDIDATES_HEIGHT));
        ui.scope_builder(egui::UiBuilder::new().max_rect(strip), |ui| {
            ui.horizontal_centered(|ui| {
                let opacity = &mut self.settings.overlay.opacity;
                let label = ui.label(text("overlay-opacity"));
                let slider = egui::Slider::new(opacity, MIN_OPACITY..=1.0);
                ui.add(slider).labelled_by(label.id);
                ui.label(text("overlay-place"));
            });
        });
    }

    /// Remembers the place of the window while it is being placed.
    fn remember(&mut self, context: &egui::Context) {
        if !self.is_being_placed {
            return;
        }
        if let Some(inner) = context.input(|input| input.viewport().inner_rect) {
            self.settings.overlay.position = Some([inner.min.x, inner.min.y]);
        }
    }
}

/// Width of a character of the text so far, in points, with some room.
const TYPED_WIDTH: f32 = 8.2;

/// Returns the size of the window: the boards, and the strips above and below them with their words.
fn window_size(boards: &OverlayBoards, ability: Ability, is_being_placed: bool) -> Vec2 {
    let size = boards.size(ability != Ability::Transparent);
    let words = if is_being_placed { 680.0 } else { 320.0 };
    let height = size.y + CANDIDATES_HEIGHT + STATE_HEIGHT;
    Vec2::new(size.x.max(words), height)
}

/// An [`Overlay`] in a window of the desktop.
struct OverlayWindow {
    overlay: Overlay,
    should_close: fn() -> bool,
}

impl eframe::App for OverlayWindow {
    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        let context = ui.ctx().clone();
        self.overlay.receive();
        self.overlay.apply_sound();
        self.overlay.follow_layout(&context);
        self.overlay.show(ui);
        self.overlay.settle(&context);
        self.overlay.remember(&context);
        let is_end = (self.should_close)() || self.overlay.has_ended;
        if is_end {
            context.send_viewport_cmd(ViewportCommand::Close);
        }
        context.request_repaint_after(PICTURE_PERIOD);
    }

    fn on_exit(&mut self, _gl: Option<&eframe::glow::Context>) {
        if let Err(error) = self.overlay.settings_file.save(&self.overlay.settings) {
            tracing::warn!("{error}");
        }
    }

    fn clear_color(&self, _visuals: &egui::Visuals) -> [f32; 4] {
        [0.0; 4]
    }
}

/// Shows the overlay until `should_close` returns `true`, the session ends or, while it is being placed, its window is closed. On
/// the main thread only, as desktops require.
pub fn open_overlay(overlay: Overlay, should_close: fn() -> bool) -> Result<(), StudioError> {
    let can_stay_above = overlay.ability != Ability::None;
    let is_ordinary = overlay.is_being_placed || !can_stay_above;
    let title = text("overlay-title");
    let mut viewport = egui::ViewportBuilder::default()
        .with_title(title)
        .with_app_id("ademan-overlay")
        .with_inner_size([overlay.size.x, overlay.size.y])
        .with_resizable(false)
        .with_transparent(overlay.ability == Ability::Transparent)
        .with_active(overlay.is_being_placed);
    if !is_ordinary {
        viewport = viewport
            .with_decorations(false)
            .with_taskbar(false)
            .with_always_on_top()
            .with_mouse_passthrough(true)
            .with_window_type(egui::X11WindowType::Dock);
    }
    if let Some(position) = overlay.settings.overlay.position {
        viewport = viewport.with_position(position);
    }
    let options = eframe::NativeOptions {
        event_loop_builder: can_stay_above.then(desktop::prefer_x11).flatten(),
        ..window_options(viewport)
    };
    let window = OverlayWindow {
        overlay,
        should_close,
    };
    let create: eframe::AppCreator = Box::new(|creation| {
        StudioApp::prepare(&creation.egui_ctx);
        Ok(Box::new(window))
    });
    run_window(title, options, create)
}
