//! The window of the desktop, and its place.

use std::time::Duration;

use eframe::egui;

use super::{StudioApp, StudioStart};
use crate::error::StudioError;
use crate::graphics;
use crate::pace::Pace;
use crate::settings::WindowPlace;
use crate::texts::text;
use ademan_runtime::priority;

/// Size of the window at the first start, in points.
const WINDOW_SIZE: [f32; 2] = [1280.0, 800.0];

/// Time between two pictures of the first start, in which only what was found changes.
const FIRST_PERIOD: Duration = Duration::from_millis(100);

/// Smallest size of the window, in points.
const MIN_WINDOW_SIZE: [f32; 2] = [640.0, 400.0];

/// Space of a screen for the frame of the window and the panels of the desktop, in points.
const SCREEN_MARGIN: egui::Vec2 = egui::vec2(16.0, 64.0);

/// A [`StudioStart`] in a window of the desktop.
struct Window<'a> {
    content: StudioStart<'a>,
    /// `true` once the size was fitted to the screen.
    is_fitted: bool,
    pace: Pace,
    should_close: fn() -> bool,
}

impl eframe::App for Window<'_> {
    fn ui(&mut self, ui: &mut egui::Ui, frame: &mut eframe::Frame) {
        let is_stopped = (self.should_close)();
        if is_stopped && let Some(app) = self.content.app() {
            app.panels.permit_close();
        }
        self.content.show(ui);
        let context = ui.ctx();
        name_window(context);
        if !self.is_fitted {
            self.is_fitted = fit_to_screen(context);
        }
        if is_stopped {
            context.send_viewport_cmd(egui::ViewportCommand::Close);
        }
        let Some(app) = self.content.app() else {
            context.request_repaint_after(FIRST_PERIOD);
            return;
        };
        let is_end = is_stopped || context.input(|input| input.viewport().close_requested());
        app.save_settings(context, is_end);
        let now = context.input(|input| input.time);
        let cost = Duration::from_secs_f32(frame.info().cpu_usage.unwrap_or(0.0));
        let pause = self.pace.pause(now, app.has_changed, cost);
        context.request_repaint_after(pause);
    }
}

/// Shrinks a window that does not fit on its screen. Returns `true` once the size of the screen is known.
fn fit_to_screen(context: &egui::Context) -> bool {
    let (screen, is_filled) = context.input(|input| {
        let window = input.viewport();
        let is_filled = [window.maximized, window.fullscreen].contains(&Some(true));
        (window.monitor_size, is_filled)
    });
    let Some(screen) = screen else {
        return false;
    };
    let present = context.content_rect().size();
    let size = present.min(screen - SCREEN_MARGIN);
    if size != present && !is_filled {
        context.send_viewport_cmd(egui::ViewportCommand::InnerSize(size));
    }
    true
}

/// Gives the window its title in the accessibility tree, where the toolkit leaves the name of a window empty.
fn name_window(context: &egui::Context) {
    let root = egui::accesskit_root_id();
    context.accesskit_node_builder(root, |window| window.set_label(text("window-title")));
}

/// Shows the program in a window until that is closed, or `should_close` returns `true`. On the main thread only, as desktops
/// require.
pub fn open_window(
    mut content: StudioStart,
    should_close: fn() -> bool,
) -> Result<(), StudioError> {
    let settings = content.app().map(|app| app.settings().clone());
    let settings = settings.unwrap_or_default();
    let (place, scale) = (settings.window, settings.scale);
    let mut viewport = egui::ViewportBuilder::default()
        .with_title(text("window-title"))
        .with_app_id("ademan-studio")
        .with_inner_size(place.map_or(WINDOW_SIZE, |place| place.size))
        .with_min_inner_size(MIN_WINDOW_SIZE);
    if let Some(position) = place.and_then(|place| place.position) {
        viewport = viewport.with_position(position);
    }
    let options = window_options(viewport);
    let window = Window {
        content,
        is_fitted: false,
        pace: Pace::new(graphics::has_card()),
        should_close,
    };
    let create: eframe::AppCreator = Box::new(|creation| {
        StudioApp::prepare(&creation.egui_ctx);
        creation.egui_ctx.set_zoom_factor(scale);
        Ok(Box::new(window))
    });
    run_window(text("window-title"), options, create)
}

