//! The toolbar: commands to the session, and what is shown.

use eframe::egui::{self, Key};

use super::{PanelContext, PanelKind, PanelState};
use crate::command::Command;
use crate::studio::camera::Viewpoint;
use crate::studio::texts::text;

pub(super) fn show(ui: &mut egui::Ui, state: &mut PanelState, context: &mut PanelContext) {
    ui.add_space(4.0);
    ui.horizontal(|ui| {
        ui.spacing_mut().button_padding = egui::vec2(10.0, 5.0);
        // A recording takes no commands.
        if context.player.is_none() {
            show_commands(ui, context);
            ui.separator();
        }
        for (viewpoint, name, key) in VIEWPOINTS {
            let is_pressed = ui.input(|input| input.key_pressed(key));
            if ui.button(text(name)).clicked() || is_pressed {
                state.camera.look_from(viewpoint);
            }
        }
        ui.separator();
        ui.menu_button(text("menu-view"), |ui| {
            for kind in PanelKind::ALL {
                ui.checkbox(&mut state.shown[kind as usize], kind.name());
            }
            ui.checkbox(&mut state.scene.bones, text("view-bones"));
            let mut is_dark = ui.visuals().dark_mode;
            if ui.checkbox(&mut is_dark, text("view-dark")).changed() {
                ui.ctx().set_theme(match is_dark {
                    true => egui::Theme::Dark,
                    false => egui::Theme::Light,
                });
            }
        });
    });
    ui.add_space(4.0);
}

/// The named positions of the camera, with their keys.
const VIEWPOINTS: [(Viewpoint, &str, Key); 3] = [
    (Viewpoint::Eye, "view-eye", Key::Num1),
    (Viewpoint::Above, "view-above", Key::Num2),
    (Viewpoint::Side, "view-side", Key::Num3),
];

fn show_commands(ui: &mut egui::Ui, context: &mut PanelContext) {
    let is_paused = context.model.view.state.paused_by.is_some();
    let pause = match is_paused {
        true => (text("button-resume"), Command::Resume),
        false => (text("button-pause"), Command::Pause),
    };
    let buttons = [
        (pause.0, text("hint-pause"), Key::P, pause.1),
        (
            text("button-recenter"),
            text("hint-recenter"),
            Key::C,
            Command::Recenter,
        ),
        (
            text("button-zero"),
            text("hint-zero"),
            Key::Z,
            Command::Zero,
        ),
    ];
    for (name, hint, key, command) in buttons {
        let button = egui::Button::new(name);
        let button = ui.add_enabled(!context.model.has_ended, button);
        let is_pressed = ui.input(|input| input.key_pressed(key));
        if button.on_hover_text(hint).clicked() || (is_pressed && !context.model.has_ended) {
            context.sent.push(command);
        }
    }
}
