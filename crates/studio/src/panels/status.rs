//! The status line: state, effect on other programs, layout, and the latest message.

use eframe::egui::{self, Color32};

use super::{PanelContext, PanelState, headset};
use crate::notices;
use crate::texts::text;
use crate::typing::Typing;
use ademan_core::pipeline::PipelineState;

pub(super) fn show(ui: &mut egui::Ui, state: &mut PanelState, context: &mut PanelContext) {
    ui.add_space(3.0);
    ui.horizontal(|ui| {
        // A person of the lab who is watched types nothing.
        let model = context.session;
        let (key, color) = state_look(model.view.state.state);
        let name = egui::RichText::new(format!(" {} ", text(key)));
        ui.label(name.color(Color32::WHITE).background_color(color));
        let typing = Typing::new(model);
        let words = egui::RichText::new(typing.words());
        ui.label(match typing {
            Typing::Into(_) => words.strong(),
            _ => words,
        });
        ui.separator();
        ui.label(&model.view.layout.name);
        ui.separator();
        headset::show_status(ui, state, context);
        let message = match (&state.message, model.view.messages.last()) {
            (Some(error), _) => format!("! {error}"),
            (None, Some(notice)) => notices::translate(notice).to_owned(),
            (None, None) => String::new(),
        };
        ui.add(egui::Label::new(&message).truncate())
            .on_hover_text(message);
    });
    ui.add_space(3.0);
}

/// Returns the word of a state and the colour behind it.
pub(super) fn state_look(state: PipelineState) -> (&'static str, Color32) {
    match state {
        PipelineState::Starting => ("state-starting", Color32::from_rgb(0x5a, 0x64, 0x76)),
        PipelineState::Running => ("state-running", Color32::from_rgb(0x14, 0x75, 0x4b)),
        PipelineState::Paused => ("state-paused", Color32::from_rgb(0x96, 0x59, 0x00)),
        PipelineState::Stalled => ("state-stalled", Color32::from_rgb(0xb3, 0x3a, 0x3a)),
        PipelineState::Stopped => ("state-stopped", Color32::from_rgb(0x5a, 0x64, 0x76)),
    }
}
