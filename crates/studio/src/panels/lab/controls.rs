//! The conditions of a run, and its progress.

use eframe::egui::{self, ComboBox, DragValue, ProgressBar};

use super::super::editor::EditorPanel;
use super::{LabState, Other};
use crate::lab::LabDecoder;
use crate::texts::{text, text_with};
use ademan_lab::people::Tier;
use ademan_lab::phrases::PhraseSet;
use ademan_lab::sim::fluent::SourceKind;

/// Ranges of the numbers of people and phrases.
const PEOPLE: (u32, u32) = (1, 1000);
const PHRASES: (usize, usize) = (1, 100);

/// Width of a list, in points.
const LIST: f32 = 130.0;

pub(super) fn show(ui: &mut egui::Ui, state: &mut LabState, editor: &EditorPanel) {
    ui.add_space(6.0);
    ui.label(egui::RichText::new(text("lab-intro")).weak());
    ui.add_space(6.0);
    let is_running = state.run.is_some();
    ui.add_enabled_ui(!is_running, |ui| {
        egui::Grid::new("lab settings")
            .num_columns(2)
            .spacing([8.0, 6.0])
            .show(ui, |ui| show_settings(ui, state));
        ui.add_space(6.0);
        show_other(ui, state);
    });
    ui.add_space(8.0);
    show_run(ui, state, editor);
    if let Some(error) = &state.error {
        ui.add_space(6.0);
        ui.colored_label(ui.visuals().error_fg_color, error);
    }
}

fn show_settings(ui: &mut egui::Ui, state: &mut LabState) {
    let settings = &mut state.settings;
    let name = ui.label(text("lab-people"));
    let people = DragValue::new(&mut settings.people).range(PEOPLE.0..=PEOPLE.1);
    ui.add(people).labelled_by(name.id);
    ui.end_row();
    let phrases_name = ui.label(text("lab-phrases"));
    let phrases = DragValue::new(&mut settings.phrases).range(PHRASES.0..=PHRASES.1);
    ui.add(phrases).labelled_by(phrases_name.id);
    ui.end_row();
    let sets = PhraseSet::ALL.iter().map(|&it| (it, it.name()));
    show_list(ui, "lab-corpus", &mut settings.corpus, sets);
    let tiers = Tier::ALL.iter().map(|&it| (Some(it), it.name()));
    let own = std::iter::once((None, text("lab-own-errors")));
    show_list(ui, "lab-tier", &mut settings.tier, own.chain(tiers));
    let sources = SourceKind::ALL.iter().map(|&it| (it, it.name()));
    show_list(ui, "lab-source", &mut settings.source, sources);
    let decoders = LabDecoder::ALL.into_iter().map(|it| (it, it.name()));
    show_list(ui, "lab-decoder", &mut settings.decoder, decoders);
    let seed_name = ui.label(text("lab-seed"));
    ui.add(DragValue::new(&mut settings.seed))
        .labelled_by(seed_name.id);
    ui.end_row();
}

/// Shows a row with a list to choose from.
fn show_list<T: Copy + PartialEq>(
    ui: &mut egui::Ui,
    key: &'static str,
    value: &mut T,
    choices: impl Iterator<Item = (T, &'static str)>,
) {
    let choices: Vec<(T, &str)> = choices.collect();
    let name = ui.label(text(key));
    let chosen = choices.iter().find(|(choice, _)| choice == value);
    let chosen = chosen.map_or("", |(_, chosen_name)| chosen_name);
    let list = ComboBox::from_id_salt(key)
        .width(LIST)
        .selected_text(chosen);
    let shown = list.show_ui(ui, |ui| {
        for (choice, choice_name) in choices {
            ui.selectable_value(value, choice, choice_name);
        }
    });
    shown.response.labelled_by(name.id);
    ui.end_row();
}

fn show_other(ui: &mut egui::Ui, state: &mut LabState) {
    ui.label(text("lab-compare"));
    let choices = [
        (Other::Nothing, "lab-compare-nothing"),
        (Other::Saved, "lab-compare-saved"),
        (Other::File, "lab-compare-file"),
    ];
    for (other, key) in choices {
        ui.radio_value(&mut state.other, other, text(key));
    }
    let field = egui::TextEdit::singleline(&mut state.other_name)
        .hint_text("qwerty-arc")
        .desired_width(LIST + 60.0);
    let response = ui.add_enabled(state.other == Other::File, field);
    response.widget_info(|| {
        let mut info = egui::WidgetInfo::new(egui::Role::TextInput);
        info.label = Some(text("lab-compare-name").to_owned());
        info
    });
}

fn show_run(ui: &mut egui::Ui, state: &mut LabState, editor: &EditorPanel) {
    let Some(run) = &state.run else {
        let is_valid = editor.editor.is_valid();
        let is_named = state.other != Other::File || !state.other_name.trim().is_empty();
        let button = egui::Button::new(egui::RichText::new(text("lab-run")).strong());
        let response = ui.add_enabled(
            is_valid && is_named,
            button.min_size(egui::vec2(96.0, 28.0)),
        );
        let hint = match (is_valid, is_named) {
            (false, _) => "lab-run-invalid",
            (true, false) => "lab-run-unnamed",
            (true, true) => "lab-run-hint",
        };
        let response = response.on_hover_text(text(hint));
        if response.on_disabled_hover_text(text(hint)).clicked() {
            state.start(editor);
        }
        return;
    };
    let (done, all) = run.progress();
    let part = done as f32 / all.max(1) as f32;
    let values = [("done", done.into()), ("all", all.into())];
    ui.add(ProgressBar::new(part).text(text_with("lab-progress", &values)));
    let is_cancelled = run.is_cancelled();
    let cancel = egui::Button::new(text("lab-cancel"));
    if ui.add_enabled(!is_cancelled, cancel).clicked() {
        run.cancel();
    }
}
