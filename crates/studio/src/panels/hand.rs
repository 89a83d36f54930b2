//! The menu of the simulated hand: speed, noise, and the person.

use eframe::egui::containers::menu::{MenuButton, MenuConfig};
use eframe::egui::{self, PopupCloseBehavior};

use super::{PanelState, file_field};
use crate::settings::{HAND_NOISES, HAND_SPEEDS, HandSettings};
use crate::texts::text;
use ademan_core::document::shipped_persons;

/// Width of the menu, in points.
const WIDTH: f32 = 260.0;

pub(super) fn show(ui: &mut egui::Ui, state: &mut PanelState) {
    let stays = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    let menu = MenuButton::new(text("menu-hand")).config(stays);
    menu.ui(ui, |ui| {
        ui.set_width(WIDTH);
        let hand = &mut state.settings.hand;
        show_sliders(ui, hand);
        ui.separator();
        show_people(ui, hand, &mut state.replaced_person);
        let file = &mut state.person_file;
        if let Some(name) =
            file_field::show(ui, WIDTH, "hand-person-file", "hand-person-open", file)
        {
            hand.person = Some(name);
        }
    });
}

fn show_sliders(ui: &mut egui::Ui, hand: &mut HandSettings) {
    let (slowest, fastest) = HAND_SPEEDS;
    let name = ui.label(text("hand-speed"));
    let slider = egui::Slider::new(&mut hand.speed, slowest..=fastest).suffix(" ×");
    ui.add(slider.logarithmic(true)).labelled_by(name.id);
    let (least, most) = HAND_NOISES;
    let noise_name = ui.label(text("hand-noise"));
    let noise_slider = egui::Slider::new(&mut hand.noise, least..=most).fixed_decimals(1);
    let noise_slider = ui.add(noise_slider).labelled_by(noise_name.id);
    noise_slider.on_hover_text(text("hand-noise-hint"));
}

fn show_people(ui: &mut egui::Ui, hand: &mut HandSettings, replaced: &mut Option<String>) {
    ui.label(text("hand-person"));
    let own = hand.person.is_none();
    if ui.radio(own, text("hand-person-own")).clicked() {
        hand.person = None;
        *replaced = None;
    }
    let is_shipped = |name: &String| shipped_persons().any(|shipped| shipped == name);
    let file = hand.person.clone().filter(|name| !is_shipped(name));
    let people = shipped_persons().map(str::to_owned).chain(file);
    for name in people {
        let is_chosen = hand.person.as_ref() == Some(&name);
        if ui.radio(is_chosen, &name).clicked() {
            hand.person = Some(name);
        }
    }
}
