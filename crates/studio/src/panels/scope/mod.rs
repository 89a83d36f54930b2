//! The scope: plots of the last 30 s over one time axis.

mod canvas;
mod colors;
mod lanes;
#[cfg(test)]
mod tests;

use eframe::egui::{self, Key, Role, Sense, WidgetInfo};

use self::canvas::Canvas;
use super::PanelContext;
use crate::history::{History, SECONDS};
use crate::joint_names::joint_name;
use crate::plot::TimeWindow;
use crate::texts::text;
use ademan_core::hand::Dof;

/// Angles that are plotted at first.
const FIRST_ANGLES: [Dof; 4] = [
    Dof::ElbowFlexion,
    Dof::WristFlexion,
    Dof::IndexMcpFlexion,
    Dof::IndexPipFlexion,
];

/// Change of the length of the window with one key.
const ZOOM_STEP: f64 = 1.25;

/// Movement of the window with one key, as a fraction of its length.
const PAN_STEP: f64 = 0.1;

/// The content of the scope.
pub struct ScopeState {
    /// Angles that are plotted, in the order of [`Dof::ALL`].
    angles: [bool; Dof::COUNT],
    rows: Rows,
    window: TimeWindow,
    /// The values that are shown while the plot is held.
    held: Option<Box<History>>,
}

/// Rows besides the angles.
#[derive(Clone, Copy)]
struct Rows {
    heights: bool,
    latency: bool,
    presses: bool,
    events: bool,
}

impl Default for ScopeState {
    fn default() -> Self {
        let mut angles = [false; Dof::COUNT];
        for dof in FIRST_ANGLES {
            angles[dof.index()] = true;
        }
        Self {
            angles,
            rows: Rows {
                heights: true,
                latency: false,
                presses: true,
                events: true,
            },
            window: TimeWindow::new(SECONDS),
            held: None,
        }
    }
}

impl ScopeState {
    /// Releases a plot that is held: its session has ended.
    #[must_use]
    pub fn without_held(self) -> Self {
        Self { held: None, ..self }
    }

    /// Returns the angles and rows that are drawn: without those that the views of another program do not have.
    const fn shown(&self, is_from_views: bool) -> ([bool; Dof::COUNT], Rows) {
        if is_from_views {
            let rows = Rows {
                latency: false,
                ..self.rows
            };
            ([false; Dof::COUNT], rows)
        } else {
            (self.angles, self.rows)
        }
    }
}

pub(super) fn show(ui: &mut egui::Ui, state: &mut ScopeState, context: &mut PanelContext) {
    ui.add_space(4.0);
    let history = &context.model.history;
    let is_from_views = context.model.is_from_views;
    ui.horizontal(|ui| show_controls(ui, state, history, is_from_views));
    let (area, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, text("scope-plot")));
    change_window(ui, &mut state.window, &response);
    let history = state.held.as_deref().unwrap_or(history);
    let (angles, rows) = state.shown(is_from_views);
    let names = lanes::row_names(history, rows);
    let Some(canvas) = Canvas::new(ui, area, history, state.window, &names) else {
        return;
    };
    lanes::draw(&canvas, &angles, rows);
    if let Some(pointer) = response.hover_pos()
        && let Some(time) = canvas.time_at(pointer.x)
    {
        canvas.mark(time);
        response.on_hover_ui_at_pointer(|hint| {
            for line in lanes::values_at(history, time, &angles, rows) {
                hint.label(line);
            }
        });
    }
}

/// Shows the choice of rows. `is_from_views`: angles and latencies are not known.
fn show_controls(
    ui: &mut egui::Ui,
    state: &mut ScopeState,
    history: &History,
    is_from_views: bool,
) {
    ui.strong(text("panel-scope"));
    ui.add_enabled_ui(!is_from_views, |ui| {
        ui.menu_button(text("scope-angles"), |ui| show_angles(ui, state, history))
            .response
            .on_disabled_hover_text(text("scope-not-sent"));
    });
    ui.menu_button(text("scope-rows"), |ui| {
        let rows = &mut state.rows;
        ui.checkbox(&mut rows.heights, text("scope-heights"));
        let latency = egui::Checkbox::new(&mut rows.latency, text("scope-latency"));
        ui.add_enabled(!is_from_views, latency)
            .on_disabled_hover_text(text("scope-not-sent"));
        ui.checkbox(&mut rows.presses, text("scope-presses"));
        ui.checkbox(&mut rows.events, text("scope-events"));
    });
    let mut is_held = state.held.is_some();
    if ui.checkbox(&mut is_held, text("scope-hold")).changed() {
        state.held = is_held.then(|| Box::new(history.clone()));
    }
    if ui.button(text("scope-latest")).clicked() {
        state.window = TimeWindow::new(SECONDS);
    }
    let hint = egui::RichText::new(text("scope-hint")).weak().small();
    ui.add(egui::Label::new(hint).truncate());
}

fn show_angles(ui: &mut egui::Ui, state: &mut ScopeState, history: &History) {
    egui::ScrollArea::vertical().show(ui, |ui| {
        let last = history.last_known();
        for (dof, is_shown) in Dof::ALL.iter().zip(&mut state.angles) {
            let is_known = last.is_none_or(|last| !last.degrees[dof.index()].is_nan());
            let checkbox = egui::Checkbox::new(is_shown, joint_name(*dof));
            ui.add_enabled(is_known, checkbox);
        }
    });
}

/// Zooms and pans with the mouse, and with the keys of a focused plot.
fn change_window(ui: &egui::Ui, window: &mut TimeWindow, response: &egui::Response) {
    let width = f64::from(response.rect.width().max(1.0));
    window.pan(f64::from(response.drag_delta().x) / width, SECONDS);
    if response.double_clicked() {
        *window = TimeWindow::new(SECONDS);
    }
    if response.clicked() {
        response.request_focus();
    }
    if let Some(pointer) = response.hover_pos() {
        let scroll = f64::from(ui.input(|input| input.smooth_scroll_delta().y));
        let fraction = f64::from(pointer.x - response.rect.min.x) / width;
        window.zoom((-scroll * 0.004).exp(), fraction, SECONDS);
    }
    if response.has_focus() {
        let pressed = |key| ui.input(|input| input.key_pressed(key));
        if pressed(Key::Plus) || pressed(Key::Equals) {
            window.zoom(1.0 / ZOOM_STEP, 1.0, SECONDS);
        }
        if pressed(Key::Minus) {
            window.zoom(ZOOM_STEP, 1.0, SECONDS);
        }
        if pressed(Key::PageUp) {
            window.pan(PAN_STEP, SECONDS);
        }
        if pressed(Key::PageDown) {
            window.pan(-PAN_STEP, SECONDS);
        }
    }
}
