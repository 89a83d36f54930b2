//! Other layouts, opened from the toolbar: each in a session of its own.

use ademan::studio::texts::{text, text_with};
use egui::accesskit::{Role, Toggled};
use egui_kittest::kittest::{NodeT, Queryable};

use crate::changing_window::ChangingWindow;

#[test]
fn another_layout_is_opened_and_the_hand_uses_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = ChangingWindow::open("arrows", &folder.path().join("studio.ron"));
    window.click(text("menu-open"));
    window.picture("menu-open");
    window.click("numpad");
    let name = "layouts/keyboards/numpad.ron";
    assert_eq!(window.app().model().view.layout.file, name);
    window.wait_for("a press", |app| {
        app.model().history.events().any(|event| event.is_press)
    });
    assert!(window.recent_layouts().is_empty(), "it is no file");
}

#[test]
fn a_pause_stays_with_the_next_layout() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = ChangingWindow::open("arrows", &folder.path().join("studio.ron"));
    window.click(text("button-pause"));
    window.wait_for("a pause", |app| app.model().view.state.paused_by.is_some());
    window.choose_layout("numpad");
    window.wait_for("a pause", |app| app.model().view.state.paused_by.is_some());
    window.wait_for("readings", |app| app.model().stats.accepted > 3000);
    assert!(window.app().model().view.state.paused_by.is_some());
    assert_eq!(window.app().model().history.events().count(), 0);
}

#[test]
fn files_are_remembered_and_one_that_is_gone_is_dropped_with_a_notice() {
    let folder = tempfile::tempdir().expect("a folder");
    let layout = r#"Layout(name: "NAME", boards: [(
        pose: (anchor: elbow, bearing_deg: 35, forward_mm: 320, height_mm: -45),
        rows: [(at_mm: (-19, 0), keys: "Y N")],
    )])"#;
    let paths = ["one.ron", "two.ron"].map(|name| folder.path().join(name));
    for path in &paths {
        std::fs::write(path, layout).expect("a write");
    }
    let [one, two] = paths.each_ref().map(|path| path.to_str().expect("UTF-8"));
    let mut window = ChangingWindow::open(one, &folder.path().join("studio.ron"));
    window.enter_layout(two);
    assert_eq!(window.app().model().view.layout.file, two);
    assert_eq!(window.recent_layouts(), [two, one]);
    window.choose_layout("one.ron");
    assert_eq!(window.app().model().view.layout.file, one);
    assert_eq!(window.recent_layouts(), [one, two]);
    std::fs::remove_file(two).expect("a file");
    window.choose_layout("two.ron");
    assert_eq!(window.app().model().view.layout.file, one);
    assert_eq!(window.recent_layouts(), [one]);
    let notice = text_with("layouts-missing", &[("file", two.into())]);
    window.draw();
    assert!(window.has(&notice), "{notice}");
}

#[test]
fn a_layout_with_faults_leaves_the_session_as_it_is() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("faults.ron");
    std::fs::write(&path, "Layout(").expect("a write");
    let mut window = ChangingWindow::open("arrows", &folder.path().join("studio.ron"));
    window.enter_layout(path.to_str().expect("UTF-8"));
    assert_eq!(
        window.app().model().view.layout.file,
        "layouts/keyboards/arrows.ron"
    );
    assert!(window.has("faults.ron"));
    window.wait_for("a press", |app| {
        app.model().history.events().any(|event| event.is_press)
    });
}

#[test]
fn another_layout_keeps_a_calibration_that_is_not_saved() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = ChangingWindow::open("arrows", &folder.path().join("studio.ron"));
    window.wait_for_words(text("joint-elbow"));
    window.click(text("joint-elbow"));
    assert!(!window.has(text("glove-unsaved")));
    window.set_number(text("value-offset"), 40.0);
    assert!(window.has(text("glove-unsaved")));
    window.choose_layout("numpad");
    window.draw();
    assert!(window.has(text("glove-unsaved")));
}

/// Returns `true` if the check box with this name is on.
fn is_on(window: &ChangingWindow, name: &str) -> bool {
    let harness = &window.harness;
    let check_box = harness.get_by_role_and_label(Role::CheckBox, name);
    check_box.accesskit_node().toggled() == Some(Toggled::True)
}

#[test]
fn options_of_the_view_and_the_scope_stay_with_another_layout() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = ChangingWindow::open("arrows", &folder.path().join("studio.ron"));
    for (menu, option) in [("menu-view", "view-bones"), ("scope-rows", "scope-latency")] {
        window.click(text(menu));
        assert!(!is_on(&window, text(option)), "{option}");
        window.click(text(option));
        window.harness.key_press(egui::Key::Escape);
        window.draw();
    }
    window.choose_layout("numpad");
    window.draw();
    for (menu, option) in [("menu-view", "view-bones"), ("scope-rows", "scope-latency")] {
        window.click(text(menu));
        assert!(is_on(&window, text(option)), "{option}");
        window.harness.key_press(egui::Key::Escape);
        window.draw();
    }
}
