//! The toolbar: commands to the session, and panels that are hidden and shown.

use ademan::studio::texts::{self, Language, text};
use egui::accesskit::Role;
use egui_kittest::kittest::Queryable;

use crate::changing_window::ChangingWindow;
use crate::picture;
use crate::window::{Opening, StudioWindow};

#[test]
fn a_click_on_pause_pauses_the_session_and_another_resumes_it() {
    let mut window = Opening::default().open();
    window.click(text("button-pause"));
    window.wait_for("a paused session", |model| {
        model.view.state.paused_by.is_some()
    });
    window.draw(1);
    window.click(text("button-resume"));
    window.wait_for("a running session", |model| {
        model.view.state.paused_by.is_none()
    });
}

#[test]
fn a_pause_releases_what_is_down_and_sends_nothing() {
    let opening = Opening {
        readings: 100,
        ..Opening::default()
    };
    let mut window = opening.open();
    let last = |window: &StudioWindow| window.model().history.events().last().copied();
    let is_down = |window: &StudioWindow| last(window).is_some_and(|event| event.is_press);
    while !is_down(&window) {
        window.play(1);
    }
    let pressed = last(&window).expect("a press");
    window.click(text("button-pause"));
    window.draw_until("a release", |window| !is_down(window));
    assert_eq!(last(&window).expect("a release").key, pressed.key);
    assert!(window.has(text("typing-suppressed")) || window.has(text("typing-nowhere")));
    let count = |window: &StudioWindow| window.model().history.events().count();
    let before = count(&window);
    window.play(60);
    assert_eq!(count(&window), before, "nothing is sent in a pause");
    window.click(text("button-resume"));
    for _ in 0..40 {
        window.play(10);
        if count(&window) > before {
            return;
        }
    }
    panic!("the hand types again after the pause");
}

#[test]
fn toolbar_and_status_line_are_as_reviewed() {
    let mut window = Opening::default().open();
    let (frame, workspace) = (window.harness.ctx.content_rect(), window.workspace());
    let status = frame.with_min_y(workspace.max.y + 8.0);
    picture::compare(&mut window, "studio-status", status);
    window.click(text("button-pause"));
    window.draw_until("a paused session", |window| {
        window.has(text("button-resume"))
    });
    let toolbar = frame.with_max_y(workspace.min.y);
    picture::compare(&mut window, "studio-toolbar", toolbar);
}

#[test]
fn the_toolbar_has_one_row_in_both_languages() {
    for language in Language::ALL {
        let folder = tempfile::tempdir().expect("a folder");
        let mut window = ChangingWindow::open("arrows", &folder.path().join("studio.ron"));
        window.app().settings().language = Some(language);
        window.draw();
        texts::set_language(language);
        window.picture(&format!("toolbar-{}", language.name()));
        let middle = |window: &ChangingWindow, name| {
            let mut found = window.harness.get_all_by_label(text(name));
            found.next().expect("a button").rect().center()
        };
        let first = middle(&window, "workspace-hand");
        for name in ["menu-devices", "menu-view", "menu-settings", "menu-help"] {
            let own = middle(&window, name);
            assert_eq!(own.y, first.y, "{}: {name}", language.name());
            assert!(own.x > first.x && own.x < 1280.0, "{name}: {own}");
        }
    }
    texts::set_language(Language::English);
}

#[test]
fn the_p_key_pauses_the_session() {
    let mut window = Opening::default().open();
    window.press_key(egui::Key::P);
    window.wait_for("a paused session", |model| {
        model.view.state.paused_by.is_some()
    });
}

#[test]
fn each_panel_is_hidden_and_shown() {
    let mut window = Opening::default().open();
    for (panel, content) in [
        (text("panel-sensors"), text("stats-accepted")),
        (text("panel-scope"), text("scope-hold")),
    ] {
        assert!(window.has(content), "{panel} is shown");
        for is_shown in [false, true] {
            window.toggle_in_menu(panel);
            assert_eq!(window.has(content), is_shown, "{panel}");
        }
    }
}

#[test]
fn the_whole_window_is_drawn() {
    let opening = Opening {
        readings: 900,
        // The picture shows the latency of a hand that moves in real time.
        speed: Some(1.0),
        ..Opening::default()
    };
    picture::document(&mut opening.open(), "studio");
}

#[test]
fn a_key_that_is_held_pauses_the_session_and_does_not_resume_it() {
    let mut window = Opening::default().open();
    hold(&mut window, egui::Key::P);
    window
        .harness
        .get_by_role_and_label(Role::Button, text("button-resume"))
        .focus();
    window.draw(2);
    window.press_key(egui::Key::Space);
    window.wait_for("a running session", |model| {
        model.view.state.paused_by.is_none()
    });
    window.draw(2);
    hold(&mut window, egui::Key::Space);
}

/// Holds a key that pauses the session: its events repeat the first one, as it does not come up between them.
fn hold(window: &mut StudioWindow, key: egui::Key) {
    for _ in 0..2 {
        window.harness.key_down(key);
        window.draw(2);
        window.wait_for("a paused session", |model| {
            model.view.state.paused_by.is_some()
        });
    }
    // The session has handled all commands before these readings.
    window.play(20);
    assert!(window.model().view.state.paused_by.is_some(), "{key:?}");
    window.harness.key_up(key);
    window.draw(2);
}
