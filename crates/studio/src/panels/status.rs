//! The status line: state, effect on other programs, layout, and the latest message.

use std::borrow::Cow;

use eframe::egui::{self, Color32};

use super::{PanelContext, PanelState, headset};
use crate::fingertip::MOUSE;
use crate::model::StudioModel;
use crate::notices;
use crate::texts::{text, text_with};
use crate::typing::Typing;
use ademan_core::message::escape;
use ademan_core::pipeline::PipelineState;
use ademan_runtime::setup::SIMULATED_HAND;

pub(super) fn show(ui: &mut egui::Ui, state: &mut PanelState, context: &mut PanelContext) {
    ui.add_space(3.0);
    ui.horizontal(|ui| {
        // A person of the lab who is watched types nothing.
        let model = context.session;
        let color = state_color(model.view.state.state);
        let name = egui::RichText::new(format!(" {} ", state_words(model)));
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

/// Returns the words of a source: its URI, or the words of a source of the program itself.
pub(super) fn source_words(source: &str) -> Cow<'_, str> {
    match source {
        SIMULATED_HAND => text("stats-source-simulated").into(),
        MOUSE => text("stats-source-mouse").into(),
        other => escape(other),
    }
}

/// Returns the words of the state of a session. Where readings arrive and none can be used, they name the most frequent reason.
pub(super) fn state_words(model: &StudioModel) -> String {
    let key = match model.view.state.state {
        PipelineState::Starting => "state-starting",
        PipelineState::Running => "state-running",
        PipelineState::Paused => "state-paused",
        PipelineState::Stalled => match model.latest_rejection() {
            Some(reason) => {
                return text_with("state-unusable", &[("reason", reason.to_string().into())]);
            }
            None => "state-stalled",
        },
        PipelineState::Stopped => "state-stopped",
    };
    text(key).to_owned()
}

/// Returns the colour behind the words of a state.
const fn state_color(state: PipelineState) -> Color32 {
    match state {
        PipelineState::Starting | PipelineState::Stopped => Color32::from_rgb(0x5a, 0x64, 0x76),
        PipelineState::Running => Color32::from_rgb(0x14, 0x75, 0x4b),
        PipelineState::Paused => Color32::from_rgb(0x96, 0x59, 0x00),
        PipelineState::Stalled => Color32::from_rgb(0xb3, 0x3a, 0x3a),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use ademan_core::estimate::Rejection;
    use ademan_core::layout::Layout;
    use ademan_runtime::files::Load;

    use super::*;
    use crate::model::tests::snapshot;
    use crate::scene::tests::model_of;

    #[test]
    fn a_session_whose_readings_are_all_rejected_names_the_most_frequent_reason() {
        let mut model = model_of(Arc::new(Layout::load("numpad").unwrap()));
        let mut view = model.view.clone();
        Arc::make_mut(&mut view.state).state = PipelineState::Stalled;
        model.set_view(view);
        let mut stalled = snapshot(PipelineState::Stalled);
        model.update(&stalled);
        assert_eq!(state_words(&model), text("state-stalled"));
        stalled.stats.rejected[Rejection::TooFast as usize] = 3;
        stalled.stats.rejected[Rejection::OutsideLimits as usize] = 1;
        model.update(&stalled);
        assert_eq!(state_words(&model), "No usable readings: too-fast");
    }

    #[test]
    fn a_session_that_receives_nothing_after_a_pose_has_no_readings() {
        let mut model = model_of(Arc::new(Layout::load("numpad").unwrap()));
        let mut view = model.view.clone();
        Arc::make_mut(&mut view.state).state = PipelineState::Stalled;
        model.set_view(view);
        let mut last = snapshot(PipelineState::Running);
        last.pose = Some(crate::model::tests::hand(1));
        last.stats.rejected[Rejection::TooFast as usize] = 3;
        model.update(&last);
        model.update(&ademan_core::snapshot::Snapshot {
            stats: last.stats,
            ..snapshot(PipelineState::Stalled)
        });
        assert_eq!(state_words(&model), text("state-stalled"));
    }
}
