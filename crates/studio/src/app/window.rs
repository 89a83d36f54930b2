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

/// Time between two frames of the first start, in which only what was found changes.
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

/// Returns `true` in the first frame, whose sizes are not yet in points of the scale of the window.
fn is_first_picture(context: &egui::Context) -> bool {
    context.cumulative_frame_nr() == 0
}

/// Shrinks a window that does not fit on its screen. Returns `true` once the size of the screen is known.
fn fit_to_screen(context: &egui::Context) -> bool {
    if is_first_picture(context) {
        context.request_repaint();
        return false;
    }
    let (screen, is_filled) = context.input(|input| {
        let window = input.viewport();
        let is_filled = [window.maximized, window.fullscreen].contains(&Some(true));
        (window.monitor_size, is_filled)
    });
    let Some(screen) = screen else {
        return false;
    };
    let present = context.content_rect().size();
    // The desktop draws the frame of the window in its own scale.
    let size = present.min(screen - SCREEN_MARGIN / context.zoom_factor());
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
    let scale = settings.scale;
    let options = window_options(viewport_at(settings.window, scale));
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

/// Returns the window at its place, which is in points of a scale. The window is created before it has that scale.
fn viewport_at(place: Option<WindowPlace>, scale: f32) -> egui::ViewportBuilder {
    let scaled = |lengths: [f32; 2]| lengths.map(|length| length * scale);
    let viewport = egui::ViewportBuilder::default()
        .with_title(text("window-title"))
        .with_app_id("ademan-studio")
        .with_inner_size(scaled(place.map_or(WINDOW_SIZE, |place| place.size)))
        .with_min_inner_size(MIN_WINDOW_SIZE);
    match place.and_then(|place| place.position) {
        Some(position) => viewport.with_position(scaled(position)),
        None => viewport,
    }
}

/// Shows a window until it is closed.
pub(crate) fn run_window(
    title: &str,
    options: eframe::NativeOptions,
    create: eframe::AppCreator<'_>,
) -> Result<(), StudioError> {
    // Mesa fills a frame for longer than a press may wait.
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
    if is_first_picture(context) {
        return None;
    }
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

    /// Returns the input of a frame of a window with this size on a screen, both in points of a scale.
    fn input(window: [f32; 2], screen: [f32; 2], scale: f32) -> egui::RawInput {
        let size = egui::Vec2::from(window) / scale;
        let area = egui::Rect::from_min_size(egui::Pos2::ZERO, size);
        let mut input = egui::RawInput {
            screen_rect: Some(area),
            ..egui::RawInput::default()
        };
        let viewport = input.viewports.entry(egui::ViewportId::ROOT).or_default();
        viewport.monitor_size = Some(egui::Vec2::from(screen) / scale);
        viewport.inner_rect = Some(area);
        input
    }

    /// Returns the sizes that a window asks for in a frame.
    fn sizes(output: &egui::FullOutput) -> Vec<egui::Vec2> {
        let root = &output.viewport_output[&egui::ViewportId::ROOT];
        let commands = root.commands.iter();
        let sizes = commands.filter_map(|command| match command {
            egui::ViewportCommand::InnerSize(size) => Some(*size),
            _ => None,
        });
        sizes.collect()
    }

    /// Returns the size in pixels that a window of this size in pixels asks for, if any, in its first two frames.
    fn asked_at(
        window: [f32; 2],
        screen: [f32; 2],
        (scale, is_maximized): (f32, bool),
    ) -> Option<egui::Vec2> {
        let context = egui::Context::default();
        context.set_zoom_factor(scale);
        // The toolkit measures the first frame before the window has its scale.
        let first = context.run_ui(input(window, screen, 1.0), |ui| {
            assert!(!fit_to_screen(ui.ctx()));
            assert_eq!(place_of_window(ui.ctx()), None);
        });
        assert!(sizes(&first).is_empty());
        first.drop_without_applying_deltas();
        let mut second = input(window, screen, scale);
        let viewport = second.viewports.entry(egui::ViewportId::ROOT).or_default();
        viewport.maximized = Some(is_maximized);
        let output = context.run_ui(second, |ui| assert!(fit_to_screen(ui.ctx())));
        let size = sizes(&output).first().map(|size| *size * scale);
        output.drop_without_applying_deltas();
        size
    }

    /// Returns the size that a window of this size asks for, if any.
    fn asked(window: [f32; 2], screen: [f32; 2], is_maximized: bool) -> Option<egui::Vec2> {
        asked_at(window, screen, (1.0, is_maximized))
    }

    #[test]
    fn a_window_of_another_scale_keeps_its_size_on_the_screen() {
        for scale in [0.8, 1.2, 2.0] {
            let kept = asked_at([1100.0, 700.0], WINDOW_SIZE, (scale, false));
            assert_eq!(kept, None, "{scale}");
            let fitted = asked_at([1500.0, 883.0], WINDOW_SIZE, (scale, false));
            let fitted = fitted.expect("another size");
            assert!(fitted.x < WINDOW_SIZE[0] && fitted.y < WINDOW_SIZE[1]);
        }
    }

    #[test]
    fn a_window_opens_with_the_pixels_with_which_it_was_closed() {
        let place = WindowPlace {
            position: Some([50.0, 20.0]),
            size: [550.0, 350.0],
        };
        let viewport = viewport_at(Some(place), 2.0);
        assert_eq!(viewport.inner_size, Some(egui::vec2(1100.0, 700.0)));
        assert_eq!(viewport.position, Some(egui::pos2(100.0, 40.0)));
        let first = viewport_at(None, 1.0);
        assert_eq!(first.inner_size, Some(egui::Vec2::from(WINDOW_SIZE)));
        assert_eq!(first.position, None);
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
