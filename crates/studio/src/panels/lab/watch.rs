//! The strip over the 3D view while a person of the lab is watched.

use eframe::egui::{self, RichText};

use super::super::{PanelContext, PanelState, Workspace};
use super::WatchChange;
use crate::playback::Move;
use crate::texts::{text, text_with};

pub(in super::super) fn show(
    ui: &mut egui::Ui,
    state: &mut PanelState,
    context: &mut PanelContext,
) {
    let (Some(watched), Some(player)) = (context.watched, context.player) else {
        return;
    };
    let score = &watched.score;
    ui.add_space(4.0);
    ui.horizontal_wrapped(|ui| {
        let values = [
            ("number", score.number.to_string().into()),
            ("hand", format!("{:.0}", score.hand_mm).into()),
            ("fingers", score.style.as_str().into()),
            ("failure", format!("{:.1}", 100.0 * score.cer()).into()),
        ];
        ui.strong(text_with("lab-person", &values));
        ui.label(RichText::new(text("lab-watch-note")).weak());
        if ui.button(text("lab-watch-back")).clicked() {
            *context.watch = Some(WatchChange::End);
            state.workspace = Workspace::Lab;
        }
        let next = watched.next_failure(player.time());
        let button = egui::Button::new(text("lab-watch-next"));
        let response = ui.add_enabled(next.is_some() && player.is_complete(), button);
        if let Some((failure, start)) = next {
            let meant = failure
                .meant
                .as_deref()
                .unwrap_or(text("lab-watch-unmeant"));
            let pressed = if failure.pressed.is_empty() {
                text("lab-watch-nothing").to_owned()
            } else {
                failure.pressed.join(", ")
            };
            let failure_values = [("meant", meant.into()), ("pressed", pressed.into())];
            let words = text_with("lab-watch-failure", &failure_values);
            if response.on_hover_text(&words).clicked() {
                context.moves.extend([Move::Time(start), Move::Play]);
            }
            ui.label(words);
        }
    });
    egui::Grid::new("lab watch").num_columns(2).show(ui, |ui| {
        ui.label(text("lab-watch-presented"));
        ui.monospace(&watched.presented);
        ui.end_row();
        ui.label(text("lab-watch-typed"));
        ui.monospace(watched.typed_at(player.time()));
        ui.end_row();
    });
    ui.add_space(4.0);
}
