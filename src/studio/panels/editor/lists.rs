//! The parts of the layout that are not on a board: layers, chords, triggers, pointer, spaces.

use eframe::egui;

use super::EditorPanel;
use crate::studio::editor::{Edit, NewPart, Part};
use crate::studio::texts::text;

/// A list of the layout: words, field, part, and what its button adds.
type List = (
    &'static str,
    &'static str,
    fn(usize) -> Part,
    Option<NewPart>,
);

pub(super) fn show(ui: &mut egui::Ui, panel: &mut EditorPanel) {
    ui.add_space(8.0);
    ui.separator();
    let lists: [List; 5] = [
        ("editor-boards", "boards", Part::Board, Some(NewPart::Board)),
        ("editor-layers", "layers", Part::Layer, Some(NewPart::Layer)),
        ("editor-chords", "chords", Part::Chord, None),
        (
            "editor-triggers",
            "triggers",
            Part::Trigger,
            Some(NewPart::Trigger),
        ),
        ("editor-spaces", "spaces", Part::Space, Some(NewPart::Space)),
    ];
    part_row(ui, panel, Part::Layout, text("editor-layout"));
    if panel.editor.range_of(Part::Pointer).is_some() {
        part_row(ui, panel, Part::Pointer, text("editor-pointer"));
    }
    for (words, list, part, new) in lists {
        let count = panel.editor.count(list);
        let title = format!("{} ({count})", text(words));
        egui::CollapsingHeader::new(title)
            .id_salt(list)
            .show(ui, |ui| {
                for index in 0..count {
                    let name = panel.editor.part_name(part(index));
                    let name = name.unwrap_or_else(|| (index + 1).to_string());
                    part_row(ui, panel, part(index), &name);
                }
                if let Some(new) = new
                    && ui.button(text("editor-add")).clicked()
                {
                    panel.apply(&Edit::Add(new));
                }
            });
    }
}

fn part_row(ui: &mut egui::Ui, panel: &mut EditorPanel, part: Part, name: &str) {
    let is_selected = panel.editor.selection() == [part];
    if ui.selectable_label(is_selected, name).clicked() {
        panel.show_part(part);
    }
}
