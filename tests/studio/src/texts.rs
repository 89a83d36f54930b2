//! Texts: within their panels and the window, beside each other, and with signs that the font has.

use std::fs;
use std::path::Path;

use ademan::studio::settings::Theme;
use ademan::studio::texts::{self, Language, text};
use egui::accesskit::Role;
use egui::{FontFamily, FontId, Rect};
use egui_kittest::kittest::NodeT;

use crate::editor::press;
use crate::picture;
use crate::window::{Opening, StudioWindow};

/// The size of a small laptop's window.
const SIZE: [f32; 2] = [1280.0, 720.0];

/// An overlap that is not seen, in points: the rectangle of a text is larger than its letters.
const UNSEEN: f32 = 3.0;

/// Returns the texts of a window with their areas.
fn labels(window: &StudioWindow) -> Vec<(String, Rect)> {
    let root = window.harness.root();
    let nodes = root.children_recursive();
    let texts = nodes.filter_map(|node| {
        let own = node.accesskit_node();
        let is_text = matches!(
            own.role(),
            Role::Label | Role::Button | Role::CheckBox | Role::RadioButton
        );
        let words = own.label().or(own.value()).unwrap_or_default();
        (is_text && !words.trim().is_empty()).then(|| (words, node.rect()))
    });
    texts.collect()
}

/// Returns the texts that are beyond the window to a side, and the pairs that overlap unless a menu or a list is open over others.
fn faults(window: &StudioWindow, is_covered: bool) -> Vec<String> {
    let screen = window.harness.ctx.content_rect();
    let labels = labels(window);
    let mut faults = Vec::new();
    for (index, (words, area)) in labels.iter().enumerate() {
        // Labels below the end of a list are scrolled to.
        if !area.is_positive() || area.min.y > screen.max.y {
            continue;
        }
        if area.min.x < screen.min.x - UNSEEN || area.max.x > screen.max.x + UNSEEN {
            faults.push(format!("{words:?} is beyond the window: {area}"));
        }
        for (other, other_area) in &labels[index + 1..] {
            let common = area.intersect(*other_area);
            if is_covered {
                continue;
            }
            let is_inside = area.contains_rect(*other_area) || other_area.contains_rect(*area);
            if common.is_positive() && common.size().min_elem() > UNSEEN && !is_inside {
                faults.push(format!("{words:?} {area} overlaps {other:?} {other_area}"));
            }
        }
    }
    faults
}

/// Opens each part of the window in turn, draws it, and returns what is wrong with its texts.
fn look_at_all(
    language: Language,
    (theme, has_high_contrast): (egui::Theme, bool),
    pixels_per_point: f32,
) -> Vec<String> {
    let opening = Opening {
        size: SIZE,
        pixels_per_point,
        theme,
        ..Opening::default()
    };
    let mut window = opening.open();
    let settings = window.harness.state_mut().settings();
    settings.language = Some(language);
    settings.theme = match theme {
        egui::Theme::Dark => Theme::Dark,
        egui::Theme::Light => Theme::Light,
    };
    settings.has_high_contrast = has_high_contrast;
    window.draw(3);
    let mut found = Vec::new();
    let mut look = |window: &mut StudioWindow, part: &str| {
        let is_covered = matches!(part, "keys" | "palette") || part.starts_with("menu");
        let contrast = if has_high_contrast { "-contrast" } else { "" };
        let language = language.name();
        let part = format!("texts-{language}-{theme:?}{contrast}-{pixels_per_point}-{part}");
        picture::draw(window, &part);
        found.extend(
            faults(window, is_covered)
                .into_iter()
                .map(|fault| format!("{part}: {fault}")),
        );
    };
    look(&mut window, "hand");
    window.click(text("joint-elbow"));
    look(&mut window, "channel");
    window.press_key(egui::Key::F1);
    look(&mut window, "keys");
    window.press_key(egui::Key::Escape);
    for menu in ["menu-view", "menu-settings", "menu-help"] {
        window.click(text(menu));
        look(&mut window, menu);
        window.press_key(egui::Key::Escape);
    }
    window.click(text("workspace-layout"));
    window.draw(3);
    look(&mut window, "editor");
    press(&mut window, egui::Modifiers::COMMAND, egui::Key::A);
    look(&mut window, "editor-form");
    press(&mut window, egui::Modifiers::COMMAND, egui::Key::K);
    look(&mut window, "palette");
    window.press_key(egui::Key::Escape);
    window.click(text("editor-plan"));
    look(&mut window, "plan");
    window.click(text("workspace-calibration"));
    window.draw(3);
    look(&mut window, "calibration");
    window.click(text("workspace-lab"));
    window.draw(3);
    look(&mut window, "lab");
    found
}

#[test]
fn no_text_is_clipped_or_lies_over_another() {
    let mut found = Vec::new();
    for language in Language::ALL {
        for (theme, has_high_contrast, pixels_per_point) in [
            (egui::Theme::Dark, false, 1.0),
            (egui::Theme::Light, false, 1.0),
            (egui::Theme::Light, true, 1.0),
            // 2560 × 1440 pixels at 200 %.
            (egui::Theme::Light, false, 2.0),
            (egui::Theme::Dark, true, 2.0),
        ] {
            let look = (theme, has_high_contrast);
            found.extend(look_at_all(language, look, pixels_per_point));
        }
    }
    texts::set_language(Language::English);
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// Returns the strings of a Rust source.
fn strings(source: &str) -> String {
    let lines = source
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"));
    let code = lines.collect::<Vec<_>>().join("\n");
    let parts = code.split('"').skip(1).step_by(2);
    parts.collect()
}

/// Returns the Rust sources of a folder and the folders in it.
fn sources(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let read = |path: std::path::PathBuf| {
        if path.is_dir() {
            sources(&path)
        } else {
            vec![fs::read_to_string(path).expect("a text")]
        }
    };
    paths.flat_map(read).collect()
}

#[test]
fn the_fonts_have_every_sign_of_the_window() {
    let window = Opening::default().open();
    let studio = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../crates/studio/src");
    let mut shown: String = sources(&studio.join("panels"))
        .iter()
        .map(|it| strings(it))
        .collect();
    for language in ["en.ftl", "es.ftl"] {
        shown += &fs::read_to_string(studio.join("texts").join(language)).expect("texts");
    }
    let mut signs: Vec<char> = shown.chars().filter(|sign| !sign.is_ascii()).collect();
    signs.sort_unstable();
    signs.dedup();
    assert!(signs.contains(&'°'), "{signs:?}");
    let font = FontId::new(14.0, FontFamily::Proportional);
    window.harness.ctx.fonts_mut(|fonts| {
        signs.retain(|sign| !fonts.has_glyph(&font, *sign));
    });
    assert!(signs.is_empty(), "without a glyph: {signs:?}");
}
