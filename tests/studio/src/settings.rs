//! Colors, size and language, chosen in the menu.

use ademan::studio::texts::{self, Language, text};
use image::RgbaImage;

use crate::editor::canvas;
use crate::picture;
use crate::window::{Opening, StudioWindow};

fn choose(window: &mut StudioWindow, name: &str) {
    window.click(text("menu-settings"));
    window.click(name);
    window.press_key(egui::Key::Escape);
}

/// Returns the color of most pixels.
fn main_color(picture: &RgbaImage) -> [u8; 3] {
    let mut counts = std::collections::HashMap::new();
    for pixel in picture.pixels() {
        let [red, green, blue, _] = pixel.0;
        *counts.entry([red, green, blue]).or_insert(0_usize) += 1;
    }
    let most = counts.into_iter().max_by_key(|(_, count)| *count);
    most.expect("a picture").0
}

#[test]
fn a_theme_changes_the_colors_of_all_panels() {
    let mut window = Opening::default().open();
    let panel = window.panel(text("panel-sensors"));
    let mut draw = |theme, contrast: bool, name: &str| {
        choose(&mut window, text(theme));
        if contrast {
            choose(&mut window, text("theme-contrast"));
        }
        picture::draw(&mut window, name).map(|it| main_color(&picture::crop(&it, panel)))
    };
    let Some(dark) = draw("theme-dark", false, "studio-dark") else {
        return;
    };
    assert!(dark.iter().all(|&value| value < 64), "{dark:?}");
    let light = draw("theme-light", false, "studio-light").unwrap();
    assert!(light.iter().all(|&value| value > 192), "{light:?}");
    let contrast = draw("theme-light", true, "studio-light-contrast");
    assert_eq!(contrast, Some([255; 3]));
    let contrast = draw("theme-dark", false, "studio-dark-contrast");
    assert_eq!(contrast, Some([0; 3]));
}

#[test]
fn high_contrast_reaches_the_canvases_of_the_editor() {
    let mut window = Opening::default().open();
    choose(&mut window, text("theme-contrast"));
    window.click(text("workspace-layout"));
    for name in ["editor-board-contrast", "editor-plan-contrast"] {
        for (theme, paper) in [("theme-light", [255; 3]), ("theme-dark", [0; 3])] {
            choose(&mut window, text(theme));
            window.draw(3);
            let area = canvas(&window);
            let Some(drawn) = picture::draw(&mut window, name) else {
                return;
            };
            let main = main_color(&picture::crop(&drawn, area));
            assert_eq!(main, paper, "{name} {theme}");
        }
        window.click(text("editor-plan"));
    }
}

#[test]
fn a_language_changes_the_words_and_is_kept() {
    let mut window = Opening::default().open();
    choose(&mut window, Language::Spanish.name());
    assert_eq!(texts::language(), Language::Spanish);
    assert!(window.has("Pausar") && !window.has("Pause"));
    let settings = window.harness.state_mut().settings().clone();
    assert_eq!(settings.language, Some(Language::Spanish));
    choose(&mut window, Language::English.name());
    assert!(window.has("Pause"));
}

#[test]
fn a_scale_changes_the_size_of_the_words() {
    let mut window = Opening::default().open();
    let size = |window: &StudioWindow| {
        window.panel(text("panel-sensors")).width() / window.harness.ctx.content_rect().width()
    };
    let normal = size(&window);
    choose(&mut window, text("scale-larger"));
    assert!(size(&window) > normal * 1.05);
    assert!(window.harness.state_mut().settings().scale > 1.05);
    window
        .harness
        .key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Num0);
    window.draw(3);
    assert!((size(&window) - normal).abs() < 0.01);
}

#[test]
fn the_menus_are_drawn() {
    for (menu, entry) in [
        ("menu-view", "view-opaque"),
        ("menu-settings", "theme-dark"),
        ("menu-help", "help-tour"),
    ] {
        let mut window = Opening::default().open();
        assert!(!window.has(text(entry)), "{menu} is closed");
        window.click(text(menu));
        assert!(window.has(text(entry)), "{menu} is open");
        picture::draw(&mut window, menu);
    }
}