/// Shows a window until it is closed.
pub(crate) fn run_window(
    title: &str,
    options: eframe::NativeOptions,
    create: eframe::AppCreator<'_>,
) -> Result<(), StudioError> {
    // Mesa fills a picture for longer than a press may wait.
    priority::shorten_time_slice();
    eframe::run_native(title, options, create).map_err(window_error)
}

/// Returns the options of every window of Studio.
pub(crate) fn window_options(viewport: egui::ViewportBuilder) -> eframe::NativeOptions {
    eframe::NativeOptions {
        viewport,
        renderer: eframe::Renderer::Glow,
        // It takes time for each pixel where Mesa draws in software, and hides steps of gradients that no window has.
        dithering: false,
        ..eframe::NativeOptions::default()
    }
}

/// Returns the reason why a window was not opened.
fn window_error(error: eframe::Error) -> StudioError {
    match error {
        eframe::Error::Winit(_) | eframe::Error::WinitEventLoop(_) => StudioError::NoDesktop,
        eframe::Error::Glutin(error) => StudioError::NoOpenGl(error.to_string()),
        eframe::Error::NoGlutinConfigs(_, error) => StudioError::NoOpenGl(error.to_string()),
        error => StudioError::NoOpenGl(error.to_string()),
    }
}

/// Returns position and size of a window that is neither maximized nor minimized.
pub(super) fn place_of_window(context: &egui::Context) -> Option<WindowPlace> {
    context.input(|input| {
        let window = input.viewport();
        let is_placed_by_desktop = [window.maximized, window.minimized, window.fullscreen];
        if is_placed_by_desktop.contains(&Some(true)) {
            return None;
        }
        let size = window.inner_rect?.size();
        let position = window.outer_rect.map(|area| [area.min.x, area.min.y]);
        Some(WindowPlace {
            position,
            size: [size.x, size.y],
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the size that a window of this size asks for, if any.
    fn asked(window: [f32; 2], screen: [f32; 2], is_maximized: bool) -> Option<egui::Vec2> {
        let context = egui::Context::default();
        let area = egui::Rect::from_min_size(egui::Pos2::ZERO, window.into());
        let mut input = egui::RawInput {
            screen_rect: Some(area),
            ..egui::RawInput::default()
        };
        let viewport = input.viewports.entry(egui::ViewportId::ROOT).or_default();
        viewport.monitor_size = Some(screen.into());
        viewport.maximized = Some(is_maximized);
        let output = context.run_ui(input, |ui| assert!(fit_to_screen(ui.ctx())));
        let root = &output.viewport_output[&egui::ViewportId::ROOT];
        let mut sizes = root.commands.iter().filter_map(|command| match command {
            egui::ViewportCommand::InnerSize(size) => Some(*size),
            _ => None,
        });
        let size = sizes.next();
        output.drop_without_applying_deltas();
        size
    }

    #[test]
    fn a_window_with_its_frame_fits_on_the_screen() {
        let small = asked(WINDOW_SIZE, WINDOW_SIZE, false);
        let small = small.expect("another size");
        assert!(small.x < WINDOW_SIZE[0] && small.y < WINDOW_SIZE[1]);
        assert_eq!(asked(WINDOW_SIZE, [1920.0, 1080.0], false), None);
        assert_eq!(asked(WINDOW_SIZE, WINDOW_SIZE, true), None);
        assert_eq!(
            asked([1000.0, 790.0], WINDOW_SIZE, false).map(|it| it.x),
            Some(1000.0)
        );
    }
}
