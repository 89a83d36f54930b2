//! Screen readers and the keyboard: names and roles, the list of keys, the tour, and the language.

use std::fs;
use std::path::Path;

use ademan::studio::texts::{self, Language, text};
use egui::accesskit::{Action, Role};
use egui_kittest::kittest::{NodeT, Queryable};

use crate::picture;
use crate::window::{Opening, StudioWindow};

/// Returns the widgets that are reached by keyboard and that a screen reader cannot announce.
fn unannounced(window: &StudioWindow) -> Vec<String> {
    let root = window.harness.root();
    let nodes = root.children_recursive().map(|node| node.accesskit_node());
    nodes
        .filter(|node| node.data().supports_action(Action::Focus))
        .filter(|node| {
            let name = node.label().or(node.value()).unwrap_or_default();
            name.trim().is_empty() || matches!(node.role(), Role::Unknown | Role::GenericContainer)
        })
        .map(|node| format!("{:?} {:?}", node.role(), node.bounding_box()))
        .collect()
}

#[test]
fn every_widget_has_a_name_and_a_role() {
    let mut window = Opening::default().open();
    assert_eq!(unannounced(&window), [""; 0]);
    for menu in ["menu-view", "menu-settings", "menu-help"] {
        window.click(text(menu));
        assert_eq!(unannounced(&window), [""; 0], "{menu}");
        window.press_key(egui::Key::Escape);
    }
}

/// Returns the lists and numbers of which a screen reader tells nothing but the value.
fn nameless(window: &StudioWindow) -> Vec<String> {
    let root = window.harness.root();
    let nodes = root.children_recursive().map(|node| node.accesskit_node());
    nodes
        .filter(|node| matches!(node.role(), Role::ComboBox | Role::SpinButton))
        .filter(|node| node.label().unwrap_or_default().trim().is_empty())
        .map(|node| format!("{:?} {:?}", node.role(), node.value()))
        .collect()
}

#[test]
fn lists_and_numbers_have_names_beside_their_values() {
    let mut window = Opening::default().open();
    window.click(text("joint-elbow"));
    window.toggle(text("value-range"));
    assert_eq!(nameless(&window), [""; 0], "sensors");
    window.click(text("workspace-layout"));
    for (part, list) in [
        ("editor-new-board", "pose · anchor"),
        ("editor-new-sequence", text("editor-step-kind")),
    ] {
        window.click(text("editor-add"));
        let harness = &window.harness;
        let entry = harness.get_by_role_and_label(Role::Button, text(part));
        entry.click();
        window.draw(3);
        let lists = window.harness.query_all_by_role(Role::ComboBox);
        let mut names = lists.filter_map(|it| it.accesskit_node().label());
        assert!(names.any(|name| name == list), "{part}");
        assert_eq!(nameless(&window), [""; 0], "{part}");
    }
    let recordings = Path::new(env!("CARGO_MANIFEST_DIR")).join("../recordings");
    let recorded = Opening::default().open_recording(&recordings.join("hc11.mcap"));
    assert_eq!(nameless(&recorded), [""; 0], "recording");
}

#[test]
fn f1_shows_the_keys_and_escape_hides_them() {
    let mut window = Opening::default().open();
    window.press_key(egui::Key::F1);
    assert!(window.has(text("keys-next-panel")));
    picture::draw(&mut window, "keys");
    window.press_key(egui::Key::Escape);
    assert!(!window.has(text("keys-next-panel")));
}

/// Returns the name of the widget that has the focus.
fn focused(window: &StudioWindow) -> String {
    let root = window.harness.root();
    let nodes = root.children_recursive();
    let mut nodes = nodes.filter(|node| node.is_focused());
    let label = nodes.next().and_then(|node| node.accesskit_node().label());
    label.unwrap_or_default()
}

#[test]
fn f6_moves_the_focus_from_panel_to_panel_and_shift_f6_back() {
    let mut window = Opening::default().open();
    let panels = [
        "panel-toolbar",
        "panel-status",
        "panel-sensors",
        "panel-scope",
        "panel-space",
    ];
    let names = panels.map(|key| format!("{}: {}", text("panel-word"), text(key)));
    for name in names.iter().chain(&names[..1]) {
        window.press_key(egui::Key::F6);
        assert_eq!(focused(&window), *name);
    }
    for name in names.iter().rev() {
        window
            .harness
            .key_press_modifiers(egui::Modifiers::SHIFT, egui::Key::F6);
        window.draw(3);
        assert_eq!(focused(&window), *name);
    }
}

#[test]
fn f6_reaches_every_part_of_the_layout_editor() {
    let mut window = Opening::default().open();
    window.click(text("workspace-layout"));
    let panels = [
        "panel-toolbar",
        "panel-status",
        "panel-editor-bar",
        "panel-editor-problems",
        "panel-editor-form",
        "panel-editor-canvas",
    ];
    for key in panels {
        window.press_key(egui::Key::F6);
        let name = format!("{}: {}", text("panel-word"), text(key));
        assert_eq!(focused(&window), name);
    }
}

