//! The actions of the selected part: by search, or by pressing the key.

use eframe::egui;

use super::{EditorPanel, key_press, shortcuts};
use crate::canvas::choices::matching_keys;
use crate::editor::{Binding, Edit, FieldType, Part, Slot, fields_of};
use crate::texts::text;
use ademan_core::device::KeyAction;

/// The most results of a search that are shown.
const MAX_RESULTS: usize = 10;

/// The binding that is edited.
#[derive(Default)]
pub(in super::super) struct BindingState {
    /// Index of the action of the part.
    slot: usize,
    query: String,
    /// The part that the next key of the keyboard binds.
    captured: Option<Part>,
}

pub(super) fn show(ui: &mut egui::Ui, panel: &mut EditorPanel, part: Part) {
    let slots = slots(panel, part);
    if slots.is_empty() {
        panel.binding.captured = None;
        return;
    }
    panel.binding.slot = panel.binding.slot.min(slots.len() - 1);
    ui.add_space(6.0);
    ui.strong(text("editor-binding"));
    for (index, slot) in slots.iter().enumerate() {
        ui.horizontal(|ui| {
            let is_chosen = panel.binding.slot == index;
            let name = slot_name(panel, slot);
            if ui.selectable_label(is_chosen, name).clicked() {
                panel.binding.slot = index;
            }
            let current = current(panel, part, slot);
            ui.monospace(current.as_deref().unwrap_or("–"));
        });
    }
    let slot = &slots[panel.binding.slot];
    ui.horizontal(|ui| {
        let is_capturing = panel.binding.captured == Some(part);
        let words = if is_capturing {
            text("editor-pressing")
        } else {
            text("editor-press-key")
        };
        let press = ui.selectable_label(is_capturing, words);
        if press.on_hover_text(text("editor-press-key-hint")).clicked() {
            panel.binding.captured = (!is_capturing).then_some(part);
        }
        if ui.button(text("editor-unbind")).clicked() {
            bind(panel, part, slot, None);
        }
    });
    show_search(ui, panel, part, slot);
}

fn show_search(ui: &mut egui::Ui, panel: &mut EditorPanel, part: Part, slot: &Slot) {
    let label = ui.label(text("editor-search"));
    let field = egui::TextEdit::singleline(&mut panel.binding.query);
    let field = ui
        .add(field.desired_width(f32::INFINITY))
        .labelled_by(label.id);
    let choices = choices(panel, slot);
    let is_entered = field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
    let mut chosen = choices.first().filter(|_| is_entered).cloned();
    ui.horizontal_wrapped(|ui| {
        for choice in &choices {
            if ui.button(choice_name(choice)).clicked() {
                chosen = Some(choice.clone());
            }
        }
    });
    if let Some(binding) = chosen {
        panel.binding.query.clear();
        bind(panel, part, slot, Some(binding));
    }
}

/// Binds the selected part to the key that is pressed, while the editor waits for one. It waits no longer once the tab of the
/// editor is left, another part is selected, a field has the focus or a question is asked.
pub(in super::super) fn capture(ui: &mut egui::Ui, panel: &mut EditorPanel, is_shown: bool) {
    let Some(part) = panel.binding.captured else {
        return;
    };
    let is_selected = panel.editor.selection() == [part];
    if !is_shown || !is_selected || ui.ctx().text_edit_focused() || shortcuts::is_asked(ui) {
        panel.binding.captured = None;
        return;
    }
    let Some(code) = ui.input_mut(key_press::take_key) else {
        return;
    };
    panel.binding.captured = None;
    let slots = slots(panel, part);
    if let Some(slot) = slots.get(panel.binding.slot) {
        bind(
            panel,
            part,
            slot,
            Some(Binding::Key(code.name().to_owned())),
        );
    }
}

impl EditorPanel {
    /// Returns the selected part if the next key that is pressed can be bound to it.
    pub(super) fn bindable(&self) -> Option<Part> {
        match *self.editor.selection() {
            [Part::Sequence(_)] => None,
            [part] => (!slots(self, part).is_empty()).then_some(part),
            _ => None,
        }
    }

    /// Binds the selected part to the next key that is pressed.
    pub(super) fn begin_capture(&mut self) {
        self.binding.captured = self.bindable();
    }
}

fn bind(panel: &mut EditorPanel, part: Part, slot: &Slot, binding: Option<Binding>) {
    panel.apply(&Edit::Bind {
        part,
        slot: slot.clone(),
        binding,
    });
}

