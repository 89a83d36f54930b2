//! The 3D view.

use ademan::studio::texts::text;
use ademan::text::{TextModeSchema, TextSetup};

use crate::picture;
use crate::window::{Opening, StudioWindow};

/// A window of the 3D view alone, which is drawn for the documentation.
const SIZE: [f32; 2] = [1000.0, 600.0];

fn open(layout: &str, theme: egui::Theme, readings: usize) -> StudioWindow {
    let opening = Opening {
        readings,
        theme,
        size: SIZE,
        ..Opening::on_layout(layout)
    };
    let mut window = opening.open();
    window.show_space_only();
    window
}

/// Compares the view with a reviewed picture.
fn compare(window: &mut StudioWindow, name: &str) {
    let view = window.panel(text("panel-space"));
    picture::compare(window, name, view);
}

#[test]
fn a_hand_over_keys_is_as_reviewed() {
    let mut window = open("qwerty-flat", egui::Theme::Dark, 165);
    compare(&mut window, "studio-keys");
}

#[test]
fn bones_and_reach_are_as_reviewed() {
    let mut window = open("qwerty-arc", egui::Theme::Light, 165);
    for option in ["view-bones", "view-reach"] {
        window.toggle_in_menu(text(option));
    }
    window.press_key(egui::Key::Num3);
    compare(&mut window, "studio-bones");
}

#[test]
fn a_pinch_zooms_as_much_as_the_fingers_spread() {
    let mut window = open("qwerty-flat", egui::Theme::Dark, 20);
    let distance = |of: &mut StudioWindow| {
        let camera = of.harness.state_mut().settings().camera.clone();
        camera.expect("a camera").distance
    };
    let before = distance(&mut window);
    let middle = window.panel(text("panel-space")).center();
    window.harness.hover_at(middle);
    window.draw(2);
    for (spread, expected) in [(1.25, before / 1.25), (0.8, before)] {
        window.harness.event(egui::Event::Zoom(spread));
        window.draw(2);
        let after = distance(&mut window);
        assert!((after / expected - 1.0).abs() < 1e-3, "{spread}: {after}");
    }
}

#[test]
fn blades_come_out_of_a_fist() {
    // The script holds a fist.
    let mut window = open("claws", egui::Theme::Dark, 230);
    let blades = window.model().view.layout.shapes.len();
    assert_eq!(blades, 3);
    assert_eq!(
        window
            .model()
            .values
            .values()
            .filter(|value| **value > 0.7)
            .count(),
        blades
    );
    picture::draw(&mut window, "studio-claws");
}

#[test]
fn targets_in_space_are_as_reviewed() {
    let mut window = open("space", egui::Theme::Dark, 120);
    compare(&mut window, "studio-targets");
}

#[test]
fn two_hands_are_as_reviewed() {
    let mut window = open("qwerty-two-flat", egui::Theme::Light, 120);
    compare(&mut window, "studio-two-hands");
}

#[test]
fn the_text_so_far_is_shown_with_backspace_applied() {
    let mut window = open("qwerty-flat", egui::Theme::Dark, 20);
    assert!(!window.has("h"), "nothing is typed yet");
    let typed = |window: &StudioWindow| window.model().view.state.typed.clone();
    while typed(&window).is_empty() {
        window.play(5);
    }
    let text = typed(&window);
    assert_eq!(text, "h");
    window.draw_until("the first character", |window| window.has("h"));
    while typed(&window).len() < 4 {
        window.play(10);
    }
    window.draw_until("four characters", |window| window.has("hola"));
    picture::draw(&mut window, "studio-typed");
}

#[test]
fn a_click_takes_a_candidate_of_the_decoder() {
    let mut opening = Opening {
        readings: 20,
        size: SIZE,
        ..Opening::on_layout("qwerty-flat")
    };
    opening.setup.text = Some(TextSetup {
        mode: Some(TextModeSchema::Suggest),
        language: "es".into(),
        ..TextSetup::default()
    });
    let mut window = opening.open();
    window.show_space_only();
    while window.model().view.state.typed.len() < 3 {
        window.play(5);
    }
    let candidates = |window: &StudioWindow| window.model().view.state.candidates.clone();
    window.draw_until("candidates", |window| !candidates(window).is_empty());
    picture::draw(&mut window, "studio-candidates");
    let first = candidates(&window)[0].clone();
    assert_ne!(first, window.model().view.state.typed);
    window.click(&format!("1 {first}"));
    window.play(5);
    window.draw_until("the candidate and a space", |window| {
        window.model().view.state.typed == format!("{first} ")
    });
}
