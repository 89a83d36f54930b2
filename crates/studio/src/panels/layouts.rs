//! The menu that opens another layout: one that was opened before, one that comes with the program, or a file.

use std::path::Path;

use eframe::egui::containers::menu::{MenuButton, MenuConfig};
use eframe::egui::{self, PopupCloseBehavior};

use super::{PanelState, file_field};
use crate::first_start::LAYOUTS;
use crate::recent::RecentFiles;
use crate::setup_change::SetupChange;
use crate::texts::{text, text_with};
use ademan_core::message::escape;

/// Width of the menu, in points.
const WIDTH: f32 = 320.0;

/// Height of the list of layouts that come with the program, in points.
const HEIGHT: f32 = 300.0;

/// Shows the menu. A choice becomes [`PanelState::next_setup`].
pub(super) fn show(ui: &mut egui::Ui, state: &mut PanelState) {
    let stays = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    let menu = MenuButton::new(text("menu-open")).config(stays);
    let (button, _) = menu.ui(ui, |ui| {
        ui.set_width(WIDTH);
        let chosen = choose_recent(ui, state)
            .or_else(|| {
                file_field::show(
                    ui,
                    WIDTH,
                    "layouts-file",
                    "layouts-button",
                    &mut state.layout_file,
                )
            })
            .or_else(|| show_shipped(ui));
        if let Some(layout) = chosen {
            state.next_setup = Some(SetupChange::Layout(layout));
            ui.close();
        }
    });
    button.on_hover_text(text("layouts-hint"));
}

/// Returns the file that was chosen. One that is no longer there is dropped with a message.
fn choose_recent(ui: &mut egui::Ui, state: &mut PanelState) -> Option<String> {
    let recent = &mut state.settings.recent_layouts;
    recent.iter().next()?;
    let chosen = show_recent(ui, recent, "");
    ui.separator();
    let file = chosen?;
    match drop_missing(recent, &file) {
        None => Some(file),
        Some(message) => {
            state.message = Some(message);
            None
        }
    }
}

/// Shows the files that were opened before and have a part of their path in common with a query. Returns the one that is clicked.
pub(super) fn show_recent(ui: &mut egui::Ui, recent: &RecentFiles, query: &str) -> Option<String> {
    let mut chosen = None;
    for (index, file) in recent.with_part(query).enumerate() {
        if index == 0 {
            ui.strong(text("layouts-recent"));
        }
        let name = Path::new(file).file_name().unwrap_or_default();
        let name = name.to_string_lossy();
        let button = ui.selectable_label(false, escape(&name).into_owned());
        if button.on_hover_text(escape(file).into_owned()).clicked() {
            chosen = Some(file.to_owned());
        }
    }
    chosen
}

/// Drops a file that is no longer there from the list. Returns the message about it.
pub(super) fn drop_missing(recent: &mut RecentFiles, file: &str) -> Option<String> {
    if Path::new(file).is_file() {
        return None;
    }
    recent.remove(file);
    let name = escape(file).into_owned();
    Some(text_with("layouts-missing", &[("file", name.into())]))
}

fn show_shipped(ui: &mut egui::Ui) -> Option<String> {
    ui.separator();
    ui.strong(text("layouts-shipped"));
    let mut chosen = None;
    let area = egui::ScrollArea::vertical().max_height(HEIGHT);
    area.show(ui, |ui| {
        for layout in LAYOUTS.iter() {
            let button = ui.selectable_label(false, layout.name.as_str());
            if button.on_hover_text(layout.description.as_str()).clicked() {
                chosen = Some(layout.name.clone());
            }
        }
    });
    chosen
}