/// Returns the actions that a part can have.
fn slots(panel: &EditorPanel, part: Part) -> Vec<Slot> {
    if part.is_key() {
        let layers = (0..panel.editor.count("layers")).map(Slot::Layer);
        return [Slot::Base, Slot::Hold].into_iter().chain(layers).collect();
    }
    let fields = fields_of(part).into_iter();
    fields
        .filter(|field| field.field_type == FieldType::Action)
        .map(|field| Slot::Field(field.name.to_owned()))
        .collect()
}

fn slot_name(panel: &EditorPanel, slot: &Slot) -> String {
    match slot {
        Slot::Base => text("editor-slot-base").to_owned(),
        Slot::Hold => text("editor-slot-hold").to_owned(),
        Slot::Layer(layer) => {
            let name = panel.editor.part_name(Part::Layer(*layer));
            format!("{} {}", text("editor-slot-layer"), name.unwrap_or_default())
        }
        Slot::Field(field) => field.clone(),
    }
}

/// Returns the present action of a part, as written or as the last valid layout has it.
fn current(panel: &EditorPanel, part: Part, slot: &Slot) -> Option<String> {
    let editor = &panel.editor;
    let written = |field: &str| editor.own_value(part, field).map(str::to_owned);
    match slot {
        Slot::Base if matches!(part, Part::RowKey { .. }) => editor.part_name(part),
        Slot::Base => ["code", "layer", "action"].into_iter().find_map(written),
        Slot::Hold => written("hold"),
        Slot::Layer(layer) => {
            let index = panel.selected.single()?;
            let target = *panel.items.targets.get(index)?;
            let layout = editor.layout()?;
            let key = layout.key_at(target)?;
            match (*key.actions.get(layer + 1)?)? {
                KeyAction::Key(code) | KeyAction::Modifier(code, _) => Some(code.name().into()),
                _ => layout.label_in_layer(key, layer + 1).map(str::to_owned),
            }
        }
        Slot::Field(field) => written(field),
    }
}

/// Returns the actions that the search offers.
fn choices(panel: &EditorPanel, slot: &Slot) -> Vec<Binding> {
    let query = panel.binding.query.trim();
    if query.is_empty() {
        return Vec::new();
    }
    let keys = matching_keys(query).into_iter().take(MAX_RESULTS);
    let mut choices: Vec<_> = keys.map(|code| Binding::Key(code.name().into())).collect();
    let layers = (0..panel.editor.count("layers")).filter_map(|index| {
        let name = panel.editor.part_name(Part::Layer(index))?;
        let is_match = name.to_lowercase().contains(&query.to_lowercase());
        is_match.then_some(Binding::Layer(name))
    });
    choices.extend(layers);
    if matches!(slot, Slot::Hold) {
        return choices;
    }
    let sequences = (0..panel.editor.count("sequences")).filter_map(|index| {
        let name = panel.editor.part_name(Part::Sequence(index))?;
        let choice = Binding::Sequence(name);
        let words = choice_name(&choice).to_lowercase();
        words.contains(&query.to_lowercase()).then_some(choice)
    });
    choices.extend(sequences);
    let words = [
        ("clutch", Binding::Clutch),
        ("precision", Binding::Precision),
        ("noop", Binding::NoOp),
    ];
    let matching = words.into_iter().filter(|(word, binding)| {
        let can_have = *binding != Binding::NoOp || !matches!(slot, Slot::Layer(_));
        can_have && word.contains(&query.to_lowercase())
    });
    choices.extend(matching.map(|(_, binding)| binding));
    let command = query.parse::<ademan_core::command::Command>();
    if command.is_ok_and(|it| it.is_allowed_in_layouts()) {
        choices.push(Binding::Command(query.to_owned()));
    }
    choices.extend(Binding::multitap(query));
    choices.push(Binding::Text(query.to_owned()));
    choices
}

fn choice_name(choice: &Binding) -> String {
    match choice {
        Binding::Key(name) => name.clone(),
        Binding::Layer(name) => format!("{} {name}", text("editor-slot-layer")),
        Binding::Sequence(name) => format!("{} {name}", text("editor-new-sequence")),
        Binding::Text(words) => format!("“{words}”"),
        Binding::Multitap(letters) => format!("{} {letters}", text("editor-multitap")),
        Binding::Command(command) => format!("{} {command}", text("editor-command")),
        Binding::Clutch => text("editor-clutch").to_owned(),
        Binding::Precision => text("editor-precision").to_owned(),
        Binding::NoOp => text("editor-no-action").to_owned(),
    }
}
