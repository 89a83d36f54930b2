//! The window with the link for a headset, and the consent to its keys.

use eframe::egui::{self, Align2, Color32, Rect, Sense, Vec2, WidgetInfo};

use super::{PanelContext, PanelState, help};
use crate::headset::{HeadsetWindow, QrModules};
use crate::texts::{text, text_with};
use ademan_core::command::Command;
use ademan_runtime::capture::HeadsetStatus;

/// Size of a module in points.
const MODULE: f32 = 5.0;

/// Light modules around a code, without which cameras do not find it.
const QUIET_ZONE: usize = 4;

/// Width of the words in points.
const WORDS_WIDTH: f32 = 270.0;

/// Place of the window when it opens, from the upper left corner in points: below a toolbar of two rows.
const OFFSET: Vec2 = Vec2::new(12.0, 80.0);

/// Draws the state of the headset in the status line, if the source waits for headsets, and the button of the window.
pub(super) fn show_status(ui: &mut egui::Ui, state: &mut PanelState, context: &PanelContext) {
    let Some(status) = &context.session.view.state.headset else {
        return;
    };
    match &mut state.headset {
        Some(window) => {
            let hint = text("headset-hint");
            let button = egui::Button::selectable(window.is_open, words(status));
            if ui.add(button).on_hover_text(hint).clicked() {
                window.is_open = !window.is_open;
            }
        }
        None => _ = ui.label(words(status)),
    }
    ui.separator();
}

fn words(status: &HeadsetStatus) -> String {
    let Some(headset) = &status.connected else {
        return text("headset-none").to_owned();
    };
    let address = headset.address.to_string();
    let values = [
        ("name", headset.name.as_str().into()),
        ("address", address.into()),
    ];
    text_with("headset-connected", &values)
}

/// Draws the window while it is open.
pub(super) fn show(ui: &egui::Ui, state: &mut PanelState, context: &mut PanelContext) {
    let Some(window) = &mut state.headset else {
        return;
    };
    let status = context.session.view.state.headset.clone();
    let status = status.unwrap_or_default();
    window.update(&status);
    if window.is_open && help::is_escape_pressed(ui) {
        window.is_open = false;
    }
    let mut is_open = window.is_open && !context.session.has_ended;
    egui::Window::new(text("headset-title"))
        .id(egui::Id::unique("headset"))
        .open(&mut is_open)
        .pivot(Align2::LEFT_TOP)
        .default_pos((ui.ctx().content_rect().min + OFFSET).round())
        .collapsible(false)
        .resizable(false)
        .show(ui.ctx(), |ui| {
            ui.horizontal_top(|ui| {
                if let Some(code) = window.link.code.as_ref().filter(|_| window.shows_link) {
                    show_code(ui, code);
                }
                ui.vertical(|ui| {
                    ui.set_width(WORDS_WIDTH);
                    ui.strong(words(&status));
                    ui.add_space(6.0);
                    show_link(ui, window);
                    ui.add_space(10.0);
                    show_consent(ui, "headset-keys", context.sent);
                });
            });
        });
    window.is_open = is_open;
}

fn show_link(ui: &mut egui::Ui, window: &mut HeadsetWindow) {
    if window.shows_link {
        ui.label(text("headset-open"));
        ui.add(egui::Label::new(egui::RichText::new(&window.link.url).monospace()).wrap());
        ui.label(text("headset-certificate"));
    }
    let name = if window.shows_link {
        text("headset-hide")
    } else {
        text("headset-show")
    };
    if ui.button(name).clicked() {
        window.shows_link = !window.shows_link;
    }
}

/// Draws the buttons of the person at the computer, who alone may let sources on the network press keys, below `words`, the key of a
/// text.
pub(super) fn show_consent(ui: &mut egui::Ui, words: &'static str, sent: &mut Vec<Command>) {
    ui.label(text(words));
    ui.horizontal(|ui| {
        for (name, hint, command) in [
            ("headset-allow", "headset-allow-hint", Command::AllowKeys),
            ("headset-forbid", "headset-forbid-hint", Command::ForbidKeys),
        ] {
            if ui.button(text(name)).on_hover_text(text(hint)).clicked() {
                sent.push(command);
            }
        }
    });
}

/// Draws a code in black on white, in every theme: cameras read it so. Its modules cover whole pixels.
fn show_code(ui: &mut egui::Ui, code: &QrModules) {
    let pixels_per_point = ui.pixels_per_point();
    let module = (MODULE * pixels_per_point).round().max(1.0) / pixels_per_point;
    let side = module * (code.width() + 2 * QUIET_ZONE) as f32;
    let (area, response) = ui.allocate_exact_size(Vec2::splat(side), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, text("headset-code")));
    let corner = (area.min * pixels_per_point).round() / pixels_per_point;
    let mut mesh = egui::Mesh::default();
    mesh.add_colored_rect(Rect::from_min_size(corner, area.size()), Color32::WHITE);
    let position = |column: usize, row: usize| {
        let from_corner = [column, row].map(|index| (index + QUIET_ZONE) as f32 * module);
        corner + Vec2::from(from_corner)
    };
    for run in code.dark_runs() {
        let (min, max) = (position(run.start, run.row), position(run.end, run.row + 1));
        mesh.add_colored_rect(Rect::from_min_max(min, max), Color32::BLACK);
    }
    ui.painter().add(mesh);
}
