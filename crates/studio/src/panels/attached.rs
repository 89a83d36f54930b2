//! The menu that says that the window shows the session of another program, and sends it commands.

use eframe::egui;

use super::PanelContext;
use super::status::source_words;
use crate::attached::Attached;
use crate::texts::{text, text_with};
use ademan_core::command::{Command, TextMode};
use ademan_core::message::{escape, escape_path};
use ademan_runtime::session::view::ViewState;

/// The modes of the text decoder, and the keys of their words.
const MODES: [(TextMode, &str); 3] = [
    (TextMode::Literal, "attached-literal"),
    (TextMode::Suggest, "attached-suggest"),
    (TextMode::Auto, "attached-auto"),
];

/// The longest name of a session that is shown in full, in characters: the toolbar has one row.
const MAX_NAME: usize = 24;

/// Returns the words of the button: the session, unless its program names none, and its profile.
fn name_of(state: &ViewState) -> String {
    let profile = escape(&state.profile);
    let mut name = escape(&state.name).into_owned();
    if name.chars().count() > MAX_NAME {
        name = name.chars().take(MAX_NAME - 1).chain(['…']).collect();
    }
    let session = if name.is_empty() {
        profile.into_owned()
    } else {
        format!("{name} · {profile}")
    };
    text_with("attached-name", &[("session", session.into())])
}

pub(super) fn show(ui: &mut egui::Ui, session: &Attached, context: &mut PanelContext) {
    let state = &context.session.view.state;
    let is_live = !context.session.has_ended;
    let menu = ui.menu_button(name_of(state), |ui| {
        if let Some(process) = state.process {
            let process = process.to_string();
            ui.label(text_with(
                "attached-process",
                &[("process", process.into())],
            ));
        }
        ui.label(source_words(&state.source));
        ui.label(escape_path(session.path()));
        ui.separator();
        let next = egui::Button::new(text("attached-next-profile"));
        if ui.add_enabled(is_live, next).clicked() {
            context.sent.push(Command::NextProfile);
            ui.close();
        }
        let Some(mode) = state.text_mode else {
            return;
        };
        ui.separator();
        ui.label(text("attached-text"));
        for (other, key) in MODES {
            let button = egui::RadioButton::new(mode == other, text(key));
            if ui.add_enabled(is_live, button).clicked() {
                context.sent.push(Command::Text { mode: other });
                ui.close();
            }
        }
    });
    menu.response.on_hover_text(text("attached-hint"));
}
