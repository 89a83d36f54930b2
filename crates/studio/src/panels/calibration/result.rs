//! The result of a calibration: score, problems, and the angles before and after.

use eframe::egui::{self, Key, RichText};

use super::{big_button, button, quit, resume};
use crate::guide::{Guide, GuideResult, JointChange};
use crate::joint_names::{finger_name, joint_name};
use crate::panels::PanelContext;
use crate::texts::{text, text_with};
use ademan_core::calibrate::{
    CalibrationError, Problem, Severity, other_glove_advice, problem_messages,
};
use ademan_core::hand::Dof;
use ademan_core::message::escape_path;

/// Height of the row of buttons, in points.
const BUTTONS_HEIGHT: f32 = 56.0;

pub(super) fn show(ui: &mut egui::Ui, context: &mut PanelContext) {
    let Some(result) = context.sensors.guide.as_ref().and_then(Guide::result) else {
        return;
    };
    // The result of a demonstration fits no glove of this person.
    let is_live = |guide: &Guide| !guide.is_demonstration();
    let is_usable = result.is_ok() && context.sensors.guide.as_ref().is_some_and(is_live);
    let height = (ui.available_height() - BUTTONS_HEIGHT).max(100.0);
    let area = egui::ScrollArea::vertical().max_height(height);
    area.auto_shrink(false).show(ui, |ui| match result {
        Ok(result) => show_result(ui, result),
        Err(error) => {
            ui.heading(RichText::new(text("calibration-failed")).size(22.0));
            ui.add_space(8.0);
            for line in reasons(error) {
                ui.label(RichText::new(format!("× {line}")).size(15.0));
            }
        }
    });
    ui.add_space(8.0);
    ui.horizontal(|ui| show_buttons(ui, context, is_usable));
}

fn show_result(ui: &mut egui::Ui, result: &GuideResult) {
    let score = text_with("calibration-score", &[("score", result.fit.score.into())]);
    ui.heading(RichText::new(score).size(22.0));
    ui.add_space(6.0);
    show_moved(ui, result);
    let is_sound = result.moved.is_empty() && !result.is_uncompared;
    if result.fit.problems.is_empty() && is_sound {
        ui.label(format!("√ {}", text("calibration-no-problem")));
    }
    for (problem, message) in problem_messages(&result.fit.problems) {
        ui.label(format!("{} {}", sign(problem), words(&message)));
    }
    ui.add_space(10.0);
    let grid = egui::Grid::new("changes").num_columns(3).striped(true);
    grid.spacing([28.0, 3.0]).show(ui, |ui| {
        for key in ["channel-joint", "calibration-before", "calibration-after"] {
            ui.strong(text(key));
        }
        ui.end_row();
        for JointChange { dof, before, after } in &result.changes {
            ui.label(joint_name(*dof));
            for [low, high] in [before, after] {
                ui.monospace(format!(
                    "{:>4.0}° … {:>4.0}°",
                    low.round() + 0.0,
                    high.round() + 0.0
                ));
            }
            ui.end_row();
        }
    });
}

/// Shows the sensors that follow another finger than in the glove file, and what became of them, or that they were not compared.
fn show_moved(ui: &mut egui::Ui, result: &GuideResult) {
    for sensor in &result.moved {
        let followed = sensor.followed.map_or("", finger_name);
        let words = text_with(
            "calibration-moved",
            &[
                ("channel", sensor.channel.to_string().into()),
                ("followed", followed.into()),
                ("stated", finger_name(sensor.stated).into()),
            ],
        );
        ui.label(format!("▲ {words}"));
    }
    if result.is_matched {
        ui.label(format!("√ {}", text("calibration-matched")));
    } else if !result.moved.is_empty() {
        ui.label(format!("× {}", text("calibration-unmatched")));
    }
    if result.is_uncompared {
        ui.label(format!("▲ {}", text("calibration-uncompared")));
    }
}

/// Returns the reasons of an error, one for each line.
fn reasons(error: &CalibrationError) -> Vec<String> {
    match error {
        CalibrationError::Unusable { problems } => {
            let messages = problem_messages(problems);
            let mut lines: Vec<String> =
                messages.iter().map(|(_, message)| words(message)).collect();
            lines.extend(other_glove_advice(problems).map(str::to_owned));
            lines
        }
        error => vec![error.to_string()],
    }
}

/// Returns the message of a problem with the names of joints for a person.
fn words(message: &str) -> String {
    Dof::ALL.iter().fold(message.to_owned(), |words, dof| {
        words.replace(&dof.to_string(), &joint_name(*dof))
    })
}

fn sign(problem: &Problem) -> char {
    match problem.severity() {
        Severity::Corrected => '√',
        Severity::Inexact => '▲',
        Severity::Unusable => '×',
    }
}

fn show_buttons(ui: &mut egui::Ui, context: &mut PanelContext, is_usable: bool) {
    let file = context.sensors.file().map(escape_path);
    let hint = text_with(
        "calibration-use-hint",
        &[("file", file.unwrap_or_default().into())],
    );
    let save = ui.add_enabled(is_usable, big_button(text("calibration-use")));
    let is_saved = save.on_hover_text(hint).clicked();
    let only_use = ui.add_enabled(is_usable, big_button(text("calibration-try")));
    if is_saved || only_use.clicked() {
        resume(context);
        context.sensors.adopt_result();
        if is_saved {
            context.sensors.save(false);
        }
        return;
    }
    let Some(guide) = &mut context.sensors.guide else {
        return;
    };
    if button(ui, text("calibration-repeat"), Key::R, "") {
        guide.repeat();
    }
    if button(ui, text("calibration-quit"), Key::Q, "") {
        quit(context);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_finger_with_dead_sensors_has_a_line_with_the_name_of_a_joint() {
        let dead = |channel, dof| Problem::DeadChannel {
            channel,
            dof,
            count: 512.0,
        };
        let problems = vec![
            dead(8, Dof::RingPipFlexion),
            dead(9, Dof::RingDipFlexion),
            dead(12, Dof::LittlePipFlexion),
        ];
        let lines = reasons(&CalibrationError::Unusable { problems });
        let reason = "stays at 512 in every pose: the sensor is dead; check its wires";
        let expected = [
            format!("channel 8 (Ring, middle joint) {reason} (also channel 9)"),
            format!("channel 12 (Little, middle joint) {reason}"),
        ];
        assert_eq!(lines, expected);
    }

    #[test]
    fn a_glove_without_counts_in_many_parts_is_to_be_discovered() {
        let dead = |dof| Problem::DeadChannel {
            channel: 1,
            dof,
            count: 0.0,
        };
        let dofs = [Dof::IndexPipFlexion, Dof::RingPipFlexion, Dof::ElbowFlexion];
        let problems = dofs.map(dead).into();
        let lines = reasons(&CalibrationError::Unusable { problems });
        assert_eq!(lines.len(), 4);
        assert!(
            lines[3].contains("`ademan calibrate --discover`"),
            "{lines:?}"
        );
    }
}
