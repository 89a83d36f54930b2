//! The problems of the text, and the lines around one of them.

use eframe::egui::{self, RichText};

use super::EditorPanel;
use crate::editor::Severity;
use crate::texts::text;

/// Lines that are shown before and after the line of a problem.
const CONTEXT_LINES: usize = 2;

pub(super) fn show(ui: &mut egui::Ui, panel: &mut EditorPanel) {
    ui.add_space(2.0);
    let mut problems = panel.problems_now().to_vec();
    if let Some(reach) = &panel.reach {
        problems.extend_from_slice(reach.warnings());
    }
    // The same area without problems, so that the board does not move when one comes.
    let area = egui::ScrollArea::vertical().auto_shrink(false);
    area.show(ui, |ui| {
        if problems.is_empty() {
            ui.weak(text("editor-no-problems"));
            panel.shown_line = None;
        }
        for problem in &problems {
            let color = match problem.severity {
                Severity::Error => ui.visuals().error_fg_color,
                Severity::Warning => ui.visuals().warn_fg_color,
            };
            let position = problem
                .line
                .map(|line| format!("{line}: "))
                .unwrap_or_default();
            let words = RichText::new(format!("{position}{}", problem.message)).color(color);
            let row = egui::Button::new(words).frame(false).wrap();
            if ui.add(row).clicked() {
                panel.shown_line = problem.line;
                if let Some(part) = problem.part {
                    panel.show_part(part);
                }
            }
        }
        if let Some(line) = panel.shown_line {
            show_lines(ui, panel.editor.text(), line);
        }
    });
}

/// Shows the lines around a line of the text, from 1.
fn show_lines(ui: &mut egui::Ui, text: &str, line: usize) {
    let first = line.saturating_sub(CONTEXT_LINES + 1);
    let lines = text.lines().enumerate().skip(first);
    for (index, content) in lines.take(2 * CONTEXT_LINES + 1) {
        let words = RichText::new(format!("{:>5}  {content}", index + 1)).monospace();
        if index + 1 == line {
            ui.label(words.strong())
        } else {
            ui.label(words.weak())
        };
    }
}
