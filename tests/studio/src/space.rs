//! The 3D view.

use crate::picture;
use crate::window::Opening;

#[test]
fn the_light_window_is_as_reviewed() {
    let opening = Opening {
        theme: egui::Theme::Light,
        ..Opening::default()
    };
    let mut window = opening.open();
    picture::compare(&mut window, "studio-light");
}
