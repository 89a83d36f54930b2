//! The position in a recording: slider, keys and speed; a part to export; and two layouts compared.

mod comparison;
mod part;

use std::path::{Path, PathBuf};

use eframe::egui::{self, Key, Modifiers};

use self::comparison::ComparisonState;
use self::part::PartState;
use super::{PanelContext, PanelState, editor, look};
use crate::playback::{Move, Player, SPEEDS};
use crate::texts::{text, text_with};

/// State of the panel between two frames.
#[derive(Default)]
pub struct RecordingState {
    /// The recording whose part and comparison these are.
    path: PathBuf,
    part: PartState,
    comparison: ComparisonState,
}

impl RecordingState {
    /// Starts again if the recording is another one, such as the next person of the lab.
    fn follow(&mut self, path: &Path) {
        if self.path != path {
            *self = Self {
                path: path.to_owned(),
                ..Self::default()
            };
        }
    }
}

/// Draws the bar of a recording. `has_focus` tells whether its panel has the focus.
pub(super) fn show(
    ui: &mut egui::Ui,
    state: &mut PanelState,
    context: &mut PanelContext,
    has_focus: bool,
) {
    let Some(player) = context.player else {
        return;
    };
    let (state, moves) = (&mut state.recording, &mut *context.moves);
    state.follow(&player.recording().path);
    ui.add_space(4.0);
    ui.horizontal(|ui| show_transport(ui, player, moves));
    show_position(ui, player, state.part.marks(player), moves);
    ui.horizontal_wrapped(|ui| {
        part::show(ui, &mut state.part, player);
        ui.separator();
        comparison::show_controls(ui, &mut state.comparison, player);
    });
    if let Some(reason) = player.problem() {
        let message = text_with("recording-cut", &[("reason", reason.into())]);
        ui.colored_label(ui.visuals().warn_fg_color, message);
    }
    comparison::show(ui, &mut state.comparison, player, moves);
    ui.add_space(4.0);
    if has_focus {
        look::keep_arrow_keys(ui);
    }
    // Keys belong to a field or button that has the focus, or to a question.
    let is_free = has_focus || ui.memory(|memory| memory.focused().is_none());
    if is_free && !editor::is_asked(ui) {
        moves.extend(pressed_keys(ui, player));
    }
}

/// Returns the moves of the keys that were pressed.
fn pressed_keys(ui: &egui::Ui, player: &Player) -> Option<Move> {
    let toggle = if player.is_playing() {
        Move::Pause
    } else {
        Move::Play
    };
    let keys = [
        (Modifiers::SHIFT, Key::ArrowLeft, Move::BySeconds(-1.0)),
        (Modifiers::SHIFT, Key::ArrowRight, Move::BySeconds(1.0)),
        (Modifiers::NONE, Key::ArrowLeft, Move::By(-1)),
        (Modifiers::NONE, Key::ArrowRight, Move::By(1)),
        (Modifiers::NONE, Key::Home, Move::Step(0)),
        (Modifiers::NONE, Key::End, Move::Step(usize::MAX)),
        (Modifiers::NONE, Key::Space, toggle),
    ];
    let pressed = |(modifiers, key, _): &(Modifiers, Key, Move)| {
        ui.input_mut(|input| input.consume_key(*modifiers, *key))
    };
    keys.into_iter().find(pressed).map(|(_, _, change)| change)
}

fn show_transport(ui: &mut egui::Ui, player: &Player, moves: &mut Vec<Move>) {
    let toggle = if player.is_playing() {
        ("recording-pause", Move::Pause)
    } else {
        ("recording-play", Move::Play)
    };
    // Signs that the fonts of the window have.
    let buttons = [
        ("|<", "recording-first", Move::Step(0)),
        ("<", "recording-back", Move::By(-1)),
        (text(toggle.0), toggle.0, toggle.1),
        (">", "recording-on", Move::By(1)),
        (">|", "recording-last", Move::Step(usize::MAX)),
    ];
    for (sign, name, change) in buttons {
        let button = ui.add_enabled(!player.is_empty(), egui::Button::new(sign));
        button.widget_info(|| {
            egui::WidgetInfo::labeled(egui::Role::Button, !player.is_empty(), text(name))
        });
        if button.on_hover_text(text(name)).clicked() {
            moves.push(change);
        }
    }
    let speed = player.speed();
    let chosen = egui::ComboBox::from_id_salt("speed").width(60.0);
    let shown = chosen.selected_text(format!("{speed}×")).show_ui(ui, |ui| {
        for value in SPEEDS {
            let is_chosen = value == speed;
            if ui
                .selectable_label(is_chosen, format!("{value}×"))
                .clicked()
            {
                moves.push(Move::Speed(value));
            }
        }
    });
    let name = text("recording-speed");
    shown.response.accessible_name(name).on_hover_text(name);
    show_time(ui, player);
    let hint = egui::RichText::new(text("recording-hint")).weak().small();
    ui.add(egui::Label::new(hint).truncate());
}

fn show_time(ui: &mut egui::Ui, player: &Player) {
    let Some((start, end)) = player.range() else {
        return;
    };
    let seconds = player.time().since(start).as_secs_f64();
    let length = end.since(start).as_secs_f64();
    ui.monospace(format!("{seconds:8.3} s / {length:.1} s"));
    let count = player.len();
    let (index, total) = (player.position() + 1, count);
    let values = [
        ("index", index.to_string().into()),
        ("count", total.to_string().into()),
    ];
    ui.label(text_with("recording-step", &values));
    if !player.is_complete() || !player.is_shown() {
        ui.spinner();
        let count_value = [("count", count.to_string().into())];
        ui.label(text_with("recording-loading", &count_value));
    }
}

/// Shows a slider over all steps, with the marks of the part.
fn show_position(
    ui: &mut egui::Ui,
    player: &Player,
    marks: Option<(f64, f64)>,
    moves: &mut Vec<Move>,
) {
    let mut index = player.position();
    let last = player.len().saturating_sub(1);
    ui.spacing_mut().slider_width = ui.available_width() - 8.0;
    let slider = egui::Slider::new(&mut index, 0..=last).show_value(false);
    let response = ui.add_enabled(last > 0, slider);
    let name = text("recording-position");
    response.widget_info(|| egui::WidgetInfo::slider(last > 0, index as f64, name));
    if let Some((from, to)) = marks {
        let area = response.rect.shrink2([8.0, 0.0].into());
        let x = |fraction: f64| area.min.x + fraction as f32 * area.width();
        let part = egui::Rect::from_x_y_ranges(x(from)..=x(to), area.max.y - 3.0..=area.max.y);
        let color = ui.visuals().selection.bg_fill;
        ui.painter().rect_filled(part, 1.0, color);
    }
    if response.changed() {
        moves.push(Move::Step(index));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_recording_has_no_part_and_no_comparison_yet() {
        let mut state = RecordingState::default();
        let [one, other] = ["one.mcap", "other.mcap"].map(Path::new);
        state.follow(one);
        state.comparison.layout = "dvorak-flat".to_owned();
        state.follow(one);
        assert_eq!(state.comparison.layout, "dvorak-flat");
        state.follow(other);
        assert_eq!(state.comparison.layout, "");
    }
}
