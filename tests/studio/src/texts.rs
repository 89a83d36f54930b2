//! Texts: within their panels and the window, beside each other, and with signs that the font has.

use std::fs;
use std::path::Path;

use ademan::setup::{ProfileSetup, Setup};
use ademan::studio::settings::Theme;
use ademan::studio::texts::{self, Language, text};
use egui::accesskit::Role;
use egui::{FontFamily, FontId, Rect};
use egui_kittest::Node;
use egui_kittest::kittest::{NodeT, Queryable};

use crate::changing_window::ChangingWindow;
use crate::editor::press;
use crate::picture;
use crate::window::{Opening, StudioWindow};

/// The size of a small laptop's window.
const SIZE: [f32; 2] = [1280.0, 720.0];

/// An overlap that is not seen, in points: the rectangle of a text is larger than its letters.
const UNSEEN: f32 = 3.0;

/// Width of the content of the window of the devices, in points.
const DEVICES_WIDTH: f32 = 660.0;

/// Returns the texts in a part of a window with their areas.
fn labels(part: &Node) -> Vec<(String, Rect)> {
    let nodes = part.children_recursive();
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

/// Returns the texts that are beyond an area to a side, and the pairs that overlap unless a menu or a list is open over others.
fn faults(part: &Node, screen: Rect, is_covered: bool) -> Vec<String> {
    let labels = labels(part);
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
    settings.theme = own_theme(theme);
    settings.has_high_contrast = has_high_contrast;
    window.draw(3);
    let mut found = Vec::new();
    let mut look = |window: &mut StudioWindow, part: &str| {
        let is_covered = matches!(part, "keys" | "palette") || part.starts_with("menu");
        let contrast = if has_high_contrast { "-contrast" } else { "" };
        let language = language.name();
        let part = format!("texts-{language}-{theme:?}{contrast}-{pixels_per_point}-{part}");
        picture::draw(window, &part);
        let screen = window.harness.ctx.content_rect();
        let faults = faults(&window.harness.root(), screen, is_covered).into_iter();
        found.extend(faults.map(|fault| format!("{part}: {fault}")));
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

/// Opens the window of the devices with profiles, draws it before and after a refused choice, and returns what is wrong with its texts.
fn look_at_devices(
    language: Language,
    (theme, has_high_contrast): (egui::Theme, bool),
    pixels_per_point: f32,
) -> Vec<String> {
    texts::set_language(language);
    let folder = tempfile::tempdir().expect("a folder");
    let profile = |name: &str, layout: &str| ProfileSetup {
        name: name.into(),
        layout: layout.into(),
        text: None,
    };
    let setup = Setup {
        output: "none".into(),
        profiles: vec![profile("numbers", "numpad"), profile("sofa", "media")],
        ..Setup::default()
    };
    let settings = folder.path().join("studio.ron");
    let mut window = ChangingWindow::with_look(setup, &settings, theme, pixels_per_point);
    let own = window.app().settings();
    own.language = Some(language);
    own.theme = own_theme(theme);
    own.has_high_contrast = has_high_contrast;
    window.draw();
    window.click(text("menu-devices"));
    let mut found = Vec::new();
    let mut look = |window: &mut ChangingWindow, part: &str| {
        let contrast = if has_high_contrast { "-contrast" } else { "" };
        let language = language.name();
        let part = format!("texts-{language}-{theme:?}{contrast}-{pixels_per_point}-{part}");
        window.picture(&part);
        let devices = devices(window);
        let words = window.harness.get_by_label(text("devices-words")).rect();
        let height = window.harness.ctx.content_rect().y_range();
        let width = words.min.x..=words.min.x + DEVICES_WIDTH;
        let area = Rect::from_x_y_ranges(width, height);
        let faults = faults(&devices, area, false).into_iter();
        found.extend(faults.map(|fault| format!("{part}: {fault}")));
    };
    look(&mut window, "devices");
    window.enter(text("devices-glove"), "no/such/folder/of/gloves/glove.ron");
    assert!(window.has("×"));
    look(&mut window, "devices-error");
    found
}

/// Returns the window of the devices: the smallest part with its first words and its last field.
fn devices(window: &ChangingWindow) -> Node<'_> {
    let mut part = window.harness.get_by_label(text("devices-words"));
    while part.query_by_label(text("devices-setup")).is_none() {
        part = part.parent().expect("the window has both");
    }
    let others = part.query_by_label(text("menu-view"));
    assert!(others.is_none(), "nothing of the main window is in it");
    part
}

fn own_theme(theme: egui::Theme) -> Theme {
    match theme {
        egui::Theme::Dark => Theme::Dark,
        egui::Theme::Light => Theme::Light,
    }
}

/// Looks at a part of the program in each theme and size, and fails with what is wrong.
fn look_in_all_ways(
    language: Language,
    look_at: impl Fn(Language, (egui::Theme, bool), f32) -> Vec<String>,
) {
    let mut found = Vec::new();
    for (theme, has_high_contrast, pixels_per_point) in [
        (egui::Theme::Dark, false, 1.0),
        (egui::Theme::Light, false, 1.0),
        (egui::Theme::Light, true, 1.0),
        // 2560 × 1440 pixels at 200 %.
        (egui::Theme::Light, false, 2.0),
        (egui::Theme::Dark, true, 2.0),
    ] {
        let look = (theme, has_high_contrast);
        found.extend(look_at(language, look, pixels_per_point));
    }
    texts::set_language(Language::English);
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn no_english_text_is_clipped_or_lies_over_another() {
    look_in_all_ways(Language::English, look_at_all);
}

#[test]
fn no_spanish_text_is_clipped_or_lies_over_another() {
    look_in_all_ways(Language::Spanish, look_at_all);
}

#[test]
fn no_text_of_the_devices_is_clipped_or_lies_over_another() {
    for language in Language::ALL {
        look_in_all_ways(language, look_at_devices);
    }
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
