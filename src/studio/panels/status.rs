//! The status line: state, layout, and the latest notice.

use eframe::egui::{self, Color32};

use super::{PanelContext, PanelState};
use crate::pipeline::PipelineState;
use crate::studio::texts::text;

pub(super) fn show(ui: &mut egui::Ui, state: &mut PanelState, context: &mut PanelContext) {
    ui.add_space(3.0);
    ui.horizontal(|ui| {
        let model = context.model;
        let session = &model.view.state;
        let color = match session.state {
            PipelineState::Running => Color32::from_rgb(0x1f, 0x8f, 0x5f),
            PipelineState::Paused => Color32::from_rgb(0xb8, 0x6e, 0x00),
            PipelineState::Stalled => Color32::from_rgb(0xb3, 0x3a, 0x3a),
            _ => Color32::from_rgb(0x5a, 0x64, 0x76),
        };
        let name = egui::RichText::new(format!(" {} ", session.state));
        ui.label(name.color(Color32::WHITE).background_color(color));
        ui.label(&model.view.layout.name);
        ui.separator();
        let notice = model.view.messages.last();
        let message = match (&state.message, notice) {
            _ if model.has_ended => text("message-ended"),
            (Some(message), _) => message,
            (None, Some(notice)) => notice,
            (None, None) => "",
        };
        ui.add(egui::Label::new(message).truncate());
    });
    ui.add_space(3.0);
}
