//! The scope: angles, the height of the lowest fingertip, and presses of the last 30 s.

use eframe::egui::{self, Align2, Color32, FontId, Pos2, Rect, Stroke};

use super::PanelContext;
use crate::studio::history::{History, Moment, SECONDS, SHOWN_ANGLES};
use crate::studio::texts::text;

/// Colours of the lines: those of the angles, and that of the fingertip.
const LINE_COLORS: [Color32; SHOWN_ANGLES.len() + 1] = [
    Color32::from_rgb(0x3b, 0x82, 0xc4),
    Color32::from_rgb(0xd1, 0x7a, 0x22),
    Color32::from_rgb(0x3f, 0x9e, 0x5b),
    Color32::from_rgb(0xa4, 0x5b, 0xb8),
    Color32::from_rgb(0xc9, 0x4a, 0x4a),
];

/// Range of the angles, in degrees.
const DEGREES: (f32, f32) = (-90.0, 110.0);

/// Range of the height, in millimetres.
const HEIGHT_MM: (f32, f32) = (-10.0, 60.0);

/// Height of the line of presses, in points.
const PRESS_LINE: f32 = 10.0;

/// Seconds between two lines of the grid.
const GRID_SECONDS: usize = 5;

pub(super) fn show(ui: &mut egui::Ui, context: &mut PanelContext) {
    ui.add_space(4.0);
    ui.horizontal_wrapped(|ui| {
        ui.strong(text("panel-scope"));
        let angles = SHOWN_ANGLES.iter().map(|dof| format!("{}, °", dof.name()));
        let names = angles.chain([format!("{}, mm", text("scope-lowest-fingertip"))]);
        for (name, color) in names.zip(LINE_COLORS) {
            ui.colored_label(color, format!("— {name}"));
        }
        ui.colored_label(PRESS_COLOR, format!("▬ {}", text("scope-presses")));
    });
    let (area, _) = ui.allocate_exact_size(ui.available_size(), egui::Sense::hover());
    if area.height() < 2.0 * PRESS_LINE {
        return;
    }
    let painter = ui.painter_at(area);
    let background = ui.visuals().extreme_bg_color;
    painter.rect_filled(area, 4.0, background);
    let plot = area.with_max_y(area.max.y - PRESS_LINE - 2.0);
    draw_grid(&painter, area, ui.visuals().weak_text_color());
    draw_lines(&painter, plot, &context.model.history);
    draw_presses(&painter, area, &context.model.history);
}

const PRESS_COLOR: Color32 = Color32::from_rgb(0xff, 0xa0, 0x1c);

fn draw_grid(painter: &egui::Painter, area: Rect, color: Color32) {
    for seconds in (0..=SECONDS as usize).step_by(GRID_SECONDS) {
        let x = x_at(seconds as f32, area);
        let stroke = Stroke::new(0.5, color.gamma_multiply(0.5));
        painter.vline(x, area.y_range(), stroke);
        let at = Pos2::new(x + 3.0, area.min.y + 2.0);
        let name = format!("−{seconds} s");
        painter.text(
            at,
            Align2::LEFT_TOP,
            name,
            FontId::proportional(10.0),
            color,
        );
    }
}

fn draw_lines(painter: &egui::Painter, area: Rect, history: &History) {
    let angle = |index: usize| move |moment: &Moment| Some((moment.angles[index], DEGREES));
    for (index, &color) in LINE_COLORS.iter().take(SHOWN_ANGLES.len()).enumerate() {
        draw_line(painter, area, history, color, angle(index));
    }
    let height = |moment: &Moment| moment.height_mm.map(|height| (height, HEIGHT_MM));
    let color = LINE_COLORS[SHOWN_ANGLES.len()];
    draw_line(painter, area, history, color, height);
}

/// Draws one point for each pixel at most, which is all that can be seen.
fn draw_line(
    painter: &egui::Painter,
    area: Rect,
    history: &History,
    color: Color32,
    value: impl Fn(&Moment) -> Option<(f32, (f32, f32))>,
) {
    let mut points: Vec<Pos2> = Vec::new();
    for (age, moment) in history.iter() {
        let x = x_at(age, area);
        let Some((value, (low, high))) = value(moment) else {
            continue;
        };
        if points.last().is_some_and(|last| x - last.x < 1.0) {
            continue;
        }
        let fraction = ((value - low) / (high - low)).clamp(0.0, 1.0);
        points.push(Pos2::new(x, area.max.y - fraction * area.height()));
    }
    painter.line(points, Stroke::new(1.5, color));
}

fn draw_presses(painter: &egui::Painter, area: Rect, history: &History) {
    let mut start = None;
    let draw = |from: f32, to: f32| {
        let low = Pos2::new(x_at(from, area), area.max.y - PRESS_LINE);
        let high = Pos2::new(x_at(to, area).max(low.x + 1.5), area.max.y - 2.0);
        painter.rect_filled(Rect::from_min_max(low, high), 1.0, PRESS_COLOR);
    };
    for (age, moment) in history.iter() {
        match (moment.is_pressed, start) {
            (true, None) => start = Some(age),
            (false, Some(from)) => {
                draw(from, age);
                start = None;
            }
            _ => {}
        }
    }
    if let Some(from) = start {
        draw(from, 0.0);
    }
}

fn x_at(age: f32, area: Rect) -> f32 {
    area.max.x - age / SECONDS * area.width()
}
