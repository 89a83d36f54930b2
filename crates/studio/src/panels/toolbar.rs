//! The toolbar: commands to the session, and menus, in one row of a window of 1280 points.

use eframe::egui;

use super::actions::{ACTIONS, Action};
use super::{PanelContext, PanelState, Workspace, attached, hand, layouts};
use crate::camera::Viewpoint;
use crate::settings::Theme;
use crate::texts::{self, Language, text};

/// Width of the first button in points, so that the others stay where they are in a pause.
const PAUSE_WIDTH: f32 = 92.0;

/// Factor of one step of the scale.
const SCALE_STEP: f32 = 1.1;

/// The guide, as it comes with the sources.
const GUIDE: &str = "docs/studio.md";

pub(super) fn show(ui: &mut egui::Ui, state: &mut PanelState, context: &mut PanelContext) {
    ui.add_space(4.0);
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().button_padding = egui::vec2(10.0, 5.0);
        // A recording has no glove to calibrate, and another program has its own.
        let has_glove = !context.is_replay && context.attached.is_none();
        let is_useful = |it: &Workspace| has_glove || *it != Workspace::Calibration;
        for workspace in Workspace::ALL.into_iter().filter(is_useful) {
            let tab = ui.selectable_value(&mut state.workspace, workspace, workspace.name());
            if workspace == Workspace::Layout {
                state.tour.see("workspace-layout", tab.rect);
            }
        }
        ui.separator();
        // A recording takes no commands.
        if !context.is_replay {
            for action in [Action::Pause, Action::Recenter, Action::Zero] {
                show_button(ui, action, state, context);
            }
            ui.separator();
        }
        if let Some(session) = context.attached {
            attached::show(ui, session, context);
        }
        if context.can_open {
            layouts::show(ui, state);
            show_button(ui, Action::Devices, state, context);
        }
        if context.has_hand {
            hand::show(ui, state);
        }
        ui.menu_button(text("menu-view"), |ui| show_view_menu(ui, state, context));
        ui.menu_button(text("menu-settings"), |ui| show_settings_menu(ui, state));
        ui.menu_button(text("menu-help"), |ui| show_help_menu(ui, state));
    });
    ui.add_space(4.0);
}

fn show_button(
    ui: &mut egui::Ui,
    action: Action,
    state: &mut PanelState,
    context: &mut PanelContext,
) {
    let name = action.name(context.session);
    let mut button = match action {
        Action::Devices => egui::Button::selectable(state.devices.is_open(), name),
        _ => egui::Button::new(name),
    };
    if action == Action::Pause {
        button = button.min_size(egui::vec2(PAUSE_WIDTH, 0.0));
    }
    let spec = action.spec();
    let hint = format!("{} ({})", text(spec.hint), spec.keys(ui.ctx()));
    let response = ui.add_enabled(action.is_enabled(context), button);
    if action == Action::Pause {
        state.tour.see("button-pause", response.rect);
    }
    if response.on_hover_text(hint).clicked() {
        action.perform(ui.ctx(), state, context);
    }
}

fn show_view_menu(ui: &mut egui::Ui, state: &mut PanelState, context: &mut PanelContext) {
    for viewpoint in [Viewpoint::Eye, Viewpoint::Above, Viewpoint::Side] {
        show_button(ui, Action::Look(viewpoint), state, context);
    }
    ui.separator();
    for spec in &ACTIONS {
        let mut is_on = match spec.action {
            Action::Show(panel) => state.shows(panel),
            Action::Bones => state.scene.bones,
            Action::Opaque => state.scene.opaque,
            Action::Trails => state.scene.trails,
            Action::Reach => state.scene.reach,
            Action::Fingertip => state.is_fingertip,
            _ => continue,
        };
        let is_enabled = spec.action.is_enabled(context);
        let check_box = egui::Checkbox::new(&mut is_on, text(spec.name));
        let response = ui.add_enabled(is_enabled, check_box);
        if response.on_hover_text(spec.keys(ui.ctx())).changed() {
            spec.action.perform(ui.ctx(), state, context);
        }
    }
}

fn show_settings_menu(ui: &mut egui::Ui, state: &mut PanelState) {
    let settings = &mut state.settings;
    for (theme, name) in [
        (Theme::System, "theme-system"),
        (Theme::Light, "theme-light"),
        (Theme::Dark, "theme-dark"),
    ] {
        ui.radio_value(&mut settings.theme, theme, text(name));
    }
    ui.checkbox(&mut settings.has_high_contrast, text("theme-contrast"));
    ui.separator();
    let scale = ui.ctx().zoom_factor();
    for (name, factor) in [
        ("scale-larger", scale * SCALE_STEP),
        ("scale-smaller", scale / SCALE_STEP),
        ("scale-normal", 1.0),
    ] {
        if ui.button(text(name)).clicked() {
            ui.ctx().set_zoom_factor(factor.clamp(0.5, 3.0));
        }
    }
    ui.separator();
    ui.checkbox(&mut settings.sound.is_on, text("sound-clicks"));
    let name = ui.label(text("sound-volume"));
    let slider = egui::Slider::new(&mut settings.sound.volume, 0.0..=1.0).show_value(false);
    ui.add_enabled(settings.sound.is_on, slider)
        .labelled_by(name.id);
    ui.separator();
    for language in Language::ALL {
        let is_own = texts::language() == language;
        if ui.radio(is_own, language.name()).clicked() {
            settings.language = Some(language);
        }
    }
}

fn show_help_menu(ui: &mut egui::Ui, state: &mut PanelState) {
    let keys = Action::Keys.spec();
    let name = format!("{} ({})", text(keys.name), keys.keys(ui.ctx()));
    if ui.button(name).clicked() {
        state.shows_keys = true;
        ui.close();
    }
    if ui.button(text("help-tour")).clicked() {
        state.tour.open();
        ui.close();
    }
    ui.separator();
    ui.label(text("help-guide"));
    ui.monospace(GUIDE);
}
