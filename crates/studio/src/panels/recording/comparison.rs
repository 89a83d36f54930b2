//! The presses of two layouts over the time of a recording.

use std::sync::Arc;

use eframe::egui::{self, Align2, Color32, FontId, Pos2, Rangef, Rect, Sense};

use crate::playback::{Comparison, Job, Match, Move, Player, Recording, compare};
use crate::texts::{text, text_with};
use ademan_core::time::Timestamp;

/// Height of the presses of one layout, in points.
const ROW: f32 = 20.0;

/// Width of the names of the layouts, in points.
const NAME_WIDTH: f32 = 130.0;

const SAME: Color32 = Color32::from_rgb(0x3f, 0x9e, 0x5b);
const ONLY_A: Color32 = Color32::from_rgb(0xd1, 0x7a, 0x22);
const ONLY_B: Color32 = Color32::from_rgb(0xa4, 0x5b, 0xb8);

/// A comparison with a layout.
#[derive(Default)]
pub struct ComparisonState {
    /// Name or path of layout B.
    pub(super) layout: String,
    job: Option<Job<Result<Compared, String>>>,
    result: Option<Result<Compared, String>>,
}

/// The presses, and the names of the layouts.
struct Compared {
    names: [String; 2],
    presses: Comparison,
}

impl ComparisonState {
    fn start(&mut self, player: &Player) {
        let a = Arc::clone(player.recording());
        let layout = self.layout.trim().to_owned();
        self.result = None;
        self.job = Some(Job::start(move || {
            let b = Recording::open(&a.path, Some(&layout)).map_err(|error| error.to_string())?;
            let names = [&*a, &b].map(|recording| recording.setup.layout.name.clone());
            Ok(Compared {
                names,
                presses: compare(&a.presses()?, &b.presses()?),
            })
        }));
    }
}

pub(super) fn show_controls(ui: &mut egui::Ui, state: &mut ComparisonState, player: &Player) {
    if let Some(result) = state.job.as_ref().and_then(Job::poll) {
        let compared = result.unwrap_or_else(|lost| Err(lost.to_string()));
        (state.job, state.result) = (None, Some(compared));
    }
    let label = ui.label(text("recording-compare"));
    let field = egui::TextEdit::singleline(&mut state.layout)
        .hint_text("dvorak-flat")
        .desired_width(120.0);
    let is_entered = ui.add(field).labelled_by(label.id).lost_focus()
        && ui.input(|input| input.key_pressed(egui::Key::Enter));
    let can_start = state.job.is_none() && !state.layout.trim().is_empty();
    let button = egui::Button::new(text("recording-compare-go"));
    let is_clicked = ui.add_enabled(can_start, button).clicked();
    if can_start && (is_clicked || is_entered) {
        state.start(player);
    }
    if state.job.is_some() {
        ui.label(text("recording-comparing"));
    }
    if state.result.is_some() && ui.button(text("recording-compare-close")).clicked() {
        state.result = None;
    }
}

pub(super) fn show(
    ui: &mut egui::Ui,
    state: &mut ComparisonState,
    player: &Player,
    moves: &mut Vec<Move>,
) {
    match &state.result {
        None => {}
        Some(Err(message)) => _ = ui.colored_label(ui.visuals().error_fg_color, message),
        Some(Ok(compared)) => {
            show_counts(ui, &compared.presses);
            show_rows(ui, compared, player, moves);
        }
    }
}

fn show_counts(ui: &mut egui::Ui, presses: &Comparison) {
    let keys = ["recording-same", "recording-only-a", "recording-only-b"];
    let [same, only_a, only_b] = presses.counts();
    ui.horizontal(|ui| {
        for ((key, count), color) in keys.into_iter().zip([same, only_a, only_b]).zip(COLORS) {
            let values = [("count", count.to_string().into())];
            ui.colored_label(color, text_with(key, &values));
        }
    });
}

/// Colors of the counts: same, only A, only B.
const COLORS: [Color32; 3] = [SAME, ONLY_A, ONLY_B];

fn show_rows(ui: &mut egui::Ui, compared: &Compared, player: &Player, moves: &mut Vec<Move>) {
    let Some((start, end)) = player.range() else {
        return;
    };
    let size = egui::vec2(ui.available_width(), 2.0 * ROW + 2.0);
    let (area, response) = ui.allocate_exact_size(size, Sense::click());
    let name = text("recording-rows");
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, name));
    let axis = Axis {
        area: area.with_min_x(area.min.x + NAME_WIDTH),
        start,
        length: end.since(start).as_secs_f64().max(1e-3),
    };
    let painter = ui.painter_at(area);
    painter.rect_filled(axis.area, 3.0, ui.visuals().extreme_bg_color);
    let rows = [
        ("A", &compared.presses.a, ONLY_A),
        ("B", &compared.presses.b, ONLY_B),
    ];
    for (index, (letter, presses, color)) in rows.into_iter().enumerate() {
        let top = area.min.y + index as f32 * (ROW + 2.0);
        let row = Rangef::new(top, top + ROW);
        let row_name = format!("{letter}  {}", compared.names[index]);
        let at = Pos2::new(area.min.x, row.center());
        let font = FontId::proportional(11.0);
        painter.text(
            at,
            Align2::LEFT_CENTER,
            row_name,
            font,
            ui.visuals().text_color(),
        );
        axis.draw_presses(&painter, row, presses, color);
    }
    let x = axis.x_at(player.time());
    let stroke = egui::Stroke::new(1.0, ui.visuals().text_color());
    painter.vline(x, area.y_range(), stroke);
    if response.clicked()
        && let Some(pointer) = response.interact_pointer_pos()
    {
        moves.push(Move::Time(axis.time_at(pointer.x)));
    }
}

/// The time axis of both rows.
struct Axis {
    area: Rect,
    start: Timestamp,
    /// Seconds.
    length: f64,
}

impl Axis {
    fn x_at(&self, time: Timestamp) -> f32 {
        let fraction = time.since(self.start).as_secs_f64() / self.length;
        self.area.min.x + fraction as f32 * self.area.width()
    }

    fn time_at(&self, x: f32) -> Timestamp {
        let fraction = f64::from((x - self.area.min.x) / self.area.width()).clamp(0.0, 1.0);
        Timestamp::from_seconds(self.start.seconds() + fraction * self.length)
    }

    /// Draws presses as bars, with their keys where there is room.
    fn draw_presses(
        &self,
        painter: &egui::Painter,
        row: Rangef,
        presses: &[Match],
        color: Color32,
    ) {
        let mut free_from = self.area.min.x;
        let mut drawn_to = f32::MIN;
        for Match { press, is_same } in presses {
            let left = self.x_at(press.from);
            let right = self.x_at(press.to).max(left + 2.0);
            let color = if *is_same { SAME } else { color };
            // Presses within half a point of one that differs would hide it.
            if *is_same && right < drawn_to + 0.5 {
                continue;
            }
            drawn_to = right;
            let bar = Rangef::new(row.max - 7.0, row.max - 1.0);
            let bar = Rect::from_x_y_ranges(Rangef::new(left, right), bar);
            painter.rect_filled(bar, 1.0, color);
            if left >= free_from {
                let at = Pos2::new(left, row.min);
                let font = FontId::proportional(10.0);
                let name = press.key.to_string();
                let text = painter.text(at, Align2::LEFT_TOP, name, font, color);
                free_from = text.max.x + 3.0;
            }
        }
    }
}
