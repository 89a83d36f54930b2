//! The keyboard in panels that have the focus.

use std::path::Path;

use ademan::studio::texts::text;
use egui::Key;
use egui_kittest::kittest::Queryable;

use crate::window::{Opening, StudioWindow};

/// Presses F6 until a panel has the focus.
fn focus(window: &mut StudioWindow, panel: &'static str) {
    let name = format!("{}: {}", text("panel-word"), text(panel));
    for _ in 0..8 {
        window.press_key(Key::F6);
        if window.harness.get_by_label(&name).is_focused() {
            return;
        }
    }
    panic!("F6 does not reach {name:?}");
}

#[test]
fn the_camera_moves_by_keys_while_the_3d_view_has_the_focus() {
    let mut window = Opening::default().open();
    let camera = |window: &mut StudioWindow| {
        let settings = window.harness.state_mut().settings();
        settings.camera.clone().expect("the camera is placed")
    };
    let first = camera(&mut window);
    window.press_key(Key::ArrowRight);
    assert_eq!(camera(&mut window), first, "another panel has the focus");
    focus(&mut window, "panel-space");
    for _ in 0..2 {
        window.press_key(Key::ArrowRight);
    }
    let turned = camera(&mut window);
    assert!(turned.azimuth > first.azimuth, "{turned:?}");
    assert_eq!(turned.target, first.target);
    window.press_key(Key::Plus);
    let nearer = camera(&mut window);
    assert!(nearer.distance < turned.distance, "{nearer:?}");
    window
        .harness
        .key_press_modifiers(egui::Modifiers::SHIFT, Key::ArrowUp);
    window.draw(3);
    let moved = camera(&mut window);
    assert!(moved.target != nearer.target, "{moved:?}");
    assert_eq!(moved.elevation, nearer.elevation);
}

#[test]
fn f6_reaches_the_bar_of_a_recording_and_its_keys_act_there() {
    let recordings = Path::new(env!("CARGO_MANIFEST_DIR")).join("../recordings");
    let mut window = Opening::default().open_recording(&recordings.join("hc11.mcap"));
    focus(&mut window, "panel-recording");
    window.press_key(Key::Home);
    let first = window.model().stats.accepted;
    for _ in 0..9 {
        window.press_key(Key::ArrowRight);
    }
    assert!(window.model().stats.accepted > first);
}
