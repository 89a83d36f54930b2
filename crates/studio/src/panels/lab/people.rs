//! The people of a run as bars, the worst first. A click on a bar lets that person type again.

use eframe::egui::{self, Align2, FontId, Sense, WidgetInfo};

use super::super::look;
use super::super::space::color32;
use super::LabState;
use crate::lab::PersonBar;
use crate::texts::{text, text_with};

/// Height of a bar, in points.
const HEIGHT: f32 = 22.0;

/// The failure that fills a bar, if no person is worse.
const FULL: f64 = 0.1;

/// The people that are shown.
const SHOWN: usize = 40;

/// Draws the bars. Returns the index of the person to watch, if a bar was clicked.
pub(super) fn show(ui: &mut egui::Ui, state: &LabState) -> Option<usize> {
    let shown = state.shown.as_ref()?;
    ui.separator();
    ui.strong(text("lab-worst-people"));
    let is_typing = shown.bars.iter().any(|bar| bar.can_be_watched);
    let hint = if is_typing {
        "lab-watch-hint"
    } else {
        "lab-watch-tasks"
    };
    ui.label(egui::RichText::new(text(hint)).weak());
    if state.watching.is_some() {
        ui.spinner();
    }
    let worst = shown.bars.first().map_or(FULL, |bar| bar.failure.max(FULL));
    let mut clicked = None;
    for bar in shown.bars.iter().take(SHOWN) {
        let is_enabled = bar.can_be_watched && state.watching.is_none();
        if show_bar(ui, bar, worst, is_enabled) {
            clicked = Some(bar.index);
        }
    }
    clicked
}

fn show_bar(ui: &mut egui::Ui, bar: &PersonBar, worst: f64, is_enabled: bool) -> bool {
    let sense = if is_enabled {
        Sense::click()
    } else {
        Sense::hover()
    };
    let size = egui::vec2(ui.available_width(), HEIGHT);
    let (area, response) = ui.allocate_exact_size(size, sense);
    let values = [
        ("number", bar.number.to_string().into()),
        ("hand", format!("{:.0}", bar.hand_mm).into()),
        ("fingers", bar.style.as_str().into()),
        ("failure", format!("{:.1}", 100.0 * bar.failure).into()),
    ];
    let words = text_with("lab-person", &values);
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, is_enabled, &words));
    let visuals = ui.style().interact(&response);
    let painter = ui.painter_at(area);
    let inner = area.shrink2(egui::vec2(0.0, 1.0));
    painter.rect_filled(inner, 3.0, ui.visuals().extreme_bg_color);
    let colors = look::scene_colors(ui.visuals());
    let part = (bar.failure / worst).clamp(0.0, 1.0) as f32;
    let filled = inner.with_max_x(inner.min.x + part * inner.width());
    painter.rect_filled(filled, 3.0, color32(colors.fault).gamma_multiply(0.55));
    if response.hovered() && is_enabled || response.has_focus() {
        painter.rect_stroke(inner, 3.0, visuals.fg_stroke, egui::StrokeKind::Inside);
    }
    painter.text(
        inner.left_center() + egui::vec2(6.0, 0.0),
        Align2::LEFT_CENTER,
        &words,
        FontId::proportional(12.0),
        ui.visuals().strong_text_color(),
    );
    response.clicked()
}
