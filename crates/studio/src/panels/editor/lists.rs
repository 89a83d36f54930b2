//! The parts of the layout that are not on a board: layers, chords, triggers, pointer, spaces.

use eframe::egui;

use super::EditorPanel;
use crate::editor::{Binding, Edit, NewPart, Part, beside};
use crate::texts::text;

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
    let lists: [List; 6] = [
        (
            "editor-boards",
            "boards",
            Part::Board,
            Some(NewPart::Board { right_mm: 0.0 }),
        ),
        ("editor-layers", "layers", Part::Layer, Some(NewPart::Layer)),
        ("editor-chords", "chords", Part::Chord, None),
        (
            "editor-triggers",
            "triggers",
            Part::Trigger,
            Some(NewPart::Trigger),
        ),
        ("editor-spaces", "spaces", Part::Space, Some(NewPart::Space)),
        (
            "editor-sequences",
            "sequences",
            Part::Sequence,
            Some(NewPart::Sequence),
        ),
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
                    if list == "spaces" {
                        show_targets(ui, panel, index);
                    }
                }
                match (list, new) {
                    ("chords", _) => show_add_chord(ui, panel),
                    (_, Some(new)) if ui.button(text("editor-add")).clicked() => {
                        panel.add(new);
                    }
                    _ => {}
                }
            });
    }
}

impl EditorPanel {
    /// Adds a chord of the selected keys.
    pub(super) fn add_chord(&mut self) {
        let keys = self.editor.selected_keys();
        let binding = Binding::NoOp;
        self.apply(&Edit::Add(NewPart::Chord { keys, binding }));
    }
}

/// Shows a button that adds a chord of the selected keys.
fn show_add_chord(ui: &mut egui::Ui, panel: &mut EditorPanel) {
    let keys = panel.editor.selected_keys();
    let button = egui::Button::new(text("editor-add-chord"));
    let button = ui.add_enabled(keys.len() >= 2, button);
    let button = button.on_disabled_hover_text(text("editor-add-chord-hint"));
    if button.clicked() {
        panel.add_chord();
    }
}

/// Shows the targets of a space, and a button that adds one beside them.
fn show_targets(ui: &mut egui::Ui, panel: &mut EditorPanel, space: usize) {
    ui.indent(("targets", space), |ui| {
        let targets = panel.editor.targets_in(space);
        for (index, _) in targets.iter().enumerate() {
            let part = Part::SpaceTarget { space, index };
            let name = panel.editor.part_name(part);
            part_row(
                ui,
                panel,
                part,
                &name.unwrap_or_else(|| (index + 1).to_string()),
            );
        }
        if ui.button(text("editor-add-target")).clicked() {
            let at_mm = beside(&targets);
            panel.apply(&Edit::Add(NewPart::SpaceTarget { space, at_mm }));
        }
    });
}

fn part_row(ui: &mut egui::Ui, panel: &mut EditorPanel, part: Part, name: &str) {
    let is_selected = panel.editor.selection() == [part];
    if ui.selectable_label(is_selected, name).clicked() {
        panel.show_part(part);
    }
}
