//! The scope.

use ademan::studio::texts::text;

use crate::picture;
use crate::window::{Opening, StudioWindow};

#[test]
fn the_panel_is_as_reviewed() {
    let opening = Opening {
        readings: 900,
        size: [1280.0, 900.0],
        ..Opening::default()
    };
    let mut window = opening.open();
    window.toggle_in_menu(text("panel-sensors"));
    let panel = window.panel(text("panel-scope"));
    window.click(text("scope-plot"));
    for _ in 0..7 {
        window.press_key(egui::Key::Plus);
    }
    // Without the edge of the 3D view.
    let panel = panel.with_min_y(panel.min.y + 6.0);
    picture::compare(&mut window, "studio-scope", panel);
}

#[test]
fn the_height_of_the_panel_comes_back_after_a_low_window() {
    let mut window = Opening::default().open();
    let height = |drawn: &StudioWindow| drawn.panel(text("panel-scope")).height();
    let before = height(&window);
    window.harness.set_size(egui::vec2(1280.0, 400.0));
    window.draw(3);
    let low = height(&window);
    assert!(low < before, "{low} of {before}");
    window.harness.set_size(egui::vec2(1280.0, 800.0));
    window.draw(3);
    assert_eq!(height(&window), before);
}
