//! The status line: state, effect on other programs, layout, and the latest message.

use std::borrow::Cow;
use std::sync::Arc;

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

/// Time for which a message of the window is shown at least, in seconds.
const MESSAGE_SECONDS: f64 = 15.0;

/// A message of the window, the time since when it is shown, and the notices of the session before it.
pub(super) struct ShownMessage {
    message: String,
    since: f64,
    before: Arc<[String]>,
}

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
        let now = ui.input(|input| input.time);
        let message = latest(state, &model.view.messages, now);
        ui.add(egui::Label::new(&message).truncate())
            .on_hover_text(message);
    });
    ui.add_space(3.0);
}

/// Returns the latest message at a time in seconds. One of the window gives way to later notices of the session, but can be read before.
fn latest(state: &mut PanelState, said: &Arc<[String]>, now: f64) -> String {
    let known = state.shown_message.take();
    if let Some(message) = &state.message {
        let known = known.filter(|shown| shown.message == *message);
        let shown = known.unwrap_or_else(|| ShownMessage {
            message: message.clone(),
            since: now,
            before: Arc::clone(said),
        });
        let is_over = now - shown.since > MESSAGE_SECONDS && *shown.before != **said;
        if !is_over {
            state.shown_message = Some(shown);
            return format!("! {message}");
        }
        state.message = None;
    }
    let words = said.last().map(|notice| notices::translate(notice));
    words.map(Cow::into_owned).unwrap_or_default()
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

/// Returns the color behind the words of a state.
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
    use ademan_core::estimate::Rejection;
    use ademan_core::layout::Layout;
    use ademan_runtime::files::Load;

    use super::*;
    use crate::model::tests::snapshot;
    use crate::scene::tests::model_of;

    #[test]
    fn a_message_of_the_window_gives_way_to_a_later_notice_once_it_could_be_read() {
        let said = |notice: &str| -> Arc<[String]> { Arc::from([notice.to_owned()]) };
        let (early, late) = (said("early"), said("late"));
        let mut state = PanelState::default();
        assert_eq!(latest(&mut state, &early, 0.0), "early");
        state.message = Some("refused".to_owned());
        for (notices, now, shown) in [
            (&early, 1.0, "! refused"),
            (&late, 2.0, "! refused"),
            (&late, 30.0, "late"),
        ] {
            assert_eq!(latest(&mut state, notices, now), shown, "{now}");
        }
        state.message = Some("refused".to_owned());
        for now in [31.0, 99.0] {
            assert_eq!(latest(&mut state, &late, now), "! refused", "{now}");
        }
    }

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