#[test]
fn the_first_step_of_the_tour_is_as_reviewed() {
    let opening = Opening {
        size: [1000.0, 700.0],
        ..Opening::default()
    };
    let mut window = opening.open();
    window.show_space_only();
    window.click(text("menu-help"));
    window.click(text("help-tour"));
    let panel = window.panel(text("panel-space"));
    picture::compare(&mut window, "studio-tour", panel);
}

/// Returns the area of the words and buttons of the tour, with its frame.
fn tour_area(window: &StudioWindow, words: &'static str) -> egui::Rect {
    let words = window.rect_of(text(words));
    words.union(window.rect_of(text("tour-back"))).expand(12.0)
}

#[test]
fn the_tour_covers_nothing_that_it_explains() {
    for language in Language::ALL {
        let opening = Opening {
            size: [1280.0, 720.0],
            ..Opening::default()
        };
        let mut window = opening.open();
        window.harness.state_mut().settings().language = Some(language);
        window.draw(2);
        let screen = window.harness.ctx.content_rect();
        let status = screen.with_min_y(screen.max.y - 34.0);
        let explained = [
            ("tour-view-words", window.panel(text("panel-space"))),
            ("tour-pause-words", window.rect_of(text("button-pause"))),
            ("tour-sensors-words", window.panel(text("panel-sensors"))),
            (
                "tour-layout-words",
                window.rect_of(text("workspace-layout")),
            ),
            ("tour-output-words", status),
        ];
        window.click(text("menu-help"));
        window.click(text("help-tour"));
        for (words, area) in explained {
            let tour = tour_area(&window, words);
            let covered = tour.intersect(area.shrink(6.0));
            assert!(!covered.is_positive(), "{words}: {tour} over {area}");
            assert!(screen.contains_rect(tour), "{words}: {tour}");
            picture::draw(&mut window, &format!("{words}-{}", language.name()));
            window.press_key(egui::Key::Enter);
        }
    }
    texts::set_language(Language::English);
}

#[test]
fn the_tour_shows_the_tab_that_it_explains_and_returns() {
    let shows = |window: &StudioWindow, panel: &'static str| {
        let name = format!("{}: {}", text("panel-word"), text(panel));
        window.has(&name)
    };
    let mut window = Opening::default().open();
    window.click(text("workspace-layout"));
    window.click(text("menu-help"));
    window.click(text("help-tour"));
    assert!(shows(&window, "panel-space") && !shows(&window, "panel-editor-canvas"));
    // The person may look at another tab; the next step is in its own.
    window.click(text("workspace-lab"));
    assert!(!shows(&window, "panel-space"));
    window.click(text("tour-next"));
    assert!(shows(&window, "panel-space"));
    window.press_key(egui::Key::Escape);
    assert!(shows(&window, "panel-editor-canvas") && !shows(&window, "panel-space"));
}

#[test]
fn the_tour_goes_back_and_is_left_with_escape() {
    let mut window = Opening::default().open();
    window.click(text("menu-help"));
    window.click(text("help-tour"));
    window.press_key(egui::Key::Enter);
    assert!(window.has(text("tour-pause-words")));
    window.press_key(egui::Key::Tab);
    assert_eq!(focused(&window), text("tour-back"));
    window.press_key(egui::Key::Space);
    assert!(window.has(text("tour-view-words")));
    window.press_key(egui::Key::Escape);
    assert!(!window.has(text("tour-view-words")));
}

#[test]
fn the_tour_is_shown_at_the_first_start_only() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("studio.ron");
    let opening = || Opening {
        settings: Some(path.clone()),
        ..Opening::default()
    };
    let mut window = opening().open();
    for step in [
        "tour-view-words",
        "tour-pause-words",
        "tour-sensors-words",
        "tour-layout-words",
        "tour-output-words",
    ] {
        assert!(window.has(text(step)), "{step}");
        picture::draw(&mut window, step);
        window.press_key(egui::Key::Enter);
    }
    assert!(!window.has(text("tour-output-words")));
    let settings = window.harness.state_mut().settings().clone();
    let written = ron::ser::to_string(&settings).expect("settings");
    fs::write(&path, written).expect("a write");
    assert!(!opening().open().has(text("tour-view-words")));
}

#[test]
fn the_whole_window_is_in_spanish() {
    let mut window = Opening::default().open();
    window.harness.state_mut().settings().language = Some(Language::Spanish);
    window.draw(2);
    assert_eq!(texts::language(), Language::Spanish);
    assert!(window.has("Pausar"));
    assert!(window.has("No se escribe nada en otros programas"));
    picture::draw(&mut window, "studio-spanish");
}
