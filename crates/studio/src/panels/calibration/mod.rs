//! The guided calibration: start, poses, and result.

mod live;
mod picture;
mod pose;
mod result;

use eframe::egui::{self, Key, Modifiers, RichText};

use super::sensors::show_question;
use super::{PanelContext, editor, look};
use crate::guide::Guide;
use crate::pose_picture::PosePicture;
use crate::scene::SceneColors;
use crate::texts::{text, text_with};
use ademan_core::calibrate::CalibrationPose;
use ademan_core::command::Command;

/// Number of the simulated person of the demonstration.
const PERSON: u64 = 1;

/// Space around the content, in points.
const MARGIN: i8 = 20;

/// Width of lines of text, in points.
const TEXT_WIDTH: f32 = 640.0;

/// Size of the picture of the start page, in points.
const START_PICTURE: egui::Vec2 = egui::vec2(TEXT_WIDTH, 280.0);

/// Draws the guided calibration.
pub(super) fn show(ui: &mut egui::Ui, context: &mut PanelContext) {
    let colors = &look::scene_colors(ui.visuals());
    let frame = egui::Frame::NONE.inner_margin(MARGIN);
    frame.show(ui, |ui| match &context.sensors.guide {
        None => show_start(ui, colors, context),
        Some(guide) if guide.result().is_some() => result::show(ui, context),
        Some(_) => pose::show(ui, colors, context),
    });
}

/// Shows what a calibration is, one of its poses, and the buttons that start it.
fn show_start(ui: &mut egui::Ui, colors: &SceneColors, context: &mut PanelContext) {
    let sensors = &mut *context.sensors;
    let Some(editor) = &sensors.editor else {
        ui.label(text("calibration-none"));
        return;
    };
    let name = editor.glove().name.clone();
    let hand = PosePicture::new(CalibrationPose::Flat, editor.glove().side);
    let title = text_with("calibration-title", &[("glove", name.into())]);
    ui.heading(RichText::new(title).size(22.0));
    ui.add_space(8.0);
    ui.scope(|ui| {
        ui.set_max_width(TEXT_WIDTH);
        ui.label(RichText::new(text("calibration-intro")).size(15.0));
        ui.add_space(12.0);
        picture::show(
            ui,
            CalibrationPose::Flat,
            hand.as_ref(),
            (START_PICTURE, colors),
        );
        ui.add_space(12.0);
        ui.horizontal_wrapped(|ui| {
            let is_live = !context.session.has_ended && !context.has_hand;
            let selection = ui.visuals().selection;
            let label = RichText::new(text("calibration-start")).color(selection.stroke.color);
            let start = big_button(label).fill(selection.bg_fill);
            let is_started = ui.add_enabled(is_live, start).clicked();
            let fingers = egui::Button::new(text("calibration-fingers"));
            let fingers = ui.add_enabled(is_live, fingers);
            let hint = text("calibration-fingers-hint");
            let adds_fingers = fingers.on_hover_text(hint).clicked();
            if is_started || adds_fingers {
                sensors.start_calibration(|edited| {
                    let guide = Guide::new(edited);
                    if adds_fingers {
                        guide.with_single_fingers()
                    } else {
                        guide
                    }
                });
                sensors.note_pause(context.session.view.state.paused_by);
                context.sent.push(Command::Pause);
            }
            let demo = ui.button(text("calibration-demo"));
            if demo.on_hover_text(text("calibration-demo-hint")).clicked() {
                sensors.start_calibration(|edited| Guide::demonstration(edited, PERSON));
            }
        });
        if context.has_hand {
            ui.add_space(8.0);
            ui.label(RichText::new(text("calibration-simulated")).size(15.0));
        }
        ui.add_space(12.0);
        show_question(ui, sensors);
        for message in sensors.notice.iter().chain(&sensors.message) {
            ui.label(RichText::new(message).size(15.0));
        }
    });
}

fn big_button(name: impl Into<RichText>) -> egui::Button<'static> {
    egui::Button::new(name.into().size(16.0)).min_size(egui::vec2(120.0, 34.0))
}

/// Returns `true` if a button is clicked, or its key is pressed.
fn button(ui: &mut egui::Ui, name: &'static str, key: Key, hint: &str) -> bool {
    let is_free = !ui.ctx().text_edit_focused() && !editor::is_asked(ui);
    let is_pressed = is_free && ui.input_mut(|input| input.consume_key(Modifiers::NONE, key));
    let response = ui.add(big_button(name));
    let response = match hint {
        "" => response,
        hint => response.on_hover_text(hint),
    };
    response.clicked() || is_pressed
}

/// Ends the calibration without a result.
fn quit(context: &mut PanelContext) {
    resume(context);
    context.sensors.guide = None;
}

/// Ends the pause of a calibration with the source of the session. Another pause stays: the session of an output that was just chosen,
/// or of an emergency stop, types nothing until a person resumes it.
fn resume(context: &mut PanelContext) {
    let guide = context.sensors.guide.as_ref();
    let is_live = guide.is_some_and(|guide| !guide.is_demonstration());
    let paused_by = context.session.view.state.paused_by;
    if is_live && context.sensors.take_pause(paused_by) {
        context.sent.push(Command::Resume);
    }
}
