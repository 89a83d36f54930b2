//! A part of the setup that is a shipped name or a file.

use std::path::Path;

use eframe::egui::{self, Role, WidgetInfo};

use super::file_field;
use crate::texts::text;
use ademan_core::message::escape;

/// Width of the list of names, in points.
const LIST_WIDTH: f32 = 190.0;

/// A list of names, and a field for a file. All words are keys of texts.
pub(super) struct Choice<'a> {
    pub name: &'static str,
    /// The present choice.
    pub present: Option<&'a str>,
    /// The words for none.
    pub default: &'static str,
    /// The names to choose from.
    pub names: Vec<&'a str>,
    pub file: &'static str,
}

impl Choice<'_> {
    /// Shows a row of a grid with the list and the field. Returns what was chosen; the inner `None` is the default.
    pub fn show(self, ui: &mut egui::Ui, file: &mut String) -> Option<Option<String>> {
        let label = ui.strong(text(self.name));
        let mut chosen = None;
        let row = ui.horizontal(|ui| {
            let shown = self.present.map_or(text(self.default).to_owned(), short);
            let list = egui::ComboBox::from_id_salt(self.name)
                .selected_text(shown.as_str())
                .width(LIST_WIDTH)
                .truncate();
            let list = list.show_ui(ui, |ui| chosen = self.show_names(ui));
            let name = format!("{}: {shown}", text(self.name));
            list.response
                .widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, &name));
            file_field::show_beside(ui, &label, (self.file, "devices-use"), file)
        });
        ui.end_row();
        row.inner.map(Some).or(chosen)
    }

    fn show_names(&self, ui: &mut egui::Ui) -> Option<Option<String>> {
        let mut chosen = None;
        let is_default = self.present.is_none();
        if ui
            .selectable_label(is_default, text(self.default))
            .clicked()
        {
            chosen = Some(None);
        }
        for &name in &self.names {
            let is_present = self.present == Some(name);
            if ui.selectable_label(is_present, escape(name)).clicked() {
                chosen = Some(Some(name.to_owned()));
            }
        }
        chosen
    }
}

/// Returns a shipped name, or the name of a file without its folder.
fn short(name: &str) -> String {
    let file = Path::new(name).file_name();
    let file = file.map_or(name.into(), |file| file.to_string_lossy());
    escape(&file).into_owned()
}
